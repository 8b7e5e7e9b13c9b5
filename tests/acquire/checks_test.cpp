// SPDX-License-Identifier: Apache-2.0
#include "acquire/checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nearfield::acquire {
namespace {

// A sensor of 12 bits, 2 electrons a DN, 8 electrons of read noise, black 100, light over three
// decades.
capture::Frame exposed(double exposure_us, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    capture::Frame frame;
    frame.size_px = {64, 64};
    frame.bits = 12;
    for (int k = 0; k < 64 * 64; ++k) {
        const double light_e_per_us = 10 * std::pow(10.0, -3.0 * k / (64 * 64));
        const double mean_e = light_e_per_us * exposure_us;
        const double electrons = mean_e + noise(random) * std::sqrt(mean_e + 64);
        frame.values.push_back(
            static_cast<std::uint16_t>(std::clamp(std::lround(100 + electrons / 2), 0L, 4095L)));
    }
    return frame;
}

TEST(ExposureRatio, IsTheTrueOne) {
    for (const double ratio : {1.0, 1.5, 4.0, 8.0})
        for (unsigned seed = 0; seed < 8; ++seed) {
            const capture::Frame a = exposed(300, 2 * seed), b = exposed(300 * ratio, 2 * seed + 1);
            const std::optional<double> got = exposure_ratio({&a, 100, 0}, {&b, 100, 0});
            ASSERT_TRUE(got);
            // Some 1000 pixels of at least 100 electrons: 0.3 % of noise, which 4 sigma hold.
            EXPECT_NEAR(*got / ratio, 1, 0.012) << ratio;
        }
}

TEST(ExposureRatio, SaysNothingWhereTooFewPixelsTell) {
    const capture::Frame dark = exposed(0.01, 1), bright = exposed(1e6, 2);
    EXPECT_FALSE(exposure_ratio({&dark, 100, 0}, {&dark, 100, 0}));
    EXPECT_FALSE(exposure_ratio({&bright, 100, 0}, {&bright, 100, 0}));
    const capture::Frame b = exposed(300, 3), a = exposed(1, 4);
    EXPECT_FALSE(exposure_ratio({&a, 100, 0}, {&b, 100, 0}));
}

// Noise-free pixels, counted by hand.
TEST(ExposedTwice, CountsPixels) {
    const auto frame = [](std::vector<std::uint16_t> values) {
        capture::Frame made;
        made.size_px = {static_cast<int>(values.size()), 1};
        made.bits = 12;
        made.values = std::move(values);
        return made;
    };
    // The light of four pixels: 4, 1, 0.25 and (hardly any) 0.001 DN / us.
    const capture::Frame a = frame({400, 100, 25, 0}), b = frame({1600, 400, 100, 0}),
                         c = frame({4095, 1600, 400, 1});
    const std::vector<Signal> bracket = {{&a, 0, 100}, {&b, 0, 400}, {&c, 0, 1600}};
    // Well exposed is 205 ... 3276: pixel 0 in a and b, pixel 1 in b and c, pixel 2 in c alone.
    ExposureTally all, two;
    tally(bracket, all);
    tally(std::span(bracket).first(2), two);
    EXPECT_NEAR(share_exposed_twice(all, 0.03), 2.0 / 3.0, 1e-12);
    EXPECT_NEAR(share_exposed_twice(all, 0.2), 1, 1e-12);
    EXPECT_NEAR(share_exposed_twice(two, 0.2), 0.5, 1e-12);
    EXPECT_NEAR(share_exposed_twice(ExposureTally{}, 0.2), 1, 1e-12);
}

TEST(ExposureLatency, IsTheFirstNewFrame) {
    const std::vector<double> at_once = {400, 401, 399, 400, 400},
                              two_late = {101, 100, 399, 402, 400};
    EXPECT_EQ(exposure_latency(100, at_once, 0.02), 0);
    EXPECT_EQ(exposure_latency(100, two_late, 0.02), 2);
    EXPECT_EQ(exposure_latency(400, std::vector<double>{400, 100, 100}, 0.02), 1);
    EXPECT_FALSE(exposure_latency(100, std::vector<double>{100, 101, 100.5}, 0.02));
}

}  // namespace
}  // namespace nearfield::acquire
