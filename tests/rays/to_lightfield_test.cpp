// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/to_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/slab_axes.h"
#include "formats/rays/planes.h"
#include "formats/rays/report.h"
#include "tests/rays/disk.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace nearfield {
namespace {

using std::numbers::pi;

using test::disk;
using test::illuminance;
using test::kDisk_z_m;
using test::kFlux_lm;
using test::kRadius_m;
using test::quick;

// Proves that no light is made or lost: kept and dropped add up to what the rays carry, and the
// model's integral of the coefficients is what was kept. Tolerance: coefficients are floats.
TEST(ToLightfield, ConservesFlux) {
    for (const char* basis : {"bspline", "bilinear", "box", "quadratic"}) {
        rays::ConvertOptions options = quick();
        options.basis = basis;
        const rays::Conversion c = rays::to_lightfield(disk(6000, 1), options);
        EXPECT_NEAR(c.report.flux_out + c.report.dropped(), c.report.flux_in, 1e-6 * kFlux_lm);
        EXPECT_NEAR(model::luminance(model::flux(c.lightfield)), c.report.flux_out, 1e-5 * kFlux_lm)
            << basis;
        EXPECT_LT(c.report.dropped(), 0.005 * kFlux_lm);
        check(c.lightfield, "converted");
    }
}

// Proves that slabs' parts of a direction add up to one, end near the slab's edge, pass smoothly
// and are equal where axes are equally dominant. Not what that does to light: lambertian_test.cpp.
TEST(SlabShares, AddUpToOneAndPassSmoothly) {
    constexpr int kSteps = 20000;
    std::array<float, 6> before{};
    for (int k = 0; k <= kSteps; ++k) {
        // A spiral from pole to pole, 20 turns: 0.36 degrees or less a step.
        const double t = pi * k / kSteps, p = 40 * pi * k / kSteps;
        const glm::vec3 d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
        const std::array<float, 6> shares = model::slab_shares(d, 6);
        float sum = 0.0F;
        for (std::size_t s = 0; s < 6; ++s) {
            const glm::vec3 axis(model::axes_from_slab(static_cast<int>(s))[2]);
            EXPECT_GE(shares[s], 0.0F);
            // Where its component is 0.84 of both others, 59.3 degrees from its axis, a slab ends.
            const bool is_near = glm::dot(d, axis) > std::cos(glm::radians(59.5F));
            EXPECT_TRUE(is_near || shares[s] == 0.0F) << k;
            // Steepest is 1.5 over the band's 10 degrees, 0.054 a step; twice that in corners.
            EXPECT_TRUE(k == 0 || std::abs(shares[s] - before[s]) < 0.11F) << k;
            sum += shares[s];
        }
        EXPECT_NEAR(sum, 1.0F, 1e-6F);
        before = shares;
    }
    const auto corner = model::slab_shares(glm::normalize(glm::vec3(-1, 1, 1)), 6);
    for (const std::size_t s : {0U, 2U, 3U})
        EXPECT_NEAR(corner[s], 1.0F / 3.0F, 1e-6F);
    EXPECT_NEAR(model::slab_shares(glm::normalize(glm::vec3(1, 0, 1)), 6)[1], 0.5F, 1e-6F);
}

// Proves that without a slab towards -z the others take what they share with it whole, up to where
// -z dominates, and nothing beyond.
TEST(SlabShares, GiveWhatNobodyTakesToTheOthersWhereTheyDominate) {
    const glm::vec3 down_a_little = glm::normalize(glm::vec3(1, 0, -0.99)),
                    down = glm::normalize(glm::vec3(0.99, 0, -1));
    EXPECT_GT(model::slab_shares(down_a_little, 6)[5], 0.4F);
    EXPECT_EQ(model::slab_shares(down_a_little, 5)[1], 1.0F);
    EXPECT_EQ(model::slab_shares(down, 5), (std::array<float, 6>{}));
}

// Proves that where on its way a ray starts does not matter: rays that start beyond the planes are
// followed backwards.
TEST(ToLightfield, FollowsRaysBackwards) {
    const rays::Conversion at_disk = rays::to_lightfield(disk(12000, 3), quick());
    const rays::Conversion beyond = rays::to_lightfield(disk(12000, 3, 5e-3), quick());
    // The same rays cross the same planes but for floats' rounding, which may move a ray to the
    // next texel.
    for (const double x_m : {0.0, 1e-3, 3e-3}) {
        const double e = illuminance(at_disk.lightfield, {x_m, 0, 2e-3});
        EXPECT_NEAR(illuminance(beyond.lightfield, {x_m, 0, 2e-3}) / e, 1.0, 0.01) << x_m;
    }
}

// Proves that light the slabs cannot hold is counted by cause, and that much of it makes the result
// not good enough.
TEST(ToLightfield, CountsWhatItDrops) {
    rays::RaySet set = disk(10000, 4);
    for (std::size_t r = 0; r < 1000; ++r)
        set.rays[r].direction.z = -set.rays[r].direction.z;
    rays::ConvertOptions options = quick();
    options.slabs = 1;
    const rays::Conversion c = rays::to_lightfield(set, options);
    const double ray_lm = kFlux_lm / 10000;
    EXPECT_NEAR(c.report.dropped_direction, 1000 * ray_lm,
                50 * ray_lm);  // and a few along the plane
    EXPECT_GE(c.report.rays_dropped, 1000.0);
    EXPECT_FALSE(c.report.is_good_enough());
    options.slabs = 6;
    const rays::Conversion box = rays::to_lightfield(set, options);
    EXPECT_EQ(box.report.slabs.size(), 6U);
    EXPECT_EQ(box.report.dropped_direction, 0.0);
    EXPECT_TRUE(box.report.is_good_enough());
}

// Proves that rays of unequal flux count by their effective number: sigma of the flux is the root
// of summed squares.
TEST(ToLightfield, UnequalRaysCountByTheirSquares) {
    rays::RaySet set = disk(20000, 6);
    double squares = 0.0;
    for (std::size_t r = 0; r < set.rays.size(); ++r) {
        set.rays[r].flux *= r % 10 == 0 ? 10.0F : 0.1F;
        squares += static_cast<double>(set.rays[r].flux) * set.rays[r].flux;
    }
    const rays::Conversion c = rays::to_lightfield(set, quick());
    // Four fifths of the variance come from 2000 rays, of which few are dropped: 1 %. Counting a
    // shared ray as two would give 2 % less.
    EXPECT_NEAR(model::flux_sigma_y(c.lightfield) / std::sqrt(squares), 1.0, 0.01);
}

// Proves that color follows its rays: red from the left half, blue from the right, Y as without
// color.
TEST(ToLightfield, KeepsEveryRaysColor) {
    rays::RaySet set = disk(20000, 7);
    for (const rays::Ray& ray : set.rays)
        set.colors.push_back(ray.position_m.x < 0 ? glm::vec3(1 / 0.2126F, 0, 0)
                                                  : glm::vec3(0, 0, 1 / 0.0722F));
    const rays::Conversion c = rays::to_lightfield(set, quick());
    EXPECT_EQ(c.lightfield.slabs[0].channels, 3);
    const glm::dvec3 left = model::irradiance(c.lightfield, {{-1.5e-3, 0, 1e-4}, {0, 0, -1}});
    EXPECT_GT(left.r * 0.2126, 4 * left.b * 0.0722);  // a block's width of mixing
    set.colors.clear();
    const rays::Conversion gray = rays::to_lightfield(set, quick());
    EXPECT_NEAR(model::luminance(model::flux(c.lightfield)),
                model::luminance(model::flux(gray.lightfield)), 1e-4 * kFlux_lm);
    EXPECT_NEAR(model::flux_sigma_y(c.lightfield) / model::flux_sigma_y(gray.lightfield), 1.0,
                0.01);
}

// Proves that the result does not depend on the number of threads, bit for bit, and chooses
// resolutions on its own.
TEST(ToLightfield, DoesNotDependOnThreads) {
    rays::ConvertOptions options;
    const rays::Conversion many = rays::to_lightfield(disk(5000, 8), options);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const rays::Conversion single = rays::to_lightfield(disk(5000, 8), options);
    ASSERT_EQ(many.lightfield.slabs.size(), 5U);
    for (std::size_t s = 0; s < 5; ++s) {
        EXPECT_EQ(many.lightfield.slabs[s].coeffs, single.lightfield.slabs[s].coeffs);
        EXPECT_EQ(many.lightfield.slabs[s].sigma, single.lightfield.slabs[s].sigma);
    }
}

TEST(ToLightfield, RefusesOptionsOutOfRange) {
    const auto refuses = [](auto change) {
        rays::ConvertOptions options = quick();
        change(options);
        EXPECT_THROW(rays::to_lightfield(disk(100, 9), options), Error);
    };
    refuses([](rays::ConvertOptions& o) { o.slabs = 2; });
    refuses([](rays::ConvertOptions& o) { o.grid = glm::ivec2(2, 9); });
    refuses([](rays::ConvertOptions& o) { o.texels = glm::ivec2(0, 9); });
    refuses([](rays::ConvertOptions& o) { o.texels = glm::ivec2(9999); });
    refuses([](rays::ConvertOptions& o) { o.basis = "sinc"; });
    refuses([](rays::ConvertOptions& o) { o.u_plane_mm = NAN; });
    refuses([](rays::ConvertOptions& o) { o.u_plane_mm = o.s_plane_mm = 1.0; });
}

// Proves that one slab takes the planes it is given and leaves out little of a lamp that shines
// forward.
TEST(ToLightfield, TakesThePlanesItIsGiven) {
    rays::ConvertOptions options = quick();
    options.u_plane_mm = -5.0;
    options.s_plane_mm = 4.0;
    const rays::Conversion c = rays::to_lightfield(disk(20000, 10), options);
    EXPECT_NEAR(c.lightfield.slabs[0].delta_m, 9e-3, 1e-12);
    EXPECT_EQ(c.lightfield.slabs[0].luminaire_from_slab.translation_m, glm::dvec3(0.0));
    const double e = illuminance(c.lightfield, {0, 0, kDisk_z_m - 4e-3 + 0.01});
    EXPECT_NEAR(e * pi * (kRadius_m * kRadius_m + 1e-4) / kFlux_lm, 1.0, 0.05);
}

// A Lambertian disk's light all goes forwards; one slab drops what slants most.
TEST(ToLightfield, TellsTheAnglesOfWhatItDrops) {
    rays::RaySet set;
    set.rays = test::lambertian_disk(20000, 0.002, 0.0, 100.0, 5);
    for (int k = 0; k < 100; ++k)
        set.rays.push_back({glm::vec3(0), glm::normalize(glm::vec3(0.1F, 0, -1)), 0.001F});
    rays::ConvertOptions options;
    options.slabs = 1;
    options.grid = {5, 5};
    options.texels = {8, 8};
    const rays::ConvertReport report = rays::to_lightfield(set, options).report;
    EXPECT_NEAR(report.direction_angles.most_deg, 180 - 5.71, 0.01);
    EXPECT_GT(report.direction_angles.least_deg, 89.9);
    EXPECT_LE(report.s_angles.most_deg, 90);
    EXPECT_GT(std::max(report.s_angles.most_deg, report.u_angles.most_deg), 70);
    EXPECT_NE(rays::summary(set, report).find(" ... 174.3 deg from +z)"), std::string::npos);
}

}  // namespace
}  // namespace nearfield
