// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/environment.h"
#include "formats/scene/scene.h"
#include "render/plan.h"

#include <glm/glm.hpp>

#include <optional>

namespace nearfield::render {

/// A scene's environment, ready for what the plan does with it. Rotation and intensity come last:
/// they may change without anything here being made again.
struct Sky {
    environment::Environment environment;
    glm::mat3 environment_from_world{1.0F};
    float intensity = 1.0F;
    double load_s = 0;  // what reading and preparing took

    glm::vec3 local(glm::vec3 direction_world) const {
        return environment_from_world * direction_world;
    }
};

/// Nothing where the plan has no environment. Throws Error if the picture cannot be read.
std::optional<Sky> load_sky(const Scene& scene,
                            const Plan& plan,
                            const EnvironmentOptions& options);

/// Radiance that arrives from a direction in the world, of unit length: the picture's own pixel.
glm::vec3 radiance_from(const Sky& sky, glm::vec3 direction_world);

}  // namespace nearfield::render
