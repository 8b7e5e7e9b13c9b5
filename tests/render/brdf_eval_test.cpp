// SPDX-License-Identifier: Apache-2.0
#include "tests/render/brdf_oracle.h"
#include "tests/support/random.h"

#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield {
namespace {

using shared::Brdf;
using test::LobeCase, test::random_pair;

constexpr std::array<double, 6> kAngles = {0.0, 0.4, 0.9, 1.3, 1.5, 1.56};

/// Relative error of float values: directions are off by 1e-7, which narrow lobes turn into more.
double rounding(const Brdf& brdf, glm::vec3 to_viewer) {
    return 1e-5 + 1e-5 / static_cast<double>(shared::brdf_lobe_width_rad(brdf, to_viewer));
}

/// Of brdf_eval times cosine, red.
double albedo(const Brdf& brdf, glm::vec3 to_viewer, int pieces) {
    return test::integrate(test::LobeMap(brdf, to_viewer), pieces, [&](glm::dvec3 l) {
        return static_cast<double>(shared::brdf_eval(brdf, glm::vec3(l), to_viewer).x) * l.z;
    });
}

// Proves that the header's rearranged float formulas are the papers', for lights spread by the lobe
// and by the cosine. Fresnel's factor is 1 here.
TEST(Brdf, LobesAgreeWithThePapersInDouble) {
    support::Random random{1};
    for (const LobeCase& lobe : test::lobe_cases())
        for (const double angle : kAngles) {
            const glm::vec3 v = test::viewer_at(angle);
            const double tolerance = rounding(lobe.brdf, v);
            int compared = 0;
            for (int k = 0; k < 2000; ++k) {
                const glm::vec3 l =
                    k % 2 == 0 ? shared::brdf_lobe_sample(lobe.brdf, v, random_pair(random))
                               : shared::cosine_power_sample({0, 0, 1}, 1.0F, random_pair(random));
                const double expected =
                    l.z > 1e-3F ? test::oracle_lobe(lobe.brdf, glm::normalize(glm::dvec3(l)),
                                                    glm::normalize(glm::dvec3(v)))
                                : 0.0;
                // Far out in the tail only the order of magnitude matters.
                if (!(expected > 1e-2))
                    continue;
                ++compared;
                const auto got = static_cast<double>(shared::brdf_lobe(lobe.brdf, l, v).x);
                ASSERT_NEAR(got / expected, 1.0, tolerance) << lobe.name << ", viewer " << angle;
            }
            // Lafortune's tilted lobes of high power vanish for oblique viewers.
            EXPECT_TRUE(compared > 100 || lobe.brdf.kind == shared::kBrdfLafortune)
                << lobe.name << ", viewer " << angle;
        }
}

// Proves reciprocity of every lobe, Fresnel's factor included, for directions drawn by the lobe. A
// GGX with a diffuse part is not reciprocal as a whole, and is left out.
TEST(Brdf, LobesAreReciprocal) {
    support::Random random{2};
    for (LobeCase lobe : test::lobe_cases()) {
        lobe.brdf.specular = {0.04F, 0.5F, 0.9F};
        for (int k = 0; k < 2000; ++k) {
            const glm::vec3 v = shared::cosine_power_sample({0, 0, 1}, 1.0F, random_pair(random));
            const glm::vec3 l = shared::brdf_lobe_sample(lobe.brdf, v, random_pair(random));
            if (!(std::min(l.z, v.z) > 0.1F))
                continue;
            const glm::vec3 there = shared::brdf_lobe(lobe.brdf, l, v),
                            back = shared::brdf_lobe(lobe.brdf, v, l);
            const double tolerance = std::max(rounding(lobe.brdf, v), rounding(lobe.brdf, l));
            for (int c = 0; c < 3; ++c)
                if (there[c] > 1e-2F) {
                    ASSERT_NEAR(back[c] / there[c], 1.0, tolerance) << lobe.name;
                }
        }
    }
}

// Proves that no lobe of weight 1 reflects more than arrives, at any angle. Phong's reaches 1 at
// normal incidence. Lobes that float directions cannot resolve are left out.
TEST(Brdf, LobesReflectNoMoreThanArrives) {
    // The quadrature is good to 1e-4 up to 1.3 rad, to 1 % at 1.56; no albedo there is near 1.
    constexpr double kError = 1e-4;
    for (const LobeCase& lobe : test::lobe_cases())
        for (const double angle : kAngles) {
            const glm::vec3 v = test::viewer_at(angle);
            if (shared::brdf_lobe_width_rad(lobe.brdf, v) < 1e-4F)
                continue;
            const double value = albedo(lobe.brdf, v, 16);
            EXPECT_LE(value, 1.0 + kError) << lobe.name << ", viewer " << angle;
            EXPECT_GT(value, 0.0) << lobe.name << ", viewer " << angle;
            if (lobe.brdf.kind == shared::kBrdfPhong && angle == 0.0) {
                EXPECT_NEAR(value, 1.0, kError) << lobe.name;
            }
        }
}

// Proves the halfway disk's albedo against its closed form: the mean of (1 - r^2)/(1 - |v|^2 r^2)
// over r^2 of density (n + 1)(1 - r^2)^n, in one dimension.
TEST(Brdf, HalfwayDiskHasTheAlbedoOfItsClosedForm) {
    Brdf brdf{};
    brdf.kind = shared::kBrdfHalfwayDisk;
    brdf.specular = glm::vec3(1.0F);
    for (const float exponent : {0.0F, 1.0F, 30.0F})
        for (const double angle : {0.0, 0.4, 0.9, 1.3}) {
            brdf.exponent = exponent;
            constexpr int kSteps = 100000;
            double expected = 0.0;
            for (int k = 0; k < kSteps; ++k) {
                const double rest =
                    std::pow((k + 0.5) / kSteps, 1.0 / (static_cast<double>(exponent) + 1.0));
                expected += rest / (1.0 - std::pow(std::sin(angle), 2.0) * (1.0 - rest)) / kSteps;
            }
            EXPECT_NEAR(albedo(brdf, test::viewer_at(angle), 40), expected, 1e-4)
                << exponent << ", viewer " << angle;
        }
}

// Proves that a GGX surface with a diffuse part, white at worst, reflects no more than arrives but
// for 0.25 %: Fresnel's mean over rough facets exceeds its value at the viewer's angle, which the
// diffuse part is reduced by, by that much (at 45 degrees). Other kinds: exactly the sum of parts.
TEST(Brdf, DiffuseUnderGgxKeepsEnergy) {
    Brdf brdf{};
    brdf.kind = shared::kBrdfGgx;
    brdf.diffuse = glm::vec3(1.0F);
    double most = 0.0;
    for (const float f0 : {0.02F, 0.04F, 0.3F, 1.0F})
        for (const float alpha : {0.01F, 0.1F, 0.2F, 0.5F, 1.0F})
            for (const double angle : {0.0, 0.4, 0.8, 1.1, 1.3, 1.5, 1.56}) {
                brdf.specular = glm::vec3(f0);
                brdf.alpha = glm::vec2(alpha);
                most = std::max(most, albedo(brdf, test::viewer_at(angle), 24));
            }
    EXPECT_LE(most, 1.0025);
    EXPECT_GT(most, 0.999);  // reached by the mirror-like ones
}

// Proves Schlick's formula at its ends and in the middle.
TEST(Brdf, FresnelRunsFromF0ToOne) {
    const glm::vec3 f0(0.04F, 0.5F, 1.0F);
    EXPECT_EQ(shared::schlick_fresnel(f0, 1.0F), f0);
    EXPECT_EQ(shared::schlick_fresnel(f0, 0.0F), glm::vec3(1.0F));
    EXPECT_NEAR(shared::schlick_fresnel(f0, 0.5F).x, 0.04 + 0.96 / 32.0, 1e-7);
}

// Proves the width's meaning: where the light has moved by it from the middle, in the worst
// direction, the lobe has fallen to about exp(-1/2) = 0.61.
TEST(Brdf, LobeWidthIsWhereTheLobeHasFallenToSixTenths) {
    for (const LobeCase& lobe : test::lobe_cases())
        for (const double angle : {0.0, 0.4, 0.8, 1.2}) {
            const glm::vec3 v = test::viewer_at(angle);
            const auto width = static_cast<double>(shared::brdf_lobe_width_rad(lobe.brdf, v));
            if (width > 0.2)
                continue;  // wide lobes lean, and reach the horizon
            const glm::dvec3 middle = test::lobe_middle(lobe.brdf, v);
            const shared::SurfaceFrame frame = shared::frame_from_normal(glm::vec3(middle));
            const double top = test::oracle_lobe(lobe.brdf, middle, v);
            double least = 1.0;
            for (int k = 0; k < 360; ++k) {
                const double azimuth = glm::radians(static_cast<double>(k));
                const glm::dvec3 l = glm::normalize(
                    middle + std::tan(width) * (std::cos(azimuth) * glm::dvec3(frame.x) +
                                                std::sin(azimuth) * glm::dvec3(frame.y)));
                least = std::min(least, test::oracle_lobe(lobe.brdf, l, v) / top);
            }
            EXPECT_GT(least, 0.5) << lobe.name << ", viewer " << angle;
            // Stretched lobes lie across the viewer as they like: there it is a lower bound.
            if (lobe.brdf.alpha.x == lobe.brdf.alpha.y) {
                EXPECT_LT(least, 0.7) << lobe.name << ", viewer " << angle;
            }
        }
}

/// What a picture may ask for, and worse.
std::vector<glm::vec3> awkward_directions() {
    std::vector<glm::vec3> directions = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
    for (const double height : {1e-30, 1e-12, 1e-6, 2e-6, 1e-4, 0.3, 0.9999999})
        for (const double azimuth : {0.0, 1.0, 2.5, 4.7}) {
            const glm::vec3 up = test::viewer_at(std::acos(height), azimuth);
            directions.insert(directions.end(), {up, {-up.x, -up.y, up.z}, -up});
        }
    return directions;
}

// Proves that the extremes of every parameter, grazing and hidden directions and the ends of the
// random numbers give finite numbers >= 0 and directions of unit length.
TEST(Brdf, ExtremesGiveFiniteNumbers) {
    std::vector<Brdf> brdfs;
    for (shared::uint kind = shared::kBrdfPhong; kind <= shared::kBrdfHalfwayDisk; ++kind)
        for (const float shape : {0.0F, 1.0F})
            for (const glm::vec3 cosines : {glm::vec3(-1, -1, 1), glm::vec3(0, 0, 1e-3F)}) {
                Brdf brdf{};
                brdf.kind = kind;
                brdf.diffuse = {0.5F, 0.0F, 0.0F};
                brdf.specular = {0.5F, 0.04F, 0.0F};
                brdf.alpha = {glm::mix(1.0F, 1e-3F, shape), 1e-3F};
                brdf.exponent = 1e6F * shape;
                brdf.cosines = cosines;
                brdfs.push_back(brdf);
            }
    constexpr float kBelowOne = 1.0F - 0x1p-24F;
    const std::vector<glm::vec3> directions = awkward_directions();
    for (const Brdf& brdf : brdfs)
        for (const glm::vec3 v : directions) {
            for (const glm::vec3 l : directions) {
                const glm::vec3 value = shared::brdf_eval(brdf, l, v);
                const float density = shared::brdf_density(brdf, l, v);
                ASSERT_TRUE(value.x >= 0.0F && value.x < 1e37F) << brdf.kind;
                ASSERT_TRUE(density >= 0.0F && density < 1e37F) << brdf.kind;
                if (l.z <= 0.0F || v.z <= 0.0F) {
                    ASSERT_EQ(value, glm::vec3(0.0F)) << brdf.kind;
                    ASSERT_EQ(density, 0.0F) << brdf.kind;
                }
            }
            for (const float a : {0.0F, 0.5F, kBelowOne})
                for (const float b : {0.0F, 0.5F, kBelowOne})
                    for (const float c : {0.0F, kBelowOne})
                        ASSERT_NEAR(glm::length(shared::brdf_sample(brdf, v, {a, b, c})), 1.0F,
                                    1e-5F)
                            << brdf.kind << ", viewer " << v.z;
        }
}

// Proves that frames are right-handed, of unit length, and keep the normal, also for normals at
// which the construction changes sides; and that a tangent decides x unless it says nothing.
TEST(Brdf, FramesAreOrthonormal) {
    support::Random random{3};
    for (int k = 0; k < 1000; ++k) {
        glm::vec3 n = shared::cosine_power_sample({0, 0, 1}, 0.0F, random_pair(random));
        if (k % 2 == 1)
            n.z = -n.z;
        if (k % 10 == 0)
            n = glm::normalize(glm::vec3(n.x, n.y, k % 20 == 0 ? -1e-7F : 0.0F));
        const glm::vec3 t = shared::cosine_power_sample({1, 0, 0}, 0.0F, random_pair(random));
        for (const shared::SurfaceFrame& frame :
             {shared::frame_from_normal(n), shared::frame_from_tangent(n, t * 7.0F)}) {
            EXPECT_EQ(frame.z, n);
            EXPECT_LT(glm::distance(glm::cross(frame.x, frame.y), n), 2e-6F);
            EXPECT_NEAR(glm::dot(frame.x, frame.y), 0.0F, 1e-6F);
            EXPECT_NEAR(glm::length(frame.x), 1.0F, 1e-6F);
            const glm::vec3 there = shared::local_from_world(frame, t);
            EXPECT_LT(glm::distance(shared::world_from_local(frame, there), t), 2e-6F);
        }
        const glm::vec3 local = shared::local_from_world(shared::frame_from_tangent(n, t), t);
        EXPECT_GT(local.x, 0.0F);
        EXPECT_NEAR(local.y, 0.0F, 1e-6F);
        EXPECT_EQ(shared::frame_from_tangent(n, n * 0.3F).x, shared::frame_from_normal(n).x);
        EXPECT_EQ(shared::frame_from_tangent(n, glm::vec3(0.0F)).x, shared::frame_from_normal(n).x);
    }
    for (const float z : {1.0F, -1.0F})
        EXPECT_EQ(shared::frame_from_normal({0, 0, z}).x, glm::vec3(1, 0, 0));
}

}  // namespace
}  // namespace nearfield
