// SPDX-License-Identifier: Apache-2.0
#include "calibrate/flat_field.h"

#include "calibrate/robust.h"
#include "formats/files/error.h"
#include "formats/rig/veil.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr double kFlatSecondsPerMicrosecond = 1e-6;
constexpr double kMostSaturated = 1e-3;   // share of the pixels, besides bad ones
constexpr double kLeastSignalSigmas = 5;  // a flat's mean above dark, in sigmas of one pixel
constexpr double kStraightRel = 0.005, kStraightSigmas = 5.0;

// What sums to the mean flat.
struct FlatSums {
    std::vector<double> net_dn, variance_dn2;
    double time_s = 0;
    double frame_time_s = 0;  // exposure times frames: weighs counts
    int frames = 0;
};

// Mean of light above dark over good pixels, and its sigma.
LinearityPoint level_of(const FrameStack& stack,
                        const ExposureGroup& group,
                        const DarkResult& dark,
                        const rig::Radiometry& radiometry) {
    const double t_s = group.exposure_us * kFlatSecondsPerMicrosecond;
    double sum = 0;
    std::size_t saturated = 0, used = 0;
    for (std::size_t k = 0; k < stack.mean_dn.size(); ++k) {
        if (dark.is_hot[k] != 0.0F)
            continue;
        sum += stack.mean_dn[k] - dark.black_dn[k] - dark.dark_dn_per_s[k] * t_s;
        saturated += stack.mean_dn[k] >= radiometry.saturation_dn ? 1U : 0U;
        ++used;
    }
    const auto n = static_cast<double>(used);
    LinearityPoint point;
    point.exposure_us = group.exposure_us;
    point.signal_dn = sum / n;
    point.rate_dn_per_s = point.signal_dn / t_s;
    const double one_dn2 = radiometry.read_noise_dn * radiometry.read_noise_dn +
                           std::max(0.0, point.signal_dn) / radiometry.gain_e_per_dn;
    const double dark_dn = dark.sigma_dn(t_s);
    point.sigma_rel = std::sqrt((one_dn2 / stack.count + dark_dn * dark_dn) / n) /
                      std::max(point.signal_dn, 1e-9);
    point.is_used = static_cast<double>(saturated) <= kMostSaturated * n &&
                    point.signal_dn > kLeastSignalSigmas * std::sqrt(one_dn2);
    return point;
}

// Sums counts: exposures weigh by their time, as counts do.
void add_flat(const FrameStack& stack,
              double t_s,
              const DarkResult& dark,
              const rig::Radiometry& radiometry,
              FlatSums& sums) {
    sums.net_dn.resize(stack.mean_dn.size());
    sums.variance_dn2.resize(stack.mean_dn.size());
    const double n = stack.count;
    const double read_dn2 = radiometry.read_noise_dn * radiometry.read_noise_dn;
    const double dark_dn = dark.sigma_dn(t_s);
    for (std::size_t k = 0; k < stack.mean_dn.size(); ++k) {
        const double signal_dn = stack.mean_dn[k] - dark.black_dn[k];
        sums.net_dn[k] += n * (signal_dn - dark.dark_dn_per_s[k] * t_s);
        sums.variance_dn2[k] +=
            n * (read_dn2 + std::max(0.0, signal_dn) / radiometry.gain_e_per_dn) +
            n * n * dark_dn * dark_dn;
    }
    sums.frame_time_s += n * t_s;
    sums.frames += stack.count;
}

// Median of the eight nearest values of the same color.
float neighbors_median(
    const std::vector<float>& values, const PixelLayout& layout, int x, int y, int channel) {
    const int step = layout.mosaic == "mono" || layout.mosaic == "rgb" ? 1 : 2;
    std::vector<float> near;
    near.reserve(8);
    for (int dy = -step; dy <= step; dy += step) {
        for (int dx = -step; dx <= step; dx += step) {
            const glm::ivec2 at(x + dx, y + dy);
            if ((dx != 0 || dy != 0) && at.x >= 0 && at.y >= 0 && at.x < layout.size_px.x &&
                at.y < layout.size_px.y)
                near.push_back(values[layout.value_at(at.x, at.y, channel)]);
        }
    }
    return median_of(near);
}

// Hot pixels are out already, and their darks say little of them.
void find_dead(const PixelLayout& layout,
               const DarkResult& dark,
               double dead_rel,
               FlatResult& flat) {
    flat.is_dead.assign(flat.response.size(), 0.0F);
    for (int y = 0; y < layout.size_px.y; ++y) {
        for (int x = 0; x < layout.size_px.x; ++x) {
            for (int channel = 0; channel < layout.channels; ++channel) {
                const std::size_t k = layout.value_at(x, y, channel);
                const float around = neighbors_median(flat.response, layout, x, y, channel);
                const double off = std::abs(static_cast<double>(flat.response[k] - around));
                if (off <= dead_rel * around || dark.is_hot[k] != 0.0F)
                    continue;
                flat.is_dead[k] = 1.0F;
                ++flat.dead_pixels;
            }
        }
    }
}

// Rates without veil, their means by color, response about them.
void normalize(const FlatSums& sums,
               const PixelLayout& layout,
               const DarkResult& dark,
               const rig::Radiometry& radiometry,
               FlatResult& flat) {
    std::vector<float> rates(sums.net_dn.size());
    for (std::size_t k = 0; k < rates.size(); ++k)
        rates[k] = static_cast<float>(sums.net_dn[k] / sums.frame_time_s);
    rates = rig::remove_veil(rates, layout.size_px, layout.mosaic, radiometry.veil_share,
                             radiometry.veil_sigma_px);
    std::vector<double> sum(static_cast<std::size_t>(layout.colors())), count(sum.size());
    for (std::size_t k = 0; k < rates.size(); ++k) {
        if (dark.is_hot[k] != 0.0F)
            continue;
        const auto color = static_cast<std::size_t>(layout.color(k));
        sum[color] += rates[k];
        count[color] += 1.0;
    }
    for (std::size_t color = 0; color < sum.size(); ++color)
        flat.rate_dn_per_s.push_back(sum[color] / count[color]);
    flat.response.resize(rates.size());
    flat.response_sigma_rel.resize(rates.size());
    for (std::size_t k = 0; k < rates.size(); ++k) {
        const double mean = flat.rate_dn_per_s[static_cast<std::size_t>(layout.color(k))];
        flat.response[k] = static_cast<float>(rates[k] / mean);
        flat.response_sigma_rel[k] =
            static_cast<float>(std::sqrt(sums.variance_dn2[k]) / std::max(sums.net_dn[k], 1e-9));
    }
}

}  // namespace

void find_linearity(double black_dn, double range_dn, FlatResult& flat) {
    double sum = 0, weights = 0;
    int used = 0;
    for (const LinearityPoint& point : flat.linearity) {
        if (!point.is_used)
            continue;
        const double weight = 1.0 / std::pow(point.rate_dn_per_s * point.sigma_rel, 2.0);
        sum += weight * point.rate_dn_per_s;
        weights += weight;
        ++used;
    }
    if (used < 2)
        return;
    const double mean_rate = sum / weights;
    rig::Curve curve{{0.0, black_dn}, {0.0, black_dn}};
    for (LinearityPoint& point : flat.linearity) {
        if (!point.is_used)
            continue;
        point.deviation_rel = point.rate_dn_per_s / mean_rate - 1.0;
        if (std::abs(point.deviation_rel) > flat.linearity_rel) {
            flat.linearity_rel = std::abs(point.deviation_rel);
            flat.linearity_sigma = flat.linearity_rel / point.sigma_rel;
        }
        curve.x.push_back(black_dn + point.signal_dn);
        curve.y.push_back(black_dn + point.signal_dn / (1.0 + point.deviation_rel));
    }
    constexpr int kLeastPoints = 3;
    if (used < kLeastPoints || flat.linearity_rel < kStraightRel ||
        flat.linearity_sigma < kStraightSigmas)
        return;
    const double last = (curve.y.back() - black_dn) / (curve.x.back() - black_dn);
    curve.x.push_back(std::max(range_dn, curve.x.back() + 1.0));
    curve.y.push_back(black_dn + (curve.x.back() - black_dn) * last);
    flat.linear = curve;
}

FlatResult flat_field_of(std::span<const ExposureGroup> groups,
                         const PixelLayout& layout,
                         const DarkResult& dark,
                         const rig::Radiometry& radiometry,
                         const FrameReader& read,
                         double dead_rel) {
    FlatResult flat;
    FlatSums sums;
    double most_dn = 0;
    for (const ExposureGroup& group : groups) {
        const FrameStack stack = stack_of(group, layout, read);
        const LinearityPoint point = level_of(stack, group, dark, radiometry);
        flat.linearity.push_back(point);
        most_dn = std::max(most_dn, point.signal_dn);
        if (point.is_used)
            add_flat(stack, group.exposure_us * kFlatSecondsPerMicrosecond, dark, radiometry, sums);
    }
    if (sums.frames == 0)
        throw Error{"cannot find the response of pixels", "flats",
                    "an exposure that is neither saturated nor dark",
                    groups.empty() ? "no flats"
                                   : fmt::format("at most {:.0f} DN above black, saturated from "
                                                 "{:.0f} DN on",
                                                 most_dn, radiometry.saturation_dn)};
    flat.frames = sums.frames;
    normalize(sums, layout, dark, radiometry, flat);
    find_dead(layout, dark, dead_rel, flat);
    find_linearity(median_of(dark.black_dn), layout.range_dn(), flat);
    return flat;
}

}  // namespace nearfield::calibrate
