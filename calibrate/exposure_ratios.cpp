// SPDX-License-Identifier: Apache-2.0
#include "calibrate/exposure_ratios.h"

#include "formats/rig/curve.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace nearfield::calibrate {
namespace {

constexpr double kRatioSecondsPerMicrosecond = 1e-6;
// Least light of the shorter exposure in sigmas of its noise, and how far the longer one stays
// below saturation: no value of it is then cut off.
constexpr double kLeastSigmas = 5.0, kClearOfSaturation = 5.0;
constexpr std::size_t kLeastPixels = 20;  // of one position

// A position's regression y2 = R y1.
struct OneRatio {
    double ratio = 0, variance = 0;
};

struct PairSums {
    std::vector<OneRatio> positions;
    std::vector<float> weight;  // sum of w x of every pixel, for the darks' common error
    double weight_light = 0;    // sum of w x y1
    std::size_t pixels = 0;
};

struct LoadedFrame {
    double exposure_us = 0;
    std::vector<float> net_dn;
};

using PairKey = std::pair<double, double>;  // exposures in microseconds, shorter first

LoadedFrame load(const capture::FrameRecord& record,
                 const DarkResult& dark,
                 const rig::Radiometry& radiometry,
                 const FrameReader& read) {
    LoadedFrame loaded;
    loaded.exposure_us = record.shot.exposure_us;
    const auto t_s = static_cast<float>(loaded.exposure_us * kRatioSecondsPerMicrosecond);
    const capture::Frame frame = read(record);
    loaded.net_dn.resize(frame.values.size());
    for (std::size_t k = 0; k < frame.values.size(); ++k)
        loaded.net_dn[k] = static_cast<float>(rig::linear_dn(radiometry, frame.values[k])) -
                           dark.black_dn[k] - dark.dark_dn_per_s[k] * t_s;
    return loaded;
}

// Adds one position to a pair's sums.
void add_position(const LoadedFrame& shorter,
                  const LoadedFrame& longer,
                  const DarkResult& dark,
                  const rig::Radiometry& radiometry,
                  const rig::Maps& maps,
                  PairSums& sums) {
    const double asked = longer.exposure_us / shorter.exposure_us;
    const double read_dn2 = radiometry.read_noise_dn * radiometry.read_noise_dn;
    const double dn_per_e = 1.0 / radiometry.gain_e_per_dn;
    double xy1 = 0, xy2 = 0, xx = 0;
    std::size_t used = 0;
    sums.weight.resize(shorter.net_dn.size());
    for (std::size_t k = 0; k < shorter.net_dn.size(); ++k) {
        if (maps.is_bad[k] != 0.0F)
            continue;
        const double y1 = shorter.net_dn[k], y2 = longer.net_dn[k];
        const double rough = std::max(0.0, (y1 + y2) / (1.0 + asked));
        const double v1 = read_dn2 + rough * dn_per_e, v2 = read_dn2 + rough * asked * dn_per_e;
        // The shorter frame's light, from both.
        const double x = (y1 / v1 + asked * y2 / v2) / (1.0 / v1 + asked * asked / v2);
        const double most = radiometry.saturation_dn - dark.black_dn[k];
        if (x < kLeastSigmas * std::sqrt(v1) ||
            asked * x + kClearOfSaturation * std::sqrt(v2) > most)
            continue;
        const double weight = 1.0 / (v2 + asked * asked * v1);
        xy1 += weight * x * y1;
        xy2 += weight * x * y2;
        xx += weight * x * x;
        sums.weight[k] += static_cast<float>(weight * x);
        ++used;
    }
    if (used < kLeastPixels)
        return;
    sums.positions.push_back({xy2 / xy1, xx / (xy1 * xy1)});
    sums.weight_light += xy1;
    sums.pixels += used;
}

// Variance of the positions beyond that of counts.
double excess_variance(const std::vector<OneRatio>& positions, double& chi2) {
    double s1 = 0, s2 = 0, sum = 0;
    for (const OneRatio& one : positions) {
        s1 += 1.0 / one.variance;
        s2 += 1.0 / (one.variance * one.variance);
        sum += one.ratio / one.variance;
    }
    chi2 = 0;
    for (const OneRatio& one : positions)
        chi2 += std::pow(one.ratio - sum / s1, 2.0) / one.variance;
    const double freedom = static_cast<double>(positions.size()) - 1.0;
    return freedom < 1.0 ? 0.0 : std::max(0.0, (chi2 - freedom) / (s1 - s2 / s1));
}

std::optional<ExposureRatio> combine(const PairKey& key,
                                     const PairSums& sums,
                                     const DarkResult& dark) {
    if (sums.positions.empty())
        return std::nullopt;
    ExposureRatio result;
    result.shorter_us = key.first;
    result.longer_us = key.second;
    result.positions = static_cast<int>(sums.positions.size());
    result.pixels = sums.pixels;
    const double excess = excess_variance(sums.positions, result.chi2);
    double total = 0, weights = 0;
    for (const OneRatio& one : sums.positions) {
        total += one.ratio / (one.variance + excess);
        weights += 1.0 / (one.variance + excess);
    }
    result.ratio = total / weights;
    result.drift_rel = std::sqrt(excess) / result.ratio;
    // An error of a pixel's dark is the same in all positions: black b and rate d move the
    // residual y2 - R y1 by (1 - R) b + (t2 - R t1) d.
    double squares = 0;
    for (const float weight : sums.weight)
        squares += static_cast<double>(weight) * weight;
    const double by_black = 1.0 - result.ratio;
    const double by_rate = (key.second - result.ratio * key.first) * kRatioSecondsPerMicrosecond;
    const double dark_dn2 = std::pow(by_black * dark.black_sigma_dn, 2.0) +
                            2.0 * by_black * by_rate * dark.covariance +
                            std::pow(by_rate * dark.rate_sigma_dn_per_s, 2.0);
    const double variance =
        1.0 / weights + dark_dn2 * squares / (sums.weight_light * sums.weight_light);
    result.sigma_rel = std::sqrt(variance) / result.ratio;
    return result;
}

// True times along the chain of ratios, from the middle exposure both ways.
void chain(const std::vector<double>& asked_us, double unknown_sigma_rel, RatioResult& result) {
    const std::size_t reference = asked_us.size() / 2;
    result.reference_us = asked_us[reference];
    result.exposures.resize(asked_us.size());
    result.exposures[reference] = {asked_us[reference], asked_us[reference], 0.0};
    const auto step = [&](std::size_t from, std::size_t to) {
        const PairKey key(std::min(asked_us[from], asked_us[to]),
                          std::max(asked_us[from], asked_us[to]));
        double ratio = key.second / key.first, sigma_rel = unknown_sigma_rel;
        for (const ExposureRatio& one : result.ratios) {
            if (one.shorter_us != key.first || one.longer_us != key.second)
                continue;
            ratio = one.ratio;
            sigma_rel = one.sigma_rel;
        }
        const rig::TrueExposure& known = result.exposures[from];
        result.exposures[to] = {asked_us[to],
                                to > from ? known.true_us * ratio : known.true_us / ratio,
                                std::hypot(known.sigma_rel, sigma_rel)};
    };
    for (std::size_t k = reference; k + 1 < asked_us.size(); ++k)
        step(k, k + 1);
    for (std::size_t k = reference; k > 0; --k)
        step(k, k - 1);
}

}  // namespace

RatioResult exposure_ratios_of(std::span<const Bracket> brackets,
                               const PixelLayout& layout,
                               const DarkResult& dark,
                               const rig::Radiometry& radiometry,
                               const rig::Maps& maps,
                               const FrameReader& read,
                               double unknown_sigma_rel) {
    std::map<PairKey, PairSums> pairs;
    std::vector<double> asked_us;
    for (const Bracket& bracket : brackets) {
        LoadedFrame before;
        for (const capture::FrameRecord* record : bracket) {
            require_same(layout, *record);
            LoadedFrame now = load(*record, dark, radiometry, read);
            if (before.exposure_us > 0.0 && now.exposure_us > before.exposure_us)
                add_position(before, now, dark, radiometry, maps,
                             pairs[{before.exposure_us, now.exposure_us}]);
            asked_us.push_back(now.exposure_us);
            before = std::move(now);
        }
    }
    std::sort(asked_us.begin(), asked_us.end());
    asked_us.erase(std::unique(asked_us.begin(), asked_us.end()), asked_us.end());
    RatioResult result;
    for (const auto& [key, sums] : pairs) {
        if (const std::optional<ExposureRatio> ratio = combine(key, sums, dark))
            result.ratios.push_back(*ratio);
    }
    if (!asked_us.empty())
        chain(asked_us, unknown_sigma_rel, result);
    return result;
}

}  // namespace nearfield::calibrate
