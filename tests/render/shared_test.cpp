// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene.h"
#include "formats/shared/brdf.glsl.h"
#include "formats/shared/rng.glsl.h"

#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace nearfield {
namespace {

/// Integral of the lobe times the cosine over the hemisphere, midpoint rule in double.
double phong_albedo(double view_angle_rad,
                    float exponent,
                    int cosines = 1000,
                    int azimuths = 1000) {
    const glm::vec3 to_viewer(std::sin(view_angle_rad), 0, std::cos(view_angle_rad));
    double sum = 0.0;
    for (int i = 0; i < cosines; ++i)
        for (int j = 0; j < azimuths; ++j) {
            const double cosine = (i + 0.5) / cosines,
                         phi = glm::two_pi<double>() * (j + 0.5) / azimuths;
            const double sine = std::sqrt(1.0 - cosine * cosine);
            const glm::vec3 to_light(sine * std::cos(phi), sine * std::sin(phi), cosine);
            sum +=
                static_cast<double>(shared::phong_lobe({0, 0, 1}, to_light, to_viewer, exponent)) *
                cosine;
        }
    return sum * glm::two_pi<double>() / cosines / azimuths;
}

// Proves the lobe's normalisation: 1 at normal incidence, never more.
TEST(Shared, PhongLobeReflectsAllAtNormalIncidenceAndNeverMore) {
    for (const float exponent : {0.0F, 1.0F, 7.5F, 60.0F}) {
        EXPECT_NEAR(phong_albedo(0.0, exponent), 1.0, 1e-3)
            << exponent;  // the quadrature's own error
        for (const double angle : {0.5, 1.0, 1.4, 1.57})
            EXPECT_LT(phong_albedo(angle, exponent), 1.001) << exponent << " at " << angle;
    }
    EXPECT_NEAR(phong_albedo(0.0, 1e4F, 1000000, 1), 1.0,
                1e-2);  // float cosines near 1, to the power of 1e4
}

// Proves the mapping's promises: Lambert at roughness 1, base color for metals, diffuse + specular
// <= 1.
TEST(Shared, MaterialsReflectNoMoreThanArrives) {
    const Material rough{"", glm::vec3(0.3F, 0.6F, 0.9F), 0.0F, 1.0F};
    EXPECT_EQ(reflectance(rough).diffuse, rough.base_color);
    EXPECT_EQ(reflectance(rough).specular, glm::vec3(0.0F));
    for (float metallic = 0.0F; metallic <= 1.0F; metallic += 0.25F)
        for (float roughness = 0.0F; roughness <= 1.0F; roughness += 0.125F)
            for (const float base : {0.0F, 0.5F, 1.0F}) {
                const Reflectance r = reflectance({"", glm::vec3(base), metallic, roughness});
                EXPECT_LE(r.diffuse.x + r.specular.x, 1.0F + 1e-6F);
                EXPECT_GE(r.diffuse.x, 0.0F);
                EXPECT_GE(r.exponent, 0.0F);
                EXPECT_LE(r.exponent, 1e4F);
            }
    const Reflectance metal = reflectance({"", rough.base_color, 1.0F, 0.5F});
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
