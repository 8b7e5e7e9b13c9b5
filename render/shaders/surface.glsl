// SPDX-License-Identifier: Apache-2.0
// What the camera sees at a pixel, and its materials. Bound by render/gpu/surfaces.cpp.
#include "formats/shared/brdf.glsl.h"
#include "formats/shared/frame.glsl.h"

layout(binding = 0) uniform sampler2D surface_position;  // world, metres; w: 1 + material, 0: nothing
layout(binding = 1) uniform sampler2D surface_normal;    // world, unit length, on the viewer's side; w: depth_m
#ifdef HAS_TANGENTS
layout(binding = 2) uniform sampler2D surface_tangent;   // world, any length; 0: none
#endif

// As std430 lays a material out.
struct MaterialBlock {
    vec4 diffuse_exponent;
    vec4 specular_kind;  // w: kind's bits as a float's value: 0 ... 4
    vec4 alpha;          // x, y
    vec4 cosines;
};
layout(std430, binding = 0) readonly restrict buffer Materials { MaterialBlock materials[]; };

layout(std140, binding = 0) uniform FrameBlock {
    vec4 eye_world_m;
    ivec4 size_px;  // width, height
} frame;

struct Surface {
    vec3 position_m;  // world
    vec3 normal;      // world
    vec3 to_viewer;   // world, unit length
    vec3 tangent;     // world
    int material;     // -1: nothing is seen here
};

Surface surface_at(ivec2 pixel) {
    vec4 position = texelFetch(surface_position, pixel, 0);
    Surface surface;
    surface.position_m = position.xyz;
    surface.material = int(position.w) - 1;
    surface.normal = texelFetch(surface_normal, pixel, 0).xyz;
    surface.to_viewer = normalize(frame.eye_world_m.xyz - position.xyz);
#ifdef HAS_TANGENTS
    surface.tangent = texelFetch(surface_tangent, pixel, 0).xyz;
#else
    surface.tangent = vec3(0.0);
#endif
    return surface;
}

SurfaceFrame frame_of(Surface surface) {
    return frame_from_tangent(surface.normal, surface.tangent);
}

Brdf brdf_of(Surface surface) {
    MaterialBlock block = materials[surface.material];
    Brdf brdf;
    brdf.kind = uint(block.specular_kind.w);
    brdf.diffuse = block.diffuse_exponent.xyz;
    brdf.specular = block.specular_kind.xyz;
    brdf.exponent = block.diffuse_exponent.w;
    brdf.alpha = block.alpha.xy;
    brdf.cosines = block.cosines.xyz;
    return brdf;
}
