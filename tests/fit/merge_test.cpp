// SPDX-License-Identifier: Apache-2.0
// The HDR merge by statistics: many pixels of the same light, electrons drawn one by one. What is
// not tested here: that a real camera's noise is of this kind.
#include "fit/merge.h"

#include "formats/files/error.h"
#include "tests/fit/bench_planes.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

const SensorNoise kNoise{2.4, 2.6, 4000.0, {}};
const PixelTraits kPixel{64.0, 2.0, 1.0, 0.0};

// Poisson: counts arrivals (Knuth), in parts of 30; above 1000 normal (skewness below 3 %).
double poisson_number(double mean, support::Random& random) {
    if (mean > 1000.0)
        return mean + std::sqrt(mean) * normal_number(random);
    double count = 0.0;
    for (double left = mean; left > 0.0; left -= 30.0) {
        const double limit = std::exp(-std::min(left, 30.0));
        for (double product = random.uniform(); product > limit; product *= random.uniform())
            count += 1.0;
    }
    return count;
}

// Raw DN, not rounded: quantization is part of the read noise.
double raw_dn(double light, double exposure_s, support::Random& random) {
    const double electrons =
        poisson_number((light + kPixel.dark_dn_per_s) * exposure_s * kNoise.gain_e_per_dn, random);
    return std::min(4095.0, kPixel.black_dn + electrons / kNoise.gain_e_per_dn +
                                kNoise.read_noise_dn * normal_number(random));
}

struct Statistics {
    double bias_sigmas = 0;      // of the mean, in sigmas of one pixel
    double spread_ratio = 0;     // true standard deviation over the reported
    double variance = 0;         // of the estimates
    double mean_chi_square = 0;  // by degree of freedom
    double standard_error = 0;   // of bias_sigmas
};

Statistics statistics(double light, const std::vector<double>& exposures_s, int count) {
    support::Random random{static_cast<std::uint64_t>(light * 1e4) + 17};
    double sum = 0, squares = 0, reported = 0, chi_square = 0, degrees = 0;
    for (int n = 0; n < count; ++n) {
        std::vector<PixelExposure> exposures;
        exposures.reserve(exposures_s.size());
        for (const double t : exposures_s)
            exposures.push_back({raw_dn(light, t, random), t});
        const MergedPixel pixel = merge_pixel(exposures, kPixel, kNoise);
        sum += pixel.light_dn_per_s - light;
        squares += (pixel.light_dn_per_s - light) * (pixel.light_dn_per_s - light);
        reported += pixel.variance;
        chi_square += pixel.chi_square;
        degrees += pixel.used_count - 1;
    }
    Statistics s;
    s.variance = squares / count - (sum / count) * (sum / count);
    s.bias_sigmas = sum / count / std::sqrt(s.variance);
    s.spread_ratio = std::sqrt(s.variance / (reported / count));
    s.mean_chi_square = degrees > 0 ? chi_square / degrees : 0.0;
    s.standard_error = 1.0 / std::sqrt(static_cast<double>(count));
    return s;
}

// Fisher information about the light of one exposure: electrons by Poisson's law, read noise by its
// density, the sum over outcomes by a fine rule.
double fisher_information(double light, double exposure_s) {
    const double mean = (light + kPixel.dark_dn_per_s) * exposure_s * kNoise.gain_e_per_dn;
    const double read_e = kNoise.read_noise_dn * kNoise.gain_e_per_dn;
    const double reach = 9.0 * std::sqrt(mean + read_e * read_e) + 9.0;
    const double step = 0.1 * read_e;
    double information = 0.0;
    for (double y = mean - reach; y < mean + reach; y += step) {
        double density = 0.0, slope = 0.0;
        const int least = std::max(0, static_cast<int>(mean - reach));
        for (int electrons = least; electrons < mean + reach; ++electrons) {
            int sign = 0;
            const double log_chance =
                electrons * std::log(mean) - mean - lgamma_r(electrons + 1.0, &sign);
            const double z = (y - electrons) / read_e;
            const double term = std::exp(log_chance - 0.5 * z * z);
            density += term;
            slope += term * (electrons / mean - 1.0);
        }
        if (density > 0.0)
            information += step * slope * slope / density;
    }
    const double per_light = exposure_s * kNoise.gain_e_per_dn;
    return information * per_light * per_light / (read_e * std::sqrt(2.0 * std::acos(-1.0)));
}

TEST(MergePixel, IsUnbiasedAndEfficientFromTheDarkUp) {
    const std::vector<double> exposures_s = {0.01, 0.04, 0.16, 0.64};
    constexpr int kCount = 40000;
    for (const double light : {0.0, 0.5, 5.0, 50.0, 500.0}) {
        const Statistics s = statistics(light, exposures_s, kCount);
        double information = 0.0;
        for (const double t : exposures_s)
            information += fisher_information(light, t);
        EXPECT_LT(std::abs(s.bias_sigmas), 0.1 * 0.5) << light;
        // The sample variance is known to sqrt(2 / count) = 0.7 %: three of them and 2 %.
        EXPECT_LT(s.variance * information, 1.02 + 3.0 * std::sqrt(2.0 / kCount)) << light;
        EXPECT_NEAR(s.spread_ratio, 1.0, 0.02) << light;
        EXPECT_NEAR(s.mean_chi_square, 1.0, 0.03) << light;
    }
}

TEST(MergePixel, IsUnbiasedWhereAnExposureIsAboutToSaturate) {
    // The longest exposure's mean runs across saturation: whether its datum came out below says
    // something about its noise.
    for (const double at_longest : {3800.0, 3900.0, 3936.0, 3950.0, 4000.0, 4100.0}) {
        const Statistics s = statistics(at_longest / 0.64, {0.04, 0.64}, 20000);
        EXPECT_LT(std::abs(s.bias_sigmas), 0.04) << at_longest;
        EXPECT_NEAR(s.spread_ratio, 1.0, 0.03) << at_longest;
    }
}

TEST(MergePixel, KeepsNegativeLight) {
    const PixelExposure dark[] = {{60.0, 0.1}, {59.0, 0.2}};
    EXPECT_LT(merge_pixel(dark, kPixel, kNoise).light_dn_per_s, 0.0);
}

TEST(MergePixel, SaysWhatIsSaturated) {
    const PixelExposure bright[] = {{4001.0, 0.1}, {4095.0, 0.2}};
    const MergedPixel pixel = merge_pixel(bright, kPixel, kNoise);
    EXPECT_TRUE(pixel.is_saturated);
    EXPECT_EQ(pixel.variance, std::numeric_limits<double>::infinity());
    const PixelExposure half[] = {{1064.2, 0.1}, {4095.0, 0.8}};
    EXPECT_NEAR(merge_pixel(half, kPixel, kNoise).light_dn_per_s, 10000.0, 1e-9);
    EXPECT_EQ(merge_pixel(half, kPixel, kNoise).used_count, 1);
}

TEST(MergePixel, DividesByResponseAndAddsWhatIsLeftOfIt) {
    const PixelExposure one[] = {{1064.2, 0.1}};
    const PixelTraits pixel{64.0, 2.0, 0.8, 0.01};
    const MergedPixel merged = merge_pixel(one, pixel, kNoise);
    EXPECT_NEAR(merged.light_dn_per_s, 12500.0, 1e-9);
    // By hand: sigma of y is sqrt(2.6^2 + 1000.2 / 2.4) DN.
    const double sigma = std::sqrt(2.6 * 2.6 + 1000.2 / 2.4) / 0.1 / 0.8;
    EXPECT_NEAR(merged.variance, sigma * sigma + 125.0 * 125.0, 1e-6 * merged.variance);
}

TEST(MergePixel, WeighsByTheCurvesSlope) {
    // linear = raw^2 / 255 at 8 bits: one code more is worth more light where the curve is steep.
    SensorNoise noise{0.0, 0.5, 250.0, {}};
    for (int dn = 0; dn < 256; ++dn) {
        noise.linear.x.push_back(dn);
        noise.linear.y.push_back(dn * dn / 255.0);
    }
    const PixelTraits pixel;
    support::Random random{9};
    double sum = 0, squares = 0, reported = 0;
    constexpr int kCount = 20000;
    const double light = 150.0;
    for (int n = 0; n < kCount; ++n) {
        std::vector<PixelExposure> exposures;
        for (const double t : {0.1, 0.4, 1.0})
            exposures.push_back({std::sqrt(light * t * 255.0) + 0.5 * normal_number(random), t});
        const MergedPixel merged = merge_pixel(exposures, pixel, noise);
        sum += merged.light_dn_per_s - light;
        squares += (merged.light_dn_per_s - light) * (merged.light_dn_per_s - light);
        reported += merged.variance;
    }
    EXPECT_LT(std::abs(sum / kCount) / std::sqrt(squares / kCount), 0.03);
    EXPECT_NEAR(std::sqrt(squares / reported), 1.0, 0.02);
    // The bound by hand: information t^2 / (slope sigma)^2, slope = 2 raw / 255.
    double information = 0.0;
    for (const double t : {0.1, 0.4, 1.0})
        information += t * t / std::pow(2.0 * std::sqrt(light * t * 255.0) / 255.0 * 0.5, 2.0);
    EXPECT_LT(squares / kCount * information, 1.04);
}

TEST(MergePixel, RefusesWhatIsNoNumber) {
    const double nan = std::nan("");
    for (const PixelExposure exposure :
         {PixelExposure{nan, 0.1}, {10.0, nan}, {10.0, 0.0}, {10.0, -1.0}})
        EXPECT_THROW((void)merge_pixel(std::span(&exposure, 1), kPixel, kNoise), Error);
}

TEST(MergeFrames, MergesEveryPixelByItsOwnMaps) {
    const glm::ivec2 size_px{5, 3};
    rig::Maps maps;
    maps.size_px = size_px;
    maps.room_dn_per_s.assign(15, 0.0F);
    std::vector<std::uint16_t> brief, lengthy;
    for (int p = 0; p < 15; ++p) {
        maps.black_dn.push_back(60.0F + static_cast<float>(p));
        maps.dark_dn_per_s.push_back(1.0F);
        maps.response.push_back(0.5F);
        maps.response_sigma_rel.push_back(0.0F);
        maps.is_bad.push_back(p == 7 ? 1.0F : 0.0F);
        brief.push_back(static_cast<std::uint16_t>(60 + p + 100));
        lengthy.push_back(p == 3 ? 4095 : static_cast<std::uint16_t>(60 + p + 1000));
    }
    rig::Radiometry radiometry;
    radiometry.gain_e_per_dn = 2.4;
    radiometry.read_noise_dn = 2.6;
    radiometry.saturation_dn = 4000.0;
    const ExposedFrame frames[] = {{brief, 0.1}, {lengthy, 1.0}};
    const MergedImage image = merge_frames(frames, radiometry, maps, 2.0);
    EXPECT_EQ(image.bad_count, 1U);
    EXPECT_EQ(image.saturated_count, 0U);
    EXPECT_EQ(image.variance[7], std::numeric_limits<float>::infinity());
    // light * response + 2 dark = 1000 DN/s by both exposures.
    EXPECT_NEAR(image.light_dn_per_s[4], 2.0 * 998.0, 0.2);
    EXPECT_NEAR(image.light_dn_per_s[3], 2.0 * 998.0, 0.2);
    EXPECT_GT(image.variance[3], 5.0F * image.variance[4]);
    lengthy.pop_back();
    const ExposedFrame torn[] = {{brief, 0.1}, {lengthy, 1.0}};
    EXPECT_THROW((void)merge_frames(torn, radiometry, maps, 1.0), Error);
    EXPECT_THROW((void)merge_frames({}, radiometry, maps, 1.0), Error);
}

}  // namespace
}  // namespace nearfield::fit
