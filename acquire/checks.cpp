// SPDX-License-Identifier: Apache-2.0
#include "acquire/checks.h"

#include <algorithm>
#include <cmath>
#include <vector>

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

// The brightest pixel's signal in a microsecond, from the shortest exposure, which saturates last.
double brightest_per_us(std::span<const Signal> bracket) {
    const auto shortest = std::min_element(
        bracket.begin(), bracket.end(),
        [](const Signal& a, const Signal& b) { return a.exposure_us < b.exposure_us; });
    const auto& values = shortest->frame->values;
    return (*std::max_element(values.begin(), values.end()) - shortest->black_dn) /
           shortest->exposure_us;
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

double share_exposed_twice(std::span<const Signal> bracket, double darkest_share) {
    if (bracket.empty())
        return 1;
    const double least_per_us = darkest_share * brightest_per_us(bracket);
    const Signal& longest = *std::max_element(
        bracket.begin(), bracket.end(),
        [](const Signal& a, const Signal& b) { return a.exposure_us < b.exposure_us; });
    std::size_t lit = 0, twice = 0;
    for (std::size_t k = 0; k < longest.frame->values.size(); ++k) {
        if (signal_of(longest, k) < least_per_us * longest.exposure_us)
            continue;
        ++lit;
        const auto well = std::count_if(bracket.begin(), bracket.end(), [k](const Signal& signal) {
            return is_well_exposed(signal, k);
        });
        twice += well >= 2 ? 1U : 0U;
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
