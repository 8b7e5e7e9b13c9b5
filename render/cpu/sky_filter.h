// SPDX-License-Identifier: Apache-2.0
/// What a filtered sample reads of an environment's maps.
#pragma once

#include "formats/environment/paraboloid_map.h"
#include "formats/shared/brdf.glsl.h"
#include "formats/shared/frame.glsl.h"
#include "render/options.h"

#include <glm/glm.hpp>

namespace nearfield::render {

/// A lobe in an environment.
struct SkyLobe {
    const environment::ParaboloidMap& map;
    const shared::Brdf& brdf;
    const shared::SurfaceFrame& frame;  // world
    glm::mat3 environment_from_world{1.0F};
    glm::vec3 to_viewer{0.0F};  // local

    glm::vec3 in_environment(glm::vec3 local) const {
        return environment_from_world * shared::world_from_local(frame, local);
    }
};

/// The environment's mean over what one of `samples` directions stands for. xi: the point of
/// [0, 1)^2 that drew to_light, whose density is > 0.
glm::vec3 filtered_light(const SkyLobe& lobe,
                         const EnvironmentOptions& options,
                         int samples,
                         glm::vec2 xi,
                         glm::vec3 to_light,
                         float density);

}  // namespace nearfield::render
