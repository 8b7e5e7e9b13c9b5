// SPDX-License-Identifier: Apache-2.0
#include "formats/model/sampler.h"
#include "formats/model/sampler_draws.h"
#include "formats/shared/philox.glsl.h"
#include "formats/shared/sequences.glsl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

namespace nearfield::model {
namespace {

double radical_inverse(std::uint64_t q, std::uint64_t base) {
    double value = 0.0, digit = 1.0;
    for (; q > 0; q /= base) {
        digit /= static_cast<double>(base);
        value += digit * static_cast<double>(q % base);
    }
    return value;
}

double unit(std::uint32_t word) {
    return word * 0x1p-32;
}

/// Whether of the first 2^k points each elementary interval of 2^a x 2^(k - a) holds exactly one.
bool is_net(const std::vector<glm::uvec2>& points, unsigned k) {
    for (unsigned a = 0; a <= k; ++a) {
        std::vector<int> count(std::size_t{1} << k, 0);
        for (std::size_t q = 0; q < count.size(); ++q) {
            const std::uint64_t x = points[q].x, y = points[q].y;
            ++count[((x >> (32U - a)) << (k - a)) | (y >> (32U - (k - a)))];
        }
        if (std::ranges::any_of(count, [](int n) { return n != 1; }))
            return false;
    }
    return true;
}

// Proves equality with the published vectors (Random123's known answers for philox4x32, 10 rounds).
TEST(Philox, GivesThePublishedKnownAnswers) {
    EXPECT_EQ(shared::philox4x32(glm::uvec4(0U), glm::uvec2(0U)),
              glm::uvec4(0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U));
    EXPECT_EQ(shared::philox4x32(glm::uvec4(0xffffffffU), glm::uvec2(0xffffffffU)),
              glm::uvec4(0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU));
    EXPECT_EQ(shared::philox4x32({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U},
                                 {0xa4093822U, 0x299f31d0U}),
              glm::uvec4(0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U));
}

// Against the definition in double, also far along, where floats have no digits left for q.
TEST(Sequences, HaltonIsTheRadicalInverse) {
    for (const std::uint32_t q : {0U, 1U, 2U, 7U, 1000U, 123457U, 99999999U, 3000000000U}) {
        const glm::uvec2 point = shared::halton_point(q);
        EXPECT_DOUBLE_EQ(unit(point.x), radical_inverse(std::uint64_t{q} + 1, 2)) << q;
        EXPECT_NEAR(unit(point.y), radical_inverse(std::uint64_t{q} + 1, 3), 0x1p-23) << q;
    }
}

// The lattice in integers keeps its digits beyond q = 1e5, where frac(q / phi) in float loses 5e-3.
TEST(Sequences, GoldenLatticeKeepsItsDigits) {
    const long double inverse_phi = (std::sqrt(5.0L) - 1.0L) / 2.0L;
    for (const std::uint32_t q : {1U, 100U, 100000U, 10000000U}) {
        const long double exact = q * inverse_phi;
        const double expected = static_cast<double>(exact - std::floor(exact));
        // The multiplier is rounded by at most 2^-33: q times that is what may be lost.
        EXPECT_NEAR(unit(shared::golden_word(q)), expected, 0x1p-33 * q + 0x1p-31) << q;
    }
}

// Proves that dimension two fits the first, and that shuffling and scrambling keep a net a net.
TEST(Sequences, SobolIsANetScrambledOrNot) {
    constexpr unsigned kPower = 10;
    std::vector<glm::uvec2> plain, scrambled, broken;
    for (std::uint32_t q = 0; q < 1U << kPower; ++q) {
        plain.emplace_back(shared::reverse_bits(q), shared::sobol_second(q));
        scrambled.push_back(shared::sobol_point(q, {17U, 99U}));
        broken.emplace_back(shared::reverse_bits(q), shared::reverse_bits(q * 5U));
    }
    EXPECT_TRUE(is_net(plain, kPower));
    EXPECT_TRUE(is_net(scrambled, kPower));
    EXPECT_FALSE(is_net(broken, kPower)) << "the check must be able to fail";
    EXPECT_NE(plain, scrambled);
}

// Each point of a scrambled sequence is uniform over seeds: Kolmogorov's distance of 4000 values,
// 1.95 / sqrt(n) at significance 1e-3 each.
TEST(Sequences, ScrambledPointsAreUniformOverSeeds) {
    constexpr std::size_t kSeeds = 4000;
    for (const std::uint32_t q : {0U, 1U, 5U, 100U})
        for (const int axis : {0, 1}) {
            std::vector<double> values;
            for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
                const glm::vec2 shift = shift_of(Shift::Random, {seed, 0U}, 0U, 1U);
                values.push_back(
                    static_cast<double>(plane_point(Sequence::Sobol, q, 1U, shift)[axis]));
            }
            std::ranges::sort(values);
            double distance = 0.0;
            for (std::size_t k = 0; k < kSeeds; ++k)
                distance = std::max(distance,
                                    std::abs(values[k] - (static_cast<double>(k) + 0.5) / kSeeds));
            EXPECT_LT(distance, 1.95 / std::sqrt(kSeeds)) << "point " << q << ", axis " << axis;
        }
}

// All points of all sequences are in [0, 1)^2, for shifts next to 1 too.
TEST(Sequences, PointsAreBelowOne) {
    constexpr float kAlmost = 0x1.fffffep-1F;
    for (const Sequence sequence :
         {Sequence::Halton, Sequence::R2, Sequence::Fibonacci, Sequence::Sobol})
        for (std::uint32_t q = 0; q < 5000; ++q)
            for (const float shift : {0.0F, 0.5F, kAlmost}) {
                const glm::vec2 point = plane_point(sequence, q, 5000U, glm::vec2(shift));
                const float second = second_coordinate(sequence, q, glm::vec2(shift));
                ASSERT_TRUE(point.x >= 0.0F && point.x < 1.0F) << name_of(sequence) << " " << q;
                ASSERT_TRUE(point.y >= 0.0F && point.y < 1.0F) << name_of(sequence) << " " << q;
                ASSERT_TRUE(second >= 0.0F && second < 1.0F) << name_of(sequence) << " " << q;
            }
}

/// Mean power of a 64 x 64 tile's spectrum over frequencies below `radius`, in units of white
/// noise's.
double low_frequency_power(const std::vector<double>& tile, int radius) {
    constexpr int kSize = 64;
    double power = 0.0, variance = 0.0;
    for (const double value : tile)
        variance += (value - 0.5) * (value - 0.5);
    int count = 0;
    for (int v = -radius; v <= radius; ++v)
        for (int u = -radius; u <= radius; ++u) {
            if ((u == 0 && v == 0) || u * u + v * v > radius * radius)
                continue;
            std::complex<double> sum = 0.0;
            for (int y = 0; y < kSize; ++y)
                for (int x = 0; x < kSize; ++x)
                    sum += (tile[static_cast<std::size_t>(y * kSize + x)] - 0.5) *
                           std::polar(1.0, 2.0 * std::acos(-1.0) * (u * x + v * y) / kSize);
            power += std::norm(sum) / variance;
            ++count;
        }
    return power / count;
}

// What blue noise is: every value once, and next to no power at low frequencies. White noise has 1;
// a tile of 4096 ranks by void and cluster about 1e-2 below an eighth of the sampling rate.
TEST(Shifts, BlueNoiseHasNoLowFrequencies) {
    std::array<std::vector<double>, 2> tile;
    std::vector<double> white;
    for (unsigned y = 0; y < 64; ++y)
        for (unsigned x = 0; x < 64; ++x) {
            // A pass' common offset would wrap ranks around: differences from the first take it
            // out.
            const glm::vec2 value = shift_of(Shift::BlueNoise, {x, y}, 0U, 0U) -
                                    shift_of(Shift::BlueNoise, {0U, 0U}, 0U, 0U);
            for (int axis = 0; axis < 2; ++axis)
                tile[static_cast<std::size_t>(axis)].push_back(
                    static_cast<double>(value[axis] - std::floor(value[axis])));
            white.push_back(static_cast<double>(shift_of(Shift::Random, {x, y}, 0U, 0U).x));
        }
    EXPECT_GT(low_frequency_power(white, 8), 0.8);
    for (std::vector<double>& values : tile) {
        EXPECT_LT(low_frequency_power(values, 8), 0.2);
        std::ranges::sort(values);
        for (std::size_t k = 0; k < values.size(); ++k)
            ASSERT_NEAR(values[k] * 4096.0, static_cast<double>(k), 0.01);
    }
    EXPECT_NE(tile[0], white);
}

// Interleaved: 16 shifts that repeat every 4 pixels; another pass has others. Constant: zero.
TEST(Shifts, InterleavedShiftsRepeatEveryFourPixels) {
    std::vector<float> first;
    for (unsigned y = 0; y < 8; ++y)
        for (unsigned x = 0; x < 8; ++x) {
            const glm::vec2 shift = shift_of(Shift::Interleaved, {x, y}, 3U, 7U);
            EXPECT_EQ(shift, shift_of(Shift::Interleaved, {x + 4U, y + 8U}, 3U, 7U));
            EXPECT_NE(shift, shift_of(Shift::Interleaved, {x, y}, 4U, 7U));
            if (x < 4 && y < 4)
                first.push_back(shift.x);
        }
    std::ranges::sort(first);
    EXPECT_EQ(std::ranges::adjacent_find(first), first.end());
    EXPECT_EQ(shift_of(Shift::Constant, {5U, 6U}, 1U, 2U), glm::vec2(0.0F));
}

}  // namespace
}  // namespace nearfield::model
