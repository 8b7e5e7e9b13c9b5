// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/environment.h"
#include "formats/scene/scene.h"
#include "render/plan.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace nearfield::render {

/// A scene's environment, ready for what the plan does with it. Rotation and intensity come last:
/// they may change without anything here being made again.
struct Sky {
    std::shared_ptr<const environment::Environment> environment;
    glm::mat3 environment_from_world{1.0F};
    float intensity = 1.0F;
    double load_s = 0;  // what reading and preparing took

    glm::vec3 local(glm::vec3 direction_world) const {
        return environment_from_world * direction_world;
    }
};

/// An environment that stays ready from one picture to the next, and what it was made of.
struct SkyFile {
    std::string path;
    std::int64_t modified_ns = 0;  // a file that has been written again is read again
    environment::Parts parts;
    std::shared_ptr<const environment::Environment> environment;
};

/// Nothing where the plan has no environment. What `kept` holds is used if it still holds, and is
/// replaced otherwise. Throws Error if the picture cannot be read.
std::optional<Sky> load_sky(const Scene& scene,
                            const Plan& plan,
                            const EnvironmentOptions& options,
                            SkyFile& kept);

/// Whether the number of filtered samples depends on how far surfaces turn within a pixel.
bool counts_by_turns(const Plan& plan, const RenderOptions& options);

// Shifts of filtered samples are independent of lamps' and lobes'.
constexpr std::uint32_t kFilteredSeed = 0x51ed270bU;

/// As formats/shared/filtered_samples.glsl.h has it.
std::uint32_t word_of(FilterLevel level);

/// Radiance that arrives from a direction in the world, of unit length: the picture's own pixel.
glm::vec3 radiance_from(const Sky& sky, glm::vec3 direction_world);

}  // namespace nearfield::render
