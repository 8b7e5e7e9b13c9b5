// SPDX-License-Identifier: Apache-2.0
#include "app/bench/fit_measurement.h"

#include "fit/merge.h"
#include "fit/noise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::bench {
namespace {

constexpr double kBlack_dn = 64, kSaturation_dn = 4000, kMost_dn = 4095;
constexpr double kGain_e_per_dn = 2.4, kReadNoise_dn = 2.6;
constexpr double kBrightest_dn = 0.75 * (kSaturation_dn - kBlack_dn);
constexpr double kShortest_s = 0.01, kLonger = 4;

// Electrons by Poisson's law: a normal number from 500 on (skewness 4 %), below by the inverse of
// the distribution, from its largest term down to what rounds away.
double electrons(double mean, double normal) {
    constexpr double kNormalFrom = 500;
    if (mean >= kNormalFrom)
        return mean + std::sqrt(mean) * normal;
    const double wanted = 0.5 * std::erfc(-normal / std::sqrt(2.0));
    double chance = std::exp(-mean), sum = chance, count = 0;
    while (sum < wanted && count < 10 * kNormalFrom) {
        ++count;
        chance *= mean / count;
        sum += chance;
    }
    return count;
}

// One frame, or the mean of several: as many electrons together, and as much read noise.
double dn_of(double light_dn, int frames, fit::NoiseKey key, std::uint32_t index) {
    const double gain = kGain_e_per_dn * frames;
    const double light = electrons(light_dn * gain, fit::normal_number(key, 2 * index)) / gain;
    const double read = kReadNoise_dn / std::sqrt(frames) * fit::normal_number(key, 2 * index + 1);
    // Several frames' mean has steps of 1 / frames.
    return std::clamp(std::round((kBlack_dn + light + read) * frames) / frames, 0.0, kMost_dn);
}

}  // namespace

fit::TileInput photographed(const std::vector<double>& light,
                            const std::vector<bool>& missing,
                            const Bracket& bracket,
                            std::uint32_t seed) {
    const std::size_t texels = light.size() / missing.size();
    const double brightest = *std::max_element(light.begin(), light.end());
    const double dn_per_s = kBrightest_dn / (kShortest_s * brightest);
    const fit::SensorNoise noise{kGain_e_per_dn * bracket.frames,
                                 kReadNoise_dn / std::sqrt(bracket.frames),
                                 kSaturation_dn,
                                 {}};
    const fit::PixelTraits pixel{kBlack_dn, 0.0, 1.0, 0.0};
    fit::TileInput tile;
    tile.value.assign(light.size(), 0.0F);
    tile.variance.assign(light.size(), std::numeric_limits<float>::infinity());
    tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t k) {
        if (missing[k])
            return;
        std::vector<fit::PixelExposure> exposures(static_cast<std::size_t>(bracket.exposures));
        for (std::size_t t = k * texels; t < (k + 1) * texels; ++t) {
            const fit::NoiseKey key = fit::noise_key(seed, 0, 0, t);
            double exposure_s = kShortest_s;
            for (std::size_t e = 0; e < exposures.size(); ++e, exposure_s *= kLonger)
                exposures[e] = {dn_of(light[t] * dn_per_s * exposure_s, bracket.frames, key,
                                      static_cast<std::uint32_t>(e)),
                                exposure_s};
            const fit::MergedPixel merged = merge_pixel(exposures, pixel, noise);
            if (merged.is_saturated)
                continue;
            tile.value[t] = static_cast<float>(merged.light_dn_per_s / dn_per_s);
            tile.variance[t] = static_cast<float>(merged.variance / (dn_per_s * dn_per_s));
        }
    });
    return tile;
}

}  // namespace nearfield::bench
