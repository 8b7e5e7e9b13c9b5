// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene.h"
#include "formats/shared/brdf.glsl.h"
#include "formats/shared/rng.glsl.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace nearfield {
namespace {

// Proves the mapping's promises: Lambert at roughness 1, base color for metals, diffuse + specular
// <= 1.
TEST(Shared, MaterialsReflectNoMoreThanArrives) {
    const Material rough{"", glm::vec3(0.3F, 0.6F, 0.9F), 0.0F, 1.0F};
    EXPECT_EQ(brdf(rough).diffuse, rough.base_color);
    EXPECT_EQ(brdf(rough).specular, glm::vec3(0.0F));
    for (float metallic = 0.0F; metallic <= 1.0F; metallic += 0.25F)
        for (float roughness = 0.0F; roughness <= 1.0F; roughness += 0.125F)
            for (const float base : {0.0F, 0.5F, 1.0F}) {
                const shared::Brdf r = brdf({"", glm::vec3(base), metallic, roughness});
                EXPECT_LE(r.diffuse.x + r.specular.x, 1.0F + 1e-6F);
                EXPECT_GE(r.diffuse.x, 0.0F);
                EXPECT_GE(r.exponent, 0.0F);
                EXPECT_LE(r.exponent, 1e4F);
            }
    const shared::Brdf metal = brdf({"", rough.base_color, 1.0F, 0.5F});
    EXPECT_EQ(metal.diffuse, glm::vec3(0.0F));
    EXPECT_EQ(metal.specular, rough.base_color);
}

// Proves evenness of the hash in each word over a counter (chi-square, 255 degrees of freedom; 330
// is exceeded once in 1000 times, seeds are fixed) and independence from the neighboring counter.
TEST(Shared, HashIsEvenAndNeighborsAreIndependent) {
    constexpr unsigned kDraws = 1U << 16U;
    for (int word = 0; word < 4; ++word) {
        std::array<unsigned, 256> histogram{}, joint{};
        for (unsigned i = 0; i < kDraws; ++i) {
            const unsigned a = shared::hash4({i, 3U, 1U, 0U})[word],
                           b = shared::hash4({i + 1, 3U, 1U, 0U})[word];
            ++histogram[a >> 24U];
            ++joint[(a >> 28U) * 16U + (b >> 28U)];
        }
        for (const auto& bins : {histogram, joint}) {
            double chi_square = 0.0;
            for (const unsigned count : bins)
                chi_square += std::pow(count - kDraws / 256.0, 2) / (kDraws / 256.0);
            EXPECT_LT(chi_square, 330.0) << word;
        }
    }
}

// Proves the lattice at large q, where a float product would have lost its digits: one point in
// every cell of a partition that the lattice's discrepancy allows, and never 1.
TEST(Shared, LatticeStaysEvenFarOut) {
    std::array<unsigned, 64> histogram{};
    for (unsigned q = 100000000; q < 100000000 + 6400; ++q) {
        const glm::vec2 p = shared::r2_point(q, {12345U, 999U});
        ASSERT_LT(p.x, 1.0F);
        ASSERT_LT(p.y, 1.0F);
        ++histogram[static_cast<std::size_t>(p.x * 8.0F) * 8 +
                    static_cast<std::size_t>(p.y * 8.0F)];
    }
    for (const unsigned count : histogram)
        EXPECT_NEAR(count, 100.0, 8.0);  // random points would stray by 10 in one sigma
    EXPECT_LT(shared::unit_float(0xFFFFFFFFU), 1.0F);
}

}  // namespace
}  // namespace nearfield
