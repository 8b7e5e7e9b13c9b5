// SPDX-License-Identifier: Apache-2.0
/// How each sampler draws: behind draw() of sampler.h, with its arguments.
#pragma once

#include "formats/model/sampler.h"
#include "formats/shared/draw.glsl.h"
#include "formats/shared/stored_cdf.glsl.h"

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

/// How many samples Pdis gives an image.
inline int pdis_samples(const SamplerOptions& options, double lamp_total, float energy) {
    return shared::pdis_count(options.samples, options.k_max, lamp_total, energy);
}

/// An image's own CDFs: over columns, and over the rows of one of them.
shared::StoredCdf marginal_cdf(const SamplingSlab& slab, int image);
shared::StoredCdf conditional_cdf(const SamplingSlab& slab, int image, int column);

/// As shared headers name them.
constexpr std::uint32_t word_of(Sequence sequence) {
    return static_cast<std::uint32_t>(sequence);
}
static_assert(word_of(Sequence::Halton) == shared::kSequenceHalton &&
              word_of(Sequence::R2) == shared::kSequenceR2 &&
              word_of(Sequence::Fibonacci) == shared::kSequenceFibonacci &&
              word_of(Sequence::Sobol) == shared::kSequenceSobol);
constexpr std::uint32_t word_of(Shift shift) {
    return static_cast<std::uint32_t>(shift);
}
static_assert(word_of(Shift::Constant) == shared::kShiftConstant &&
              word_of(Shift::Random) == shared::kShiftRandom &&
              word_of(Shift::BlueNoise) == shared::kShiftBlueNoise &&
              word_of(Shift::Interleaved) == shared::kShiftInterleaved);

/// The tile of blue noise, 64 x 64 texels row by row: two values in [0, 1) each.
constexpr int kBlueNoiseTile = 64;
const std::vector<glm::vec2>& blue_noise_tile();

/// Point q of `count` in [0, 1)^2, shifted.
glm::vec2 plane_point(Sequence sequence, std::uint32_t q, std::uint32_t count, glm::vec2 shift);
/// The second coordinate alone, of a point whose first is (q + shift.x) / count.
float second_coordinate(Sequence sequence, std::uint32_t q, glm::vec2 shift);

}  // namespace nearfield::model
