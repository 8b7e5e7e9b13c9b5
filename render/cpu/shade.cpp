// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/shade.h"

#include "formats/model/luminaire.h"
#include "formats/shared/tonemap.glsl.h"

namespace nearfield::render {
namespace {

using shared::luminance709;

/// The light field's own sigma of irradiance, times what turns irradiance into diffuse radiance.
float measured_sigma_y(const Lamp& lamp, const Hit& hit, glm::vec3 unshadowed, glm::vec3 diffuse) {
    const double sigma_y = model::irradiance_sigma_y(
        *lamp.file->measured,
        {glm::dvec3(lamp.luminaire_from_world * glm::dvec4(hit.position_world_m, 1.0)),
         lamp.luminaire_from_world_rotation * hit.shading_normal});
    return static_cast<float>(sigma_y) * luminance709(diffuse) / luminance709(unshadowed);
}

}  // namespace

glm::vec2 shift_of_set(const ShadeQuery& query, int set, std::uint32_t seed) {
    return render::shift_of_set(query.shift, query.pixel,
                                query.first_set + static_cast<std::uint32_t>(set), seed);
}

bool is_visible(const Lamp& lamp,
                const Tracer& tracer,
                const ShadeQuery& query,
                glm::dvec3 from_world_m,
                Scratch& scratch) {
    const Hit& hit = query.hit;
    if (!(glm::dot(from_world_m - hit.position_world_m, hit.geometric_normal) > 0.0))
        return false;
    if (!query.has_shadows)
        return true;
    ++scratch.shadow_rays;
    return !tracer.is_occluded(hit.position_world_m + hit.geometric_normal * hit.offset_m,
                               from_world_m, lamp.mask);
}

bool faces(const Lamp& lamp, const Hit& hit) {
    for (const PlacedSlab& slab : lamp.slabs)
        for (const glm::dvec3 corner : slab.u_corners_world_m)
            if (glm::dot(corner - hit.position_world_m, hit.geometric_normal) > 0.0)
                return true;
    return false;
}

glm::vec3 to_viewer_local(const ShadeQuery& query) {
    return shared::local_from_world(query.frame, glm::vec3(query.to_viewer_world));
}

glm::vec3 diffuse_of(const ShadeQuery& query) {
    return shared::brdf_diffuse(query.brdf, to_viewer_local(query)) * shared::kInversePi;
}

LampLight light_of(const Lamp& lamp,
                   const ShadeQuery& query,
                   const Estimated& estimate,
                   glm::vec3 unshadowed) {
    const glm::vec3 diffuse = diffuse_of(query);
    LampLight light;
    light.irradiance = glm::vec3(estimate.irradiance) * lamp.dim;
    light.radiance = glm::vec3(estimate.radiance) * lamp.dim;
    light.variance_y = static_cast<float>(estimate.variance_y) * lamp.dim * lamp.dim;
    const glm::vec3 diffuse_radiance = light.irradiance * diffuse;
    if (lamp.file->measured && luminance709(diffuse_radiance) > 0.0F)
        light.sigma_measured_y = measured_sigma_y(lamp, query.hit, unshadowed, diffuse_radiance);
    return light;
}

}  // namespace nearfield::render
