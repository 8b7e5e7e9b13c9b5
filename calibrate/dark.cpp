// SPDX-License-Identifier: Apache-2.0
#include "calibrate/dark.h"

#include "calibrate/robust.h"
#include "formats/files/error.h"

#include <algorithm>
#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr double kDarkSecondsPerMicrosecond = 1e-6;
// Noise of darks of which each exposure has a single frame is not known; all weigh the same then.
constexpr double kUnknownVariance_dn2 = 1.0;
constexpr double kQuantizationVariance_dn2 = 1.0 / 12.0;

// Running sums of a straight line through (t, y), every pixel's with the same weights.
struct LineSums {
    double s0 = 0, s1 = 0, s2 = 0;
    std::vector<double> y, ty;

    void add(const FrameStack& stack, double t_s, double weight) {
        y.resize(stack.mean_dn.size());
        ty.resize(stack.mean_dn.size());
        s0 += weight;
        s1 += weight * t_s;
        s2 += weight * t_s * t_s;
        for (std::size_t k = 0; k < y.size(); ++k) {
            y[k] += weight * stack.mean_dn[k];
            ty[k] += weight * t_s * stack.mean_dn[k];
        }
    }
};

// Chi-square of every pixel's noise against the pooled one.
struct NoiseSums {
    int freedom = 0;
    std::vector<float> chi2;

    void add(const FrameStack& stack, double variance_dn2) {
        if (stack.count < 2 || variance_dn2 <= 0.0)
            return;
        freedom += stack.count - 1;
        chi2.resize(stack.squares_dn2.size());
        for (std::size_t k = 0; k < chi2.size(); ++k)
            chi2[k] += stack.squares_dn2[k] / static_cast<float>(variance_dn2);
    }

    // Chi-square as a standard normal number.
    double sigmas(std::size_t k) const {
        const double nu = freedom;
        return (std::cbrt(static_cast<double>(chi2[k]) / nu) - (1.0 - 2.0 / (9.0 * nu))) /
               std::sqrt(2.0 / (9.0 * nu));
    }
};

void solve(const LineSums& sums, DarkResult& dark) {
    const double determinant = sums.s0 * sums.s2 - sums.s1 * sums.s1;
    const std::size_t count = sums.y.size();
    dark.black_dn.resize(count);
    dark.dark_dn_per_s.assign(count, 0.0F);
    if (determinant <= 1e-12 * sums.s0 * sums.s2) {  // one exposure
        for (std::size_t k = 0; k < count; ++k)
            dark.black_dn[k] = static_cast<float>(sums.y[k] / sums.s0);
        dark.black_sigma_dn = 1.0 / std::sqrt(sums.s0);
        return;
    }
    for (std::size_t k = 0; k < count; ++k) {
        dark.black_dn[k] =
            static_cast<float>((sums.s2 * sums.y[k] - sums.s1 * sums.ty[k]) / determinant);
        dark.dark_dn_per_s[k] =
            static_cast<float>((sums.s0 * sums.ty[k] - sums.s1 * sums.y[k]) / determinant);
    }
    dark.black_sigma_dn = std::sqrt(sums.s2 / determinant);
    dark.rate_sigma_dn_per_s = std::sqrt(sums.s0 / determinant);
    dark.covariance = -sums.s1 / determinant;
}

void find_hot(const NoiseSums& noise, double limit_sigmas, DarkResult& dark) {
    const std::size_t count = dark.black_dn.size();
    dark.is_hot.assign(count, 0.0F);
    dark.median_rate_dn_per_s = median_of(dark.dark_dn_per_s);
    const double sigma =
        std::max<double>(robust_sigma_of(dark.dark_dn_per_s), dark.rate_sigma_dn_per_s);
    dark.rate_limit_dn_per_s = dark.median_rate_dn_per_s + limit_sigmas * sigma;
    for (std::size_t k = 0; k < count; ++k) {
        const bool is_bright = sigma > 0.0 && dark.dark_dn_per_s[k] > dark.rate_limit_dn_per_s;
        const bool is_noisy = noise.freedom > 0 && noise.sigmas(k) > limit_sigmas;
        dark.is_hot[k] = is_bright || is_noisy ? 1.0F : 0.0F;
        dark.hot_pixels += is_bright || is_noisy ? 1 : 0;
    }
}

void note_temperature(std::span<const ExposureGroup> groups, DarkResult& dark) {
    double least = 0, most = 0, sum = 0;
    int count = 0;
    for (const ExposureGroup& group : groups) {
        for (const capture::FrameRecord* frame : group.frames) {
            if (!frame->temperature_c)
                continue;
            const double now = *frame->temperature_c;
            least = count == 0 ? now : std::min(least, now);
            most = count == 0 ? now : std::max(most, now);
            sum += now;
            ++count;
        }
    }
    dark.has_temperature = count > 0;
    if (count > 0) {
        dark.temperature_c = sum / count;
        dark.temperature_spread_c = most - least;
    }
}

DarkPoint point_of(const ExposureGroup& group, const FrameStack& stack, double variance_dn2) {
    double sum = 0;
    for (const float mean : stack.mean_dn)
        sum += mean;
    return {group.exposure_us, stack.count, sum / static_cast<double>(stack.mean_dn.size()),
            std::sqrt(variance_dn2)};
}

}  // namespace

double DarkResult::sigma_dn(double exposure_s) const {
    const double variance = black_sigma_dn * black_sigma_dn + 2.0 * covariance * exposure_s +
                            std::pow(rate_sigma_dn_per_s * exposure_s, 2.0);
    return std::sqrt(std::max(0.0, variance));
}

DarkResult dark_of(std::span<const ExposureGroup> groups,
                   const PixelLayout& layout,
                   const FrameReader& read,
                   double limit_sigmas) {
    if (groups.empty())
        throw Error{"cannot find the black level", "capture", "frames of kind dark", "none"};
    DarkResult dark;
    LineSums line;
    NoiseSums noise;
    std::size_t zeros = 0, values = 0;
    double last_variance_dn2 = kUnknownVariance_dn2;
    for (const ExposureGroup& group : groups) {
        const FrameStack stack = stack_of(group, layout, read);
        const double seen_dn2 = mean_variance_dn2(stack);
        if (stack.count > 1)  // rounding: not less, however quiet the camera
            last_variance_dn2 = std::max(seen_dn2, kQuantizationVariance_dn2);
        line.add(stack, group.exposure_us * kDarkSecondsPerMicrosecond,
                 stack.count / last_variance_dn2);
        noise.add(stack, last_variance_dn2);
        dark.points.push_back(point_of(group, stack, seen_dn2));
        for (const float mean : stack.mean_dn)
            zeros += mean < 0.5F ? 1U : 0U;
        values += stack.mean_dn.size();
    }
    dark.share_clipped = static_cast<double>(zeros) / static_cast<double>(values);
    solve(line, dark);
    find_hot(noise, limit_sigmas, dark);
    note_temperature(groups, dark);
    return dark;
}

}  // namespace nearfield::calibrate
