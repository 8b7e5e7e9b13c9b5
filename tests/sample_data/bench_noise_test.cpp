// SPDX-License-Identifier: Apache-2.0
// The sensor by statistics: what a photon transfer curve, dark frames and pairs of frames recover.
#include "formats/files/error.h"
#include "sample_data/bench/bench_random.h"
#include "tests/sample_data/bench_small.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::sample_data {
namespace {

using Raw = std::vector<std::uint16_t>;

double mean(const Raw& raw) {
    double sum = 0.0;
    for (const std::uint16_t value : raw)
        sum += value;
    return sum / static_cast<double>(raw.size());
}

// Temporal variance of a pixel, from the difference of two frames.
double variance(const Raw& a, const Raw& b) {
    double sum = 0.0, square = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double difference = double(a[k]) - double(b[k]);
        sum += difference;
        square += difference * difference;
    }
    const double count = static_cast<double>(a.size());
    return 0.5 * (square / count - sum / count * sum / count);
}

struct Level {
    double mean_dn = 0, variance_dn2 = 0;
};

// Mean above black and temporal variance over many pairs of frames.
Level level(const PreparedBench& prepared, Shot shot, int pairs) {
    Level result;
    for (int k = 0; k < pairs; ++k) {
        shot.frame_number = static_cast<std::uint64_t>(2 * k);
        const Raw a = expose(prepared, shot);
        shot.frame_number += 1;
        const Raw b = expose(prepared, shot);
        result.mean_dn += 0.5 * (mean(a) + mean(b)) / pairs;
        result.variance_dn2 += variance(a, b) / pairs;
    }
    result.mean_dn -= bench_of(prepared).camera.black_level_dn;
    return result;
}

Shot flat_shot(double exposure_us) {
    Shot shot;
    shot.subject = Subject::Flat;
    shot.exposure_us = exposure_us;
    return shot;
}

constexpr double kFlatPerSecond = 100.0 * (150 + 250 + 90);  // electrons, test::even_bench()
constexpr int kPairs = 8;
constexpr int kPixels = 64 * 64;
// One sigma of a variance estimated from all pairs, relative; and four of them are allowed.
const double kVarianceSigma = std::sqrt(2.0 / (kPairs * kPixels));
constexpr double kSigmas = 4.0;

TEST(BenchNoise, PhotonTransferCurveGivesGainAndReadNoise) {
    Bench bench = test::even_bench();
    bench.camera.prnu_sigma_rel = 0.02;  // of no effect on differences of frames
    bench.camera.dark_e_per_s = 0.0;
    bench.camera.full_well_e = 60000;
    const Prepared prepared = prepare(bench);
    const double gain = bench.camera.gain_e_per_dn, read = bench.camera.read_noise_e;
    for (const double exposure_us : {0.0, 20.0, 100.0, 400.0, 2000.0, 20000.0, 200000.0}) {
        const Level seen = level(*prepared, flat_shot(exposure_us), kPairs);
        const double electrons = kFlatPerSecond * exposure_us * 1e-6;
        // Shot noise, read noise, rounding to whole numbers.
        const double expected = (electrons + read * read) / (gain * gain) + 1.0 / 12.0;
        EXPECT_NEAR(seen.variance_dn2 / expected, 1.0, kSigmas * kVarianceSigma) << exposure_us;
        // The even source is even to floats; 2 % of 4096 pixels' pattern remains in the mean.
        const double sigma_dn = std::sqrt(expected / (2 * kPairs * kPixels)) +
                                electrons / gain * 0.02 / std::sqrt(double(kPixels));
        EXPECT_NEAR(seen.mean_dn, electrons / gain, kSigmas * sigma_dn) << exposure_us;
    }
}

TEST(BenchNoise, GainMultipliesSignalAndNoise) {
    Bench bench = test::even_bench();
    bench.camera.dark_e_per_s = 0.0;
    const Prepared prepared = prepare(bench);
    Shot shot = flat_shot(20000);
    const Level low = level(*prepared, shot, kPairs);
    shot.gain_db = 12.0;
    const Level high = level(*prepared, shot, kPairs);
    const double factor = std::pow(10.0, 0.6);
    EXPECT_NEAR(high.mean_dn / low.mean_dn, factor, 2e-3 * factor);
    EXPECT_NEAR((high.variance_dn2 - 1.0 / 12.0) / (low.variance_dn2 - 1.0 / 12.0), factor * factor,
                kSigmas * 1.5 * kVarianceSigma * factor * factor);
}

TEST(BenchNoise, SaturatesAtFullWellAndAtTheLastNumber) {
    Bench bench = test::even_bench();
    bench.camera.read_noise_e = 0.0;
    bench.camera.full_well_e = 5000.0;
    const Prepared prepared = prepare(bench);
    const Raw full = expose(*prepared, flat_shot(1e6));
    const auto at_well = static_cast<std::uint16_t>(200 + 5000.0 / 2.5);
    EXPECT_EQ(*std::min_element(full.begin(), full.end()), at_well);
    EXPECT_EQ(*std::max_element(full.begin(), full.end()), at_well);
    bench.camera.bits = 8;
    bench.camera.black_level_dn = 10;
    const Raw clipped = expose(*prepare(bench), flat_shot(1e6));
    EXPECT_EQ(*std::min_element(clipped.begin(), clipped.end()), 255);
}

TEST(BenchNoise, DarkCurrentFollowsTimeAndTemperature) {
    Bench bench = test::even_bench();
    bench.camera.dark_e_per_s = 100.0;
    bench.camera.dark_reference_c = 25.0;
    bench.camera.dark_doubling_c = 7.0;
    bench.camera.sensor_start_c = 25.0;
    bench.camera.sensor_rise_c = 14.0;
    bench.camera.sensor_rise_s = 100.0;
    const Prepared prepared = prepare(bench);
    Shot shot;
    shot.subject = Subject::Cap;
    shot.exposure_us = 1e6;
    EXPECT_NEAR(level(*prepared, shot, kPairs).mean_dn, 40.0, 0.1);
    shot.exposure_us = 2e6;
    EXPECT_NEAR(level(*prepared, shot, kPairs).mean_dn, 80.0, 0.15);
    shot.time_s = 100.0 * std::log(2.0);  // half of the rise: 7 degrees, twice the current
    EXPECT_NEAR(sensor_c(bench, shot.time_s), 32.0, 1e-12);
    EXPECT_NEAR(level(*prepared, shot, kPairs).mean_dn, 160.0, 0.2);
}

TEST(BenchNoise, PatternStaysAndNoiseChanges) {
    Bench bench = test::even_bench();
    bench.camera.prnu_sigma_rel = 0.03;
    bench.camera.offset_sigma_dn = 0.0;
    bench.camera.full_well_e = 1e6;
    const Prepared prepared = prepare(bench);
    Shot shot = flat_shot(500000);
    const Raw a = expose(*prepared, shot);
    EXPECT_EQ(a, expose(*prepared, shot));
    shot.frame_number = 1;
    const Raw b = expose(*prepared, shot);
    EXPECT_NE(a, b);
    // What two frames share is the pattern: 3 % of the signal.
    const double mean_dn = 0.5 * (mean(a) + mean(b));
    double covariance = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k)
        covariance += (a[k] - mean(a)) * (b[k] - mean(b)) / kPixels;
    // sqrt(1 / (2 n)) of a standard deviation: 1.1 %.
    EXPECT_NEAR(std::sqrt(covariance) / (mean_dn - 200.0), 0.03, 0.03 * 0.045);
    bench.seed = 2;
    EXPECT_NE(a, expose(*prepare(bench), flat_shot(500000)));
}

TEST(BenchNoise, HotPixelsAreTheirShare) {
    Bench bench = test::even_bench();
    bench.camera.hot_share = 0.05;
    bench.camera.hot_factor = 100.0;
    bench.camera.dark_e_per_s = 50.0;
    const Prepared prepared = prepare(bench);
    Shot shot;
    shot.subject = Subject::Cap;
    shot.exposure_us = 1e6;
    const Raw dark = expose(*prepared, shot);
    const auto hot = std::count_if(dark.begin(), dark.end(), [](int dn) { return dn > 1000; });
    EXPECT_NEAR(static_cast<double>(hot) / kPixels, 0.05, 4.0 * std::sqrt(0.05 * 0.95 / kPixels));
}

TEST(BenchNoise, LampWarmsUpAndWalks) {
    Bench bench = test::even_bench();
    bench.lamp.warm_up_rel = 0.1;
    bench.lamp.warm_up_s = 50.0;
    EXPECT_NEAR(lamp_factor(bench, 0.0), 1.1, 1e-12);
    EXPECT_NEAR(lamp_factor(bench, 50.0), 1.0 + 0.1 / std::exp(1.0), 1e-12);
    bench.lamp.warm_up_rel = 0.0;
    bench.lamp.walk_sigma_rel = 0.01;
    bench.lamp.walk_s = 10.0;
    double square = 0.0, step = 0.0;
    constexpr int kTimes = 20000;
    for (int k = 0; k < kTimes; ++k) {
        const double factor = lamp_factor(bench, 3.7 * k);
        square += (factor - 1.0) * (factor - 1.0) / kTimes;
        step = std::max(step, std::abs(lamp_factor(bench, 3.7 * k + 0.01) - factor));
    }
    // 7,400 independent knots: sigma to 0.8 %.
    EXPECT_NEAR(std::sqrt(square), 0.01, 0.01 * 0.035);
    // Slow: in a thousandth of walk_s the mixing moves by 1.5e-3, between knots at most 11.8 sigma
    // apart, over a hypotenuse of at least sqrt(1/2).
    EXPECT_LT(step, 1.5e-3 * 11.8 * std::sqrt(2.0) * 0.01);
}

TEST(BenchNoise, LampsDriftIsInTheFrames) {
    Bench bench = test::small_bench();
    bench.accuracy.lens_step = 3.0;
    bench.lamp.warm_up_rel = 0.5;
    bench.lamp.warm_up_s = 100.0;
    bench.camera.dark_e_per_s = 0.0;
    bench.camera.bits = 16;
    bench.camera.full_well_e = 1e6;
    const Prepared prepared = prepare(bench);
    Shot shot;
    shot.subject = Subject::Open;
    shot.exposure_us = 2000;
    const double early = mean(expose(*prepared, shot)) - bench.camera.black_level_dn;
    shot.time_s = 1e5;
    const double late = mean(expose(*prepared, shot)) - bench.camera.black_level_dn;
    EXPECT_NEAR(early / late, 1.5, 0.005);
    shot.lamp_on = false;
    EXPECT_NEAR(mean(expose(*prepared, shot)), bench.camera.black_level_dn, 0.3);
}

TEST(BenchNoise, MosaicIsRedGreenGreenBlue) {
    Bench bench = test::even_bench();
    bench.camera.mosaic = Mosaic::Rggb;
    bench.camera.response_e_per_cd_m2_s = {100, 0, 0, 0, 200, 0, 0, 0, 50};
    bench.camera.full_well_e = 1e6;
    const Prepared prepared = prepare(bench);
    const Raw raw = expose(*prepared, flat_shot(1e6));
    std::array<double, 4> sums{};
    for (std::size_t k = 0; k < raw.size(); ++k)
        sums[2 * (k / 64 % 2) + k % 2] += (raw[k] - 200.0) / (0.25 * kPixels);
    const std::array<double, 4> expected = {4000, 8000, 8000, 2000};
    for (std::size_t k = 0; k < 4; ++k)
        EXPECT_NEAR(sums[k], expected[k], 0.005 * expected[k]) << k;
}

TEST(BenchNoise, SamePixelsOnOneThread) {
    Bench bench = test::small_bench();
    bench.accuracy.lens_step = 3.0;
    Shot shot;
    shot.position = {1, 1};
    const Raw many = expose(*prepare(bench), shot);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(many, expose(*prepare(bench), shot));
}

// Mean, variance and third moment of the two ways to draw Poisson numbers, at small means and on
// both sides of the border between them.
TEST(BenchNoise, PoissonNumbersHaveTheirMoments) {
    constexpr int kDraws = 400000;
    for (const float mu : {0.05F, 0.7F, 3.0F, 23.9F, 24.0F, 60.0F, 1000.0F}) {
        const glm::uvec4 key = draw_key(7, Draw::Noise, static_cast<std::uint64_t>(mu * 100));
        double sum = 0.0, square = 0.0, cube = 0.0;
        for (std::uint32_t k = 0; k < kDraws; ++k) {
            const glm::uvec4 words = draw_words(key, k);
            const float value = mu < kPoissonExactBelow
                                    ? poisson_exact(mu, words.z)
                                    : poisson_normal(mu, normal_pair(words.x, words.y).x);
            const double d = double(value) - double(mu);
            sum += d / kDraws;
            square += d * d / kDraws;
            cube += d * d * d / kDraws;
        }
        const double m = mu;
        EXPECT_NEAR(sum, 0.0, 4.0 * std::sqrt(m / kDraws)) << mu;
        // Fourth central moment m + 3 m^2; the normal's rounding adds up to 0.14 electrons^2.
        const double bias = mu < kPoissonExactBelow ? 0.0 : 0.14;
        EXPECT_NEAR(square, m, 4.0 * std::sqrt((m + 2.0 * m * m) / kDraws) + bias) << mu;
        // Variance of the cubes is about 15 m^3 where m is large, m where it is small.
        EXPECT_NEAR(cube, m, 4.0 * std::sqrt((m + 30.0 * m * m + 15.0 * m * m * m) / kDraws) + bias)
            << mu;
    }
}

TEST(BenchNoise, RefusesShotsThatCannotBe) {
    Bench bench = test::even_bench();
    const Prepared prepared = prepare(bench);
    Shot shot;
    shot.position = {1, 0};
    EXPECT_THROW(expose(*prepared, shot), Error);
    shot = Shot{};
    shot.subject = Subject::Open;
    EXPECT_THROW(expose(*prepared, shot), Error);
    shot.subject = Subject::Target;
    EXPECT_THROW(expose(*prepared, shot), Error);
    shot = flat_shot(-1.0);
    EXPECT_THROW(expose(*prepared, shot), Error);
    shot = flat_shot(std::nan(""));
    EXPECT_THROW(expose(*prepared, shot), Error);
}

}  // namespace
}  // namespace nearfield::sample_data
