// SPDX-License-Identifier: Apache-2.0
#include "calibrate/robust_fit.h"

#include "calibrate/initial_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::calibrate {
namespace {

constexpr double kLeastSigma_px = 1e-7;  // what noise-free corners are taken to have

struct Noise {
    double robust_px = 0;   // by the median, outliers or not
    double squares_px = 0;  // by the mean square of what is no outlier
};

double squared_length(glm::dvec2 v) {
    return glm::dot(v, v);
}

double squared_residual(const Bundle& bundle, std::size_t view, const Corner& corner) {
    const auto residual = corner_residual_px(bundle, view, corner);
    return residual ? squared_length(*residual) : std::numeric_limits<double>::infinity();
}

// Numbers that corners determine.
int estimated_count(const Fitted& fitted) {
    const Bundle& bundle = fitted.bundle;
    int count = fitted.choice.is_lens_known ? 0 : static_cast<int>(bundle.lens.size());
    if (fitted.choice.has_square_pixels && count > 0)
        --count;
    if (!fitted.choice.is_board_flat)
        count += 3;
    for (const BoardPose& board : bundle.boards)
        count += board.plane == capture::TargetPlane::Free ? 6 : 3;
    return count + (bundle.has_planes ? 6 : 0);
}

Noise noise_of(const Fitted& fitted, const Observations& observations) {
    std::vector<double> squares;
    double sum = 0.0;
    int used = 0;
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        const std::vector<Corner>& corners = observations.boards[view].corners;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            squares.push_back(squared_residual(fitted.bundle, view, corners[i]));
            if (fitted.weights.is_outlier[view][i] != 0)
                continue;
            sum += squares.back();
            ++used;
        }
    }
    const int estimated = estimated_count(fitted);
    const double all = 2.0 * static_cast<double>(squares.size());
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    // The median of a squared length of two normal numbers is 2 ln 2 sigma^2; fitting took its
    // share of the residuals away.
    const double left = std::max(1.0, all - estimated) / all;
    return {std::max(std::sqrt(*middle / (2.0 * std::log(2.0) * left)), kLeastSigma_px),
            std::max(std::sqrt(sum / std::max(1.0, 2.0 * used - estimated)), kLeastSigma_px)};
}

// Marks corners that are too far off; true where the marks changed.
bool mark_outliers(Fitted& fitted, const Observations& observations, double limit_px) {
    bool has_changed = false;
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        const std::vector<Corner>& corners = observations.boards[view].corners;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const bool is_far =
                !(squared_residual(fitted.bundle, view, corners[i]) <= limit_px * limit_px);
            char& mark = fitted.weights.is_outlier[view][i];
            has_changed = has_changed || (mark != 0) != is_far;
            mark = is_far ? 1 : 0;
        }
    }
    return has_changed;
}

// W with W^T W = inverse of a covariance.
glm::dmat2 whitening_of(const glm::dmat2& covariance) {
    const double a = std::sqrt(covariance[0][0]);
    const double b = covariance[0][1] / a;
    const double c = std::sqrt(std::max(covariance[1][1] - b * b, 0.0));
    const double least = 1e-12 * a;
    return glm::inverse(glm::dmat2(a, b, 0.0, std::max(c, least)));
}

void whiten_filters(Fitted& fitted, const Observations& observations) {
    fitted.weights.filter_whitening.clear();
    const double step2_m2 = fitted.step_sigma_m * fitted.step_sigma_m;
    for (const FilterView& filter : observations.filters) {
        const glm::dmat2 slope = filter_px_by_m(fitted.bundle, filter.position);
        const glm::dmat2 least(kLeastSigma_px * kLeastSigma_px);
        fitted.weights.filter_whitening.push_back(
            whitening_of(filter.covariance_px2 + least + slope * glm::transpose(slope) * step2_m2));
    }
}

// The noise with which residuals of centers from their grid are as large as they are: chi^2 over
// degrees of freedom is 1 (the grid's six numbers fit away as many). A sigma that comes from few
// residuals is itself uncertain: what it predicts follows Student's t, whose variance is larger by
// freedom / (freedom - 2); two degrees less give that.
double step_sigma_of(const Fitted& fitted, const Observations& observations) {
    if (!can_tell_step_sigma(observations))
        return 0.0;
    std::vector<glm::dvec2> residual_m;
    std::vector<glm::dmat2> covariance_m2;
    double largest_m2 = 0.0;
    for (const FilterView& filter : observations.filters) {
        const glm::dmat2 m_by_px = glm::inverse(filter_px_by_m(fitted.bundle, filter.position));
        const auto residual_px = filter_residual_px(fitted.bundle, filter);
        if (!residual_px)
            continue;
        residual_m.push_back(m_by_px * *residual_px);
        covariance_m2.push_back(seen_covariance_m2(fitted.bundle, filter));
        largest_m2 += squared_length(residual_m.back());
    }
    const double freedom = 2.0 * static_cast<double>(residual_m.size()) - 6.0 - 2.0;
    const auto chi2 = [&](double step2_m2) {
        double sum = 0.0;
        for (std::size_t i = 0; i < residual_m.size(); ++i)
            sum += glm::dot(residual_m[i],
                            glm::inverse(covariance_m2[i] + glm::dmat2(step2_m2)) * residual_m[i]);
        return sum;
    };
    if (chi2(0.0) <= freedom)
        return 0.0;
    double low = 0.0, high = largest_m2;
    constexpr int kHalvings = 60;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (chi2(middle) > freedom ? low : high) = middle;
    }
    return std::sqrt(high);
}

Fitted start_from(Bundle bundle, const Observations& observations, const FitSettings& settings) {
    Fitted fitted;
    fitted.bundle = std::move(bundle);
    fitted.bundle.board_middle_m = settings.board_middle_m;
    fitted.bundle.board_half_m = settings.board_half_m;
    fitted.choice.has_square_pixels = settings.has_square_pixels;
    fitted.choice.is_board_flat = settings.is_board_flat;
    for (const BoardView& view : observations.boards)
        fitted.weights.is_outlier.emplace_back(view.corners.size(), char{0});
    return fitted;
}

void solve_with(
    Fitted& fitted, const Observations& observations, Loss loss, double scale, double tolerance) {
    fitted.choice.loss = loss;
    fitted.choice.loss_scale = scale;
    fitted.choice.tolerance = tolerance;
    fitted.iterations += solve(fitted.bundle, observations, fitted.weights, fitted.choice);
}

}  // namespace

Fitted fit_lens(const Observations& observations, const FitSettings& settings) {
    constexpr double kCoarse = 1e-4;
    constexpr double kHuber_px = 1.0;
    constexpr double kCauchySigmas = 2.4;  // 95 % as efficient as least squares on normal noise
    Fitted fitted = start_from(first_guess(observations, settings.model), observations, settings);
    solve_with(fitted, observations, Loss::Huber, kHuber_px, kCoarse);
    fitted.weights.corner_sigma_px = noise_of(fitted, observations).robust_px;
    solve_with(fitted, observations, Loss::Cauchy, kCauchySigmas, kCoarse);
    settle(fitted, observations, settings);
    return fitted;
}

void settle(Fitted& fitted, const Observations& observations, const FitSettings& settings) {
    constexpr int kMostRounds = 8;
    constexpr double kStill = 1e-3;
    for (int round = 0; round < kMostRounds; ++round) {
        const double limit_px = settings.outlier_sigmas * noise_of(fitted, observations).robust_px;
        const bool has_changed = mark_outliers(fitted, observations, limit_px);
        const double noise_px = settings.corner_sigma_px > 0.0
                                    ? settings.corner_sigma_px
                                    : noise_of(fitted, observations).squares_px;
        const double before_px = fitted.weights.corner_sigma_px;
        const double step_before_m = fitted.step_sigma_m;
        fitted.weights.corner_sigma_px = noise_px;
        if (fitted.bundle.has_planes) {
            fitted.step_sigma_m = step_sigma_of(fitted, observations);
            whiten_filters(fitted, observations);
        }
        const bool is_still =
            round > 0 && !has_changed && std::abs(noise_px - before_px) <= kStill * noise_px &&
            std::abs(fitted.step_sigma_m - step_before_m) <= kStill * fitted.step_sigma_m;
        if (is_still)
            break;
        solve_with(fitted, observations, Loss::Squares, 1.0, 1e-12);
    }
}

Fitted fit_poses(const Observations& observations,
                 const Bundle& lens_from,
                 const FitSettings& settings) {
    Bundle bundle = lens_from;
    bundle.has_planes = false;
    bundle.boards.clear();
    for (const BoardView& view : observations.boards) {
        const auto pose = flat_pose(lens_of(lens_from), view.corners).value_or(Rigid{});
        const glm::dvec3 turn = angle_axis(pose.rotation), shift = pose.translation_m;
        bundle.boards.push_back(
            {capture::TargetPlane::Free, {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z}});
    }
    Fitted fitted = start_from(std::move(bundle), observations, settings);
    fitted.choice.is_lens_known = true;
    fitted.choice.is_board_flat = true;
    settle(fitted, observations, settings);
    return fitted;
}

double rms_px(const Fitted& fitted, const Observations& observations) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        const std::vector<Corner>& corners = observations.boards[view].corners;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (fitted.weights.is_outlier[view][i] != 0)
                continue;
            sum += squared_residual(fitted.bundle, view, corners[i]);
            ++count;
        }
    }
    return std::sqrt(sum / std::max(1, count));
}

bool can_tell_step_sigma(const Observations& observations) {
    return observations.filters.size() >= 5;  // four numbers more than the grid has
}

glm::dmat2 seen_covariance_m2(const Bundle& bundle, const FilterView& filter) {
    const glm::dmat2 m_by_px = glm::inverse(filter_px_by_m(bundle, filter.position));
    return m_by_px * filter.covariance_px2 * glm::transpose(m_by_px);
}

}  // namespace nearfield::calibrate
