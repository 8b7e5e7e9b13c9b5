// SPDX-License-Identifier: Apache-2.0
#include "acquire/checks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nearfield::acquire {
namespace {

constexpr int kLeastPixels = 100;
constexpr double kLeastSignal = 0.02;

double signal_of(const Signal& signal, std::size_t k) {
    return static_cast<double>(signal.frame->values[k]) - signal.black_dn;
}

bool is_well_exposed(const Signal& signal, std::size_t k) {
    const double range_dn = signal.frame->range_dn() - signal.black_dn;
    const double share = signal_of(signal, k) / range_dn;
    return share >= kWellExposedLow && share <= kWellExposedHigh;
}

constexpr double kBinsPerOctave = 4;
constexpr double kLowestOctave = -40;  // of DN / us: a DN in 12 days

int bin_of(double brightness) {
    if (!(brightness > 0))
        return 0;
    const double bin = (std::log2(brightness) - kLowestOctave) * kBinsPerOctave;
    return static_cast<int>(std::clamp(bin, 0.0, ExposureTally::kBins - 1.0));
}

}  // namespace

std::optional<double> exposure_ratio(const Signal& a, const Signal& b) {
    double sum_a = 0, sum_b = 0;
    int count = 0;
    for (std::size_t k = 0; k < b.frame->values.size(); ++k) {
        if (!is_well_exposed(b, k))
            continue;
        sum_a += signal_of(a, k);
        sum_b += signal_of(b, k);
        ++count;
    }
    if (count < kLeastPixels || sum_a < kLeastSignal * a.frame->range_dn() * count)
        return std::nullopt;
    return sum_b / sum_a;
}

void tally(std::span<const Signal> bracket, ExposureTally& counts) {
    const std::size_t pixels = bracket.empty() ? 0 : bracket.front().frame->values.size();
    for (std::size_t k = 0; k < pixels; ++k) {
        double signal_dn = 0, exposure_us = 0;
        int well = 0;
        for (const Signal& signal : bracket) {
            well += is_well_exposed(signal, k) ? 1 : 0;
            if (signal_of(signal, k) > kWellExposedHigh * signal.frame->range_dn())
                continue;
            signal_dn += signal_of(signal, k);
            exposure_us += signal.exposure_us;
        }
        // Too bright for all: at the top, where it counts as missed.
        const auto bin = static_cast<std::size_t>(exposure_us > 0 ? bin_of(signal_dn / exposure_us)
                                                                  : ExposureTally::kBins - 1);
        ++counts.pixels[bin];
        counts.twice[bin] += well >= 2 ? 1U : 0U;
    }
}

double share_exposed_twice(const ExposureTally& counts, double darkest_share) {
    constexpr double kHotShare = 1e-4;
    const std::size_t all =
        std::accumulate(counts.pixels.begin(), counts.pixels.end(), std::size_t{0});
    int brightest = ExposureTally::kBins - 1;
    for (std::size_t above = 0; brightest > 0; --brightest) {
        above += counts.pixels[static_cast<std::size_t>(brightest)];
        if (static_cast<double>(above) > kHotShare * static_cast<double>(all))
            break;
    }
    const int darkest =
        brightest + static_cast<int>(std::ceil(std::log2(darkest_share) * kBinsPerOctave));
    std::size_t lit = 0, twice = 0;
    for (int bin = std::max(darkest, 1); bin < ExposureTally::kBins; ++bin) {
        lit += counts.pixels[static_cast<std::size_t>(bin)];
        twice += counts.twice[static_cast<std::size_t>(bin)];
    }
    return lit == 0 ? 1 : static_cast<double>(twice) / static_cast<double>(lit);
}

std::optional<int> exposure_latency(double before_dn,
                                    std::span<const double> after_dn,
                                    double least_rel) {
    const double change = after_dn.back() - before_dn;
    if (std::abs(change) <= least_rel * std::abs(before_dn))
        return std::nullopt;
    for (std::size_t k = 0; k < after_dn.size(); ++k)
        if ((after_dn[k] - before_dn) / change > 0.5)
            return static_cast<int>(k);
    return std::nullopt;
}

}  // namespace nearfield::acquire
