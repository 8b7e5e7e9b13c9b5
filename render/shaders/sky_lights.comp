// SPDX-License-Identifier: Apache-2.0
// By the environment's few directions as far lamps: as shade_sky_lights of render/cpu/shade_sky.cpp,
// with HAS_SHADOWS by maps in place of rays.
#include "render/shaders/sky.glsl"
#ifdef HAS_SHADOWS
#include "render/shaders/sky_maps.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

float open_share(int n, Surface surface) {
#ifdef HAS_SHADOWS
    return sky_is_open(n, surface.position_m, surface.normal);
#else
    return 1.0;
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(lamp_light))))
        return;
    Surface surface = surface_at(pixel);
    if (surface.material < 0)
        return;
    SurfaceFrame frame_of_surface = frame_of(surface);
    Brdf brdf = brdf_of(surface);
    vec3 to_viewer = local_from_world(frame_of_surface, surface.to_viewer);
    vec3 radiance = vec3(0.0), irradiance = vec3(0.0);
    for (int n = 0; n < sky.counts.y; ++n) {
        vec3 world = world_from_sky(sky_directions[n].direction.xyz);
        vec3 to_light = local_from_world(frame_of_surface, world);
        if (!brdf_is_above(to_light))
            continue;
        vec3 arriving = sky_directions[n].light.rgb *
                        (to_light.z * sky.intensity_sun.x * open_share(n, surface));
        irradiance += arriving;
        radiance += arriving * brdf_eval(brdf, to_light, to_viewer);
    }
    add_light(pixel, radiance, irradiance);
}
