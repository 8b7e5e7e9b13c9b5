// SPDX-License-Identifier: Apache-2.0
/// Random numbers of the bench: a hash of seed, purpose, frame and place.
#pragma once

#include "formats/shared/rng.glsl.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace nearfield::sample_data {

/// What a number is for. Values are part of the pictures: never renumber.
enum class Draw : std::uint32_t {
    Noise = 1,
    Prnu,
    Dsnu,
    Offset,
    Hot,
    Step,
    Walk,
    Hand,
    Photometer
};

/// What all numbers of a purpose and a repetition (`frame`) have in common.
inline glm::uvec4 draw_key(std::uint64_t seed, Draw draw, std::uint64_t frame) {
    const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); };
    const glm::uvec4 key = shared::hash4(
        glm::uvec4(low(seed), high(seed), static_cast<std::uint32_t>(draw), high(frame)));
    return {key.x, low(frame) ^ key.y, key.z, key.w};
}

/// Four words for item `index`.
inline glm::uvec4 draw_words(glm::uvec4 key, std::uint32_t index) {
    return shared::hash4(glm::uvec4(index ^ key.x, key.y, key.z, key.w));
}

inline glm::uvec4 draw_words(std::uint64_t seed,
                             Draw draw,
                             std::uint64_t frame,
                             std::uint32_t index) {
    return draw_words(draw_key(seed, draw, frame), index);
}

/// A word as a number in (0, 1).
inline float open_unit(std::uint32_t word) {
    return (static_cast<float>(word >> 8U) + 0.5F) * 0x1p-24F;
}

/// Two independent standard normal numbers (Box and Muller, 1958); |z| < 5.9.
inline glm::vec2 normal_pair(std::uint32_t word_a, std::uint32_t word_b) {
    const float radius = std::sqrt(-2.0F * std::log(open_unit(word_a)));
    const float angle = 6.2831853F * open_unit(word_b);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

inline glm::dvec2 normal_pair(std::uint64_t seed, Draw draw, std::uint64_t frame, std::uint32_t i) {
    const glm::uvec4 words = draw_words(seed, draw, frame, i);
    return normal_pair(words.x, words.y);
}

/// Means from here on are drawn by poisson_normal.
constexpr float kPoissonExactBelow = 24.0F;

/// Poisson number by inversion of its distribution function: exact, but for a word's 32 bits.
/// Cost O(mean).
inline float poisson_exact(float mean, std::uint32_t word) {
    double left = (static_cast<double>(word) + 0.5) * 0x1p-32;
    double term = std::exp(-static_cast<double>(mean));
    constexpr int kMost = 120;  // a mean of 24 exceeds it with chance 1e-45
    int count = 0;
    while (left > term && count < kMost) {
        left -= term;
        ++count;
        term *= static_cast<double>(mean) / count;
    }
    return static_cast<float>(count);
}

/// Poisson number for means of kPoissonExactBelow and more: the normal z bent by the first
/// Cornish-Fisher term and rounded. Mean exact, variance mean + 1/18 + 1/12, skewness to 1/mean.
/// Source: Cornish and Fisher, "Moments and cumulants in the specification of distributions", 1938.
inline float poisson_normal(float mean, float z) {
    return std::max(0.0F, std::floor(mean + std::sqrt(mean) * z + (z * z - 1.0F) / 6.0F + 0.5F));
}

}  // namespace nearfield::sample_data
