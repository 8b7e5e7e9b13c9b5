// SPDX-License-Identifier: Apache-2.0
#include "render/sky.h"

#include "formats/files/provenance.h"

namespace nearfield::render {

std::optional<Sky> load_sky(const Scene& scene,
                            const Plan& plan,
                            const EnvironmentOptions& options) {
    if (!plan.has_environment)
        return std::nullopt;
    const bool is_filtered = options.method == EnvironmentMethod::Filtered;
    const bool has_rays = has_pass(plan, PassId::EnvironmentRays);
    environment::Parts parts;
    parts.table = plan.draws_sky;
    parts.maps = is_filtered && has_pass(plan, PassId::EnvironmentSamples);
    parts.harmonics = is_filtered && has_pass(plan, PassId::EnvironmentIrradiance);
    if ((is_filtered && has_rays) || options.method == EnvironmentMethod::Lights)
        parts.directions = options.directions;
    parts.is_gray = plan.color.is_removed;
    const SceneEnvironment& around = *scene.environment;
    const double start_s = now_s();
    Sky sky;
    sky.environment = environment::prepare(environment::read_latlong(around.path), parts);
    sky.environment_from_world = glm::mat3(glm::transpose(around.world_from_environment));
    sky.intensity = static_cast<float>(around.intensity);
    sky.load_s = now_s() - start_s;
    return sky;
}

glm::vec3 radiance_from(const Sky& sky, glm::vec3 direction_world) {
    return sky.intensity *
           environment::radiance(sky.environment.picture, sky.local(direction_world));
}

}  // namespace nearfield::render
