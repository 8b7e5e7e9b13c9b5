// SPDX-License-Identifier: Apache-2.0
#include "calibrate/dark.h"

#include "calibrate/robust.h"
#include "formats/files/error.h"
#include "formats/rig/rig.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nearfield::calibrate {
namespace {

constexpr double kDarkSecondsPerMicrosecond = 1e-6;
// Noise of darks of which each exposure has a single frame is not known; all weigh the same then.
constexpr double kUnknownVariance_dn2 = 1.0;
constexpr double kQuantizationVariance_dn2 = 1.0 / 12.0;
// Of darks' temperatures, from which on they tell light of the room from dark current.
constexpr double kLeastSpread_c = 2.0;

// Running sums of a line through (t, f t, y), every pixel's with the same weights: black, dark
// current and light of the room.
struct LineSums {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    std::vector<double> y, fty, ty;

    void add(const FrameStack& stack, double t_s, double growth, double weight) {
        const std::size_t count = stack.mean_dn.size();
        y.resize(count);
        fty.resize(count);
        ty.resize(count);
        const Eigen::Vector3d row(1.0, growth * t_s, t_s);
        normal += weight * row * row.transpose();
        for (std::size_t k = 0; k < count; ++k) {
            const double value = weight * stack.mean_dn[k];
            y[k] += value;
            fty[k] += growth * t_s * value;
            ty[k] += t_s * value;
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

void solve_black(const LineSums& sums, DarkResult& dark) {
    for (std::size_t k = 0; k < dark.black_dn.size(); ++k)
        dark.black_dn[k] = static_cast<float>(sums.y[k] / sums.normal(0, 0));
    dark.black_sigma_dn = 1.0 / std::sqrt(sums.normal(0, 0));
}

// Darks of one temperature: one rate.
void solve_line(const LineSums& sums, DarkResult& dark) {
    const Eigen::Matrix2d covariance = sums.normal.topLeftCorner<2, 2>().inverse();
    for (std::size_t k = 0; k < dark.black_dn.size(); ++k) {
        const Eigen::Vector2d found = covariance * Eigen::Vector2d(sums.y[k], sums.fty[k]);
        dark.black_dn[k] = static_cast<float>(found[0]);
        dark.dark_dn_per_s[k] = static_cast<float>(found[1]);
    }
    dark.black_sigma_dn = std::sqrt(covariance(0, 0));
    dark.rate_sigma_dn_per_s = std::sqrt(covariance(1, 1));
    dark.covariance = covariance(0, 1);
}

void solve_with_room(const LineSums& sums, DarkResult& dark) {
    const Eigen::Matrix3d covariance = sums.normal.inverse();
    for (std::size_t k = 0; k < dark.black_dn.size(); ++k) {
        const Eigen::Vector3d found =
            covariance * Eigen::Vector3d(sums.y[k], sums.fty[k], sums.ty[k]);
        dark.black_dn[k] = static_cast<float>(found[0]);
        dark.dark_dn_per_s[k] = static_cast<float>(found[1] + found[2]);
        dark.room_dn_per_s[k] = static_cast<float>(found[2]);
    }
    dark.black_sigma_dn = std::sqrt(covariance(0, 0));
    dark.rate_sigma_dn_per_s =
        std::sqrt(covariance(1, 1) + covariance(2, 2) + 2.0 * covariance(1, 2));
    dark.covariance = covariance(0, 1) + covariance(0, 2);
}

void solve(const LineSums& sums, int exposures, DarkResult& dark) {
    const std::size_t count = sums.y.size();
    dark.black_dn.resize(count);
    dark.dark_dn_per_s.assign(count, 0.0F);
    dark.room_dn_per_s.assign(count, 0.0F);
    if (exposures == 1)
        solve_black(sums, dark);
    else if (dark.is_room_known)
        solve_with_room(sums, dark);
    else
        solve_line(sums, dark);
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

// Frames of an exposure, taken while the sensor was cool or warm.
struct TemperatureGroup {
    ExposureGroup group;
    double growth = 1;  // of dark current, against the coolest group
};

double mean_temperature_c(const ExposureGroup& group) {
    double sum_c = 0;
    for (const capture::FrameRecord* frame : group.frames)
        sum_c += *frame->temperature_c;
    return sum_c / static_cast<double>(group.frames.size());
}

bool all_have_temperature(std::span<const ExposureGroup> groups) {
    return std::all_of(groups.begin(), groups.end(), [](const ExposureGroup& group) {
        return std::all_of(
            group.frames.begin(), group.frames.end(),
            [](const capture::FrameRecord* frame) { return frame->temperature_c.has_value(); });
    });
}

// Where cool frames end and warm ones begin; none: they tell one temperature.
std::optional<double> note_temperature(std::span<const ExposureGroup> groups, DarkResult& dark) {
    dark.has_temperature = all_have_temperature(groups);
    if (!dark.has_temperature)
        return {};
    std::vector<double> all_c;
    for (const ExposureGroup& group : groups)
        for (const capture::FrameRecord* frame : group.frames)
            all_c.push_back(*frame->temperature_c);
    const auto [least, most] = std::minmax_element(all_c.begin(), all_c.end());
    dark.temperature_spread_c = *most - *least;
    const bool is_one = dark.temperature_spread_c < kLeastSpread_c;
    const double middle_c = 0.5 * (*least + *most);
    if (!is_one)
        std::erase_if(all_c, [middle_c](double c) { return c > middle_c; });
    dark.temperature_c =
        std::accumulate(all_c.begin(), all_c.end(), 0.0) / static_cast<double>(all_c.size());
    return is_one ? std::nullopt : std::optional(middle_c);
}

// Each exposure's frames, cool ones apart from warm ones.
std::vector<TemperatureGroup> by_temperature(std::span<const ExposureGroup> groups,
                                             std::optional<double> middle_c,
                                             DarkResult& dark) {
    std::vector<TemperatureGroup> parts;
    int warm_count = 0;
    for (const ExposureGroup& group : groups) {
        if (!middle_c) {
            parts.push_back({group, 1.0});
            continue;
        }
        ExposureGroup cool{group.exposure_us, {}}, warm = cool;
        for (const capture::FrameRecord* frame : group.frames)
            (*frame->temperature_c > *middle_c ? warm : cool).frames.push_back(frame);
        warm_count += warm.frames.empty() ? 0 : 1;
        for (const ExposureGroup& part : {cool, warm})
            if (!part.frames.empty())
                parts.push_back(
                    {part, rig::dark_growth(mean_temperature_c(part) - dark.temperature_c)});
    }
    dark.is_room_known = warm_count > 1;
    return parts;
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
    const std::optional<double> middle_c = note_temperature(groups, dark);
    LineSums line;
    NoiseSums noise;
    std::size_t zeros = 0, values = 0;
    double last_variance_dn2 = kUnknownVariance_dn2;
    for (const TemperatureGroup& part : by_temperature(groups, middle_c, dark)) {
        const FrameStack stack = stack_of(part.group, layout, read);
        const double seen_dn2 = mean_variance_dn2(stack);
        if (stack.count > 1)  // rounding: not less, however quiet the camera
            last_variance_dn2 = std::max(seen_dn2, kQuantizationVariance_dn2);
        line.add(stack, part.group.exposure_us * kDarkSecondsPerMicrosecond, part.growth,
                 stack.count / last_variance_dn2);
        noise.add(stack, last_variance_dn2);
        dark.points.push_back(point_of(part.group, stack, seen_dn2));
        for (const float mean : stack.mean_dn)
            zeros += mean < 0.5F ? 1U : 0U;
        values += stack.mean_dn.size();
    }
    dark.share_clipped = static_cast<double>(zeros) / static_cast<double>(values);
    solve(line, static_cast<int>(groups.size()), dark);
    find_hot(noise, limit_sigmas, dark);
    return dark;
}

}  // namespace nearfield::calibrate
