// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/to_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/rays/planes.h"
#include "tests/rays/ray_file.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nearfield {
namespace {

using std::numbers::pi;

constexpr double kRadius_m = 2e-3, kFlux_lm = 100.0, kDisk_z_m = 3e-3;

rays::RaySet disk(std::size_t count, std::uint64_t seed, double run_m = 0.0) {
    rays::RaySet set;
    set.rays = test::lambertian_disk(count, kRadius_m, kDisk_z_m, kFlux_lm, seed, run_m);
    return set;
}

// Fixed resolution: only the smoothing is chosen, which keeps these tests quick.
rays::ConvertOptions quick() {
    rays::ConvertOptions options;
    options.slabs = 5;
    options.grid = glm::ivec2(9);
    options.texels = glm::ivec2(24);
    return options;
}

double illuminance(const LightField& lf, glm::dvec3 position_m) {
    return model::luminance(model::irradiance(lf, {position_m, {0, 0, -1}}));
}

// Proves that no light is made or lost: kept and dropped add up to what the rays carry, and the
// model's integral of the coefficients is what was kept. Tolerance: coefficients are floats.
TEST(ToLightfield, ConservesFlux) {
    for (const char* basis : {"bspline", "bilinear", "box", "quadratic"}) {
        rays::ConvertOptions options = quick();
        options.basis = basis;
        const rays::Conversion c = rays::to_lightfield(disk(20000, 1), options);
        EXPECT_NEAR(c.report.flux_out + c.report.dropped(), c.report.flux_in, 1e-6 * kFlux_lm);
        EXPECT_NEAR(model::luminance(model::flux(c.lightfield)), c.report.flux_out, 1e-5 * kFlux_lm)
            << basis;
        EXPECT_LT(c.report.dropped(), 0.005 * kFlux_lm);
        check(c.lightfield, "converted");
    }
}

// Proves that a Lambertian disk comes out as one: intensity I0 cos, I0 = flux / pi, and on the axis
// E(d) = flux / (pi (R^2 + d^2)), from nearly touching to far, with all five slabs at work.
TEST(ToLightfield, ReproducesALambertianDisk) {
    const rays::Conversion c = rays::to_lightfield(disk(60000, 2), quick());
    const double z0_m = c.report.slabs.front().s_plane_mm * 1e-3;
    EXPECT_NEAR(z0_m, kDisk_z_m, 2e-5);  // the waist is the disk, within the rays' noise
    // A pitch of 15 degrees holds 2000 rays (7 % is 3 sigma) and blurs the edges of slabs, at 45
    // degrees.
    constexpr double kTolerance = 0.09;
    for (const double distance_m : {5e-4, 2e-3, 1e-2, 1.0}) {
        const double exact = kFlux_lm / (pi * (kRadius_m * kRadius_m + distance_m * distance_m));
        EXPECT_NEAR(illuminance(c.lightfield, {0, 0, kDisk_z_m - z0_m + distance_m}) / exact, 1.0,
                    kTolerance)
            << distance_m;
    }
    for (const double angle_deg : {0.0, 20.0, 35.0, 65.0, 75.0}) {
        double mean = 0.0;
        for (int k = 0; k < 24; ++k) {
            const double t = angle_deg * pi / 180, p = 2 * pi * (k + 0.5) / 24;
            mean += model::luminance(model::intensity(
                        c.lightfield,
                        {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)})) /
                    24;
        }
        EXPECT_NEAR(mean / (kFlux_lm / pi * std::cos(angle_deg * pi / 180)), 1.0, kTolerance)
            << angle_deg;
    }
}

// Proves that where on its way a ray starts does not matter: rays that start beyond the planes are
// followed backwards.
TEST(ToLightfield, FollowsRaysBackwards) {
    const rays::Conversion at_disk = rays::to_lightfield(disk(30000, 3), quick());
    const rays::Conversion beyond = rays::to_lightfield(disk(30000, 3, 5e-3), quick());
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
    rays::RaySet set = disk(20000, 4);
    for (std::size_t r = 0; r < 2000; ++r)
        set.rays[r].direction.z = -set.rays[r].direction.z;
    rays::ConvertOptions options = quick();
    options.slabs = 1;
    const rays::Conversion c = rays::to_lightfield(set, options);
    const double ray_lm = kFlux_lm / 20000;
    EXPECT_NEAR(c.report.dropped_direction, 2000 * ray_lm,
                100 * ray_lm);  // and a few along the plane
    EXPECT_GE(c.report.rays_dropped, 2000U);
    EXPECT_FALSE(c.report.is_good_enough());
    options.slabs = 6;
    const rays::Conversion box = rays::to_lightfield(set, options);
    EXPECT_EQ(box.report.slabs.size(), 6U);
    EXPECT_EQ(box.report.dropped_direction, 0.0);
    EXPECT_TRUE(box.report.is_good_enough());
}

// Proves poses and rotations of all slabs: light that goes out evenly from a small ball off the
// axes arrives evenly at points around the ball. A mirrored or swapped axis would move the ball by
// 2 mm or more and halve the light.
TEST(ToLightfield, SixSlabsPointTheRightWay) {
    rays::RaySet set;
    constexpr std::size_t kCount = 60000;
    const glm::dvec3 ball_m{1e-3, 2e-3, 4e-3};
    for (std::size_t r = 0; r < kCount; ++r) {
        const auto xi = [&](std::uint64_t k) { return test::uniform(5, 5 * r + k); };
        const double z = 2 * xi(0) - 1, a = 2 * pi * xi(1), s = std::sqrt(1 - z * z);
        const glm::dvec3 start = ball_m + 1e-3 * (glm::dvec3(xi(2), xi(3), xi(4)) - 0.5);
        set.rays.push_back(
            {glm::vec3(start), glm::vec3(s * std::cos(a), s * std::sin(a), z), 1e-3F});
    }
    rays::ConvertOptions options = quick();
    options.slabs = 6;
    const rays::Conversion c = rays::to_lightfield(set, options);
    const glm::dvec3 center_m = ball_m - glm::dvec3(0, 0, c.report.slabs.front().s_plane_mm * 1e-3);
    constexpr double kDistance_m = 5e-3;
    const double exact = 60.0 / (4 * pi * kDistance_m * kDistance_m);
    for (const glm::dvec3 d : {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0),
                               glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, -1)}) {
        const double e =
            model::luminance(model::irradiance(c.lightfield, {center_m + kDistance_m * d, -d}));
        // A pitch around a direction holds some 300 of a slab's rays: 3 sigma.
        EXPECT_NEAR(e / exact, 1.0, 0.2) << d.x << d.y << d.z;
    }
}

// Proves that sigma predicts the spread over independent ray sets: right where a receiver sees
// windows wider than the smoothing, and not below the truth anywhere.
TEST(ToLightfield, SigmaPredictsTheSpreadOverRaySets) {
    const std::vector<glm::dvec3> receivers = {{0, 0, 1e-3},       {1e-3, 0, 2e-3}, {0, 0, 5e-3},
                                               {5e-3, 2e-3, 5e-3}, {0, 0, 0.1},     {0.05, 0, 0.1}};
    constexpr int kSets = 12;
    std::vector<double> sum(receivers.size()), squares(receivers.size()),
        predicted(receivers.size());
    double flux_sigma = 0.0;
    rays::ConvertOptions options = quick();
    options.s_plane_mm = kDisk_z_m * 1e3;
    for (int s = 0; s < kSets; ++s) {
        const rays::Conversion c =
            rays::to_lightfield(disk(20000, 100 + static_cast<std::uint64_t>(s)), options);
        for (std::size_t r = 0; r < receivers.size(); ++r) {
            const double e = illuminance(c.lightfield, receivers[r]);
            sum[r] += e / kSets;
            squares[r] += e * e / kSets;
            predicted[r] +=
                model::irradiance_sigma_y(c.lightfield, {receivers[r], {0, 0, -1}}) / kSets;
        }
        flux_sigma = model::flux_sigma_y(c.lightfield);
        EXPECT_NEAR(flux_sigma, kFlux_lm / std::sqrt(20000.0), 0.1 * kFlux_lm / std::sqrt(20000.0));
    }
    for (std::size_t r = 0; r < receivers.size(); ++r) {
        const double spread = std::sqrt((squares[r] - sum[r] * sum[r]) * kSets / (kSets - 1));
        RecordProperty("predicted_over_spread_" + std::to_string(r),
                       std::to_string(predicted[r] / spread));
        // 12 sets know their spread to 20 %. Far away the window on U is one pitch, where images'
        // errors are not independent: sigma may be a third too small. Near, smoothing makes it an
        // upper bound.
        EXPECT_GT(predicted[r] / spread, 0.5) << r;
        EXPECT_LT(predicted[r] / spread, 6.0) << r;
    }
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
    EXPECT_NEAR(model::flux_sigma_y(c.lightfield) / std::sqrt(squares), 1.0, 0.05);
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

}  // namespace
}  // namespace nearfield
