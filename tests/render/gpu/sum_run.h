// SPDX-License-Identifier: Apache-2.0
/// The windowed sum of given receivers, computed by OpenGL.
#pragma once

#include "formats/model/prepared.h"
#include "formats/shared/brdf.glsl.h"
#include "render/gpu/light_sum.h"

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace nearfield::render::gpu {

struct SumRun {
    int q = 0;
    float dim = 1.0F;
    shared::Brdf brdf{0, glm::vec3(1.0F), glm::vec3(0.0F), 1.0F, glm::vec2(0.5F), glm::vec3(1.0F)};
    glm::dvec3 eye_world_m{0.0, 0.0, -100.0};
};

/// What is in the two images, [receiver].
struct SumLight {
    std::vector<glm::vec4> radiance, irradiance;
};

/// Receivers in the world's frame, shaded by all slabs, one after the other.
SumLight run_sum(Device& device,
                 LightSumPrograms& programs,
                 std::span<const SumSlab> slabs,
                 std::span<const model::ReceiverF> receivers,
                 const SumRun& run = {});

}  // namespace nearfield::render::gpu
