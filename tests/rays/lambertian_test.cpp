// SPDX-License-Identifier: Apache-2.0
// Light fields from many rays against what they were drawn from: statistics, by fixed seeds.
#include "formats/rays/to_lightfield.h"
#include "tests/rays/disk.h"

#include <gtest/gtest.h>

#include <algorithm>
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

// Proves that a Lambertian disk comes out as one: intensity I0 cos, I0 = flux / pi, and on the axis
// E(d) = flux / (pi (R^2 + d^2)), from nearly touching to far, with all five slabs at work.
TEST(ToLightfield, ReproducesALambertianDisk) {
    const rays::Conversion c = rays::to_lightfield(disk(60000, 2), quick());
    const double z0_m = c.report.slabs.front().s_plane_mm * 1e-3;
    EXPECT_NEAR(z0_m, kDisk_z_m, 2e-5);  // the waist is the disk, within the rays' noise
    // Blur by the pitch, here 19 degrees, shifts the mean over six ray sets by up to 6.5 % (at 35
    // degrees, where the slabs' edges at 45 blur inwards; 0.8 % there at a pitch of 10 degrees).
    // Noise between sets: 0.3 to 1.3 % (a basis function counts 8000 rays: 1.1 %). The largest sum
    // of shift and 3 sigma is 7.9 %.
    constexpr double kTolerance = 0.08;
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

}  // namespace
}  // namespace nearfield
