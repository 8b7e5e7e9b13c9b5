// SPDX-License-Identifier: Apache-2.0
/// How each sampler draws: behind draw() of sampler.h, with its arguments.
#pragma once

#include "formats/model/sampler.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::model {

struct Drawing {
    std::span<const SamplingSlab> slabs;
    std::span<SamplingView> views;
    const SamplerOptions& options;
    glm::vec2 shift;
    std::vector<LightSample>& samples;
};

/// Sum of all views' energies in order, and the images among them that have any.
struct LampEnergy {
    double total = 0.0;
    int lit = 0;
};
LampEnergy lamp_energy(std::span<const SamplingView> views);

/// Systematic and Cells.
void draw_systematic(const Drawing& drawing);
void draw_uniform(const Drawing& drawing);
void draw_precomputed(const Drawing& drawing);
void draw_pdis(const Drawing& drawing);

/// One axis of an image that is drawn from as a whole, in units of its texels: Precomputed.
inline shared::AxisBox whole_axis(int texels) {
    return {0, texels - 1, 0.0F, 0.0F, 1.0F, texels > 1 ? 1.0F : 0.0F, 1.0F};
}

/// How many samples Pdis gives an image: eq. (12), rounded, at most k_max.
int pdis_samples(const SamplerOptions& options, double lamp_total, float energy);

/// Point q of `count` in [0, 1)^2, shifted.
glm::vec2 plane_point(Sequence sequence, std::uint32_t q, std::uint32_t count, glm::vec2 shift);
/// The second coordinate alone, of a point whose first is (q + shift.x) / count.
float second_coordinate(Sequence sequence, std::uint32_t q, glm::vec2 shift);
/// A third number in [0, 1), independent of both of the shift's.
float third_shift(glm::vec2 shift);

}  // namespace nearfield::model
