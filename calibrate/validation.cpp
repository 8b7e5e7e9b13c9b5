// SPDX-License-Identifier: Apache-2.0
#include "calibrate/validation.h"

#include "calibrate/far_points.h"

#include <Eigen/Dense>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace nearfield::calibrate {
namespace {

constexpr std::size_t kLeastViews = 3;

template <typename IsTaken>
Observations views_where(const Observations& observations, const IsTaken& is_taken) {
    Observations taken = observations;
    taken.boards.clear();
    taken.filters.clear();
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        if (is_taken(view))
            taken.boards.push_back(observations.boards[view]);
    }
    return taken;
}

struct LensFit {
    Fitted fitted;
    std::optional<Eigen::MatrixXd> covariance;  // of the lens
};

LensFit fit_with_covariance(const Observations& observations, const FitSettings& settings) {
    LensFit fit{fit_lens(observations, settings), std::nullopt};
    const auto shared =
        shared_covariance(fit.fitted.bundle, observations, fit.fitted.weights, fit.fitted.choice);
    const auto numbers = static_cast<Eigen::Index>(fit.fitted.bundle.lens.size());
    if (shared)
        fit.covariance = shared->matrix.topLeftCorner(numbers, numbers);
    return fit;
}

// Mean square lengths times their counts, for RMS over several fits.
struct SquareSum {
    double sum = 0.0, count = 0.0;

    void add(const Fitted& fitted, const Observations& observations) {
        double corners = 0.0;
        for (const BoardView& view : observations.boards)
            corners += static_cast<double>(view.corners.size());
        const double rms = rms_px(fitted, observations);
        sum += rms * rms * corners;
        count += corners;
    }
    void add(const SquareSum& other) {
        sum += other.sum;
        count += other.count;
    }
    double rms() const { return std::sqrt(sum / std::max(count, 1.0)); }
};

}  // namespace

PictureMap uncertainty_map(const Bundle& bundle,
                           const Eigen::MatrixXd& lens_covariance,
                           glm::ivec2 points) {
    PictureMap map = map_points(bundle.size_px, points);
    map.value_px.assign(map.at_px.size(), std::numeric_limits<double>::quiet_NaN());
    for (const FarPoint& point : far_points(bundle, map))
        map.value_px[point.index] =
            std::sqrt(0.5 * (point.by_lens * lens_covariance * point.by_lens.transpose()).trace());
    return map;
}

std::optional<HalvesCheck> check_halves(const Observations& observations,
                                        const FitSettings& settings,
                                        glm::ivec2 points) {
    if (observations.boards.size() < 2 * kLeastViews)
        return std::nullopt;
    LensFit even, odd;
    tbb::parallel_invoke(
        [&] {
            even = fit_with_covariance(
                views_where(observations, [](std::size_t view) { return view % 2 == 0; }),
                settings);
        },
        [&] {
            odd = fit_with_covariance(
                views_where(observations, [](std::size_t view) { return view % 2 == 1; }),
                settings);
        });
    if (!even.covariance || !odd.covariance)
        return std::nullopt;
    HalvesCheck check;
    check.difference = map_points(observations.size_px, points);
    check.difference.value_px.assign(check.difference.at_px.size(),
                                     std::numeric_limits<double>::quiet_NaN());
    const std::vector<FarPoint> far = far_points(even.fitted.bundle, check.difference);
    const std::vector<glm::dvec2> moved_px =
        turned_differences_px(odd.fitted.bundle, check.difference, far);
    const Eigen::MatrixXd covariance = *even.covariance + *odd.covariance;
    double difference2 = 0.0, predicted2 = 0.0;
    for (std::size_t i = 0; i < far.size(); ++i) {
        check.difference.value_px[far[i].index] = glm::length(moved_px[i]);
        difference2 += glm::dot(moved_px[i], moved_px[i]);
        predicted2 += (far[i].by_lens * covariance * far[i].by_lens.transpose()).trace();
    }
    const double count = std::max(1.0, static_cast<double>(far.size()));
    check.difference_rms_px = std::sqrt(difference2 / count);
    check.predicted_rms_px = std::sqrt(predicted2 / count);
    return check;
}

std::optional<HeldOut> check_held_out(const Observations& observations,
                                      const FitSettings& settings,
                                      int folds) {
    const std::size_t views = observations.boards.size();
    const std::size_t parts = std::min(static_cast<std::size_t>(std::max(folds, 2)), views);
    if (views - (views + parts - 1) / parts < kLeastViews)
        return std::nullopt;
    std::vector<SquareSum> held_out(parts), fitted(parts);
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        const Observations others =
            views_where(observations, [&](std::size_t view) { return view % parts != part; });
        const Observations held =
            views_where(observations, [&](std::size_t view) { return view % parts == part; });
        const Fitted lens = fit_lens(others, settings);
        fitted[part].add(lens, others);
        held_out[part].add(fit_poses(held, lens.bundle, settings), held);
    });
    SquareSum all_held_out, all_fitted;
    for (std::size_t part = 0; part < parts; ++part) {
        all_held_out.add(held_out[part]);
        all_fitted.add(fitted[part]);
    }
    return HeldOut{static_cast<int>(parts), all_held_out.rms(), all_fitted.rms()};
}

std::optional<BoardBend> board_bend(Fitted fitted,
                                    const Observations& observations,
                                    FitSettings settings) {
    settings.is_board_flat = false;
    fitted.choice.is_board_flat = false;
    settle(fitted, observations, settings);
    const auto shared =
        shared_covariance(fitted.bundle, observations, fitted.weights, fitted.choice);
    if (!shared)
        return std::nullopt;
    const SharedLayout layout(fitted.bundle);
    const Eigen::Matrix3d covariance = shared->matrix.block<3, 3>(layout.bend, layout.bend);
    const Eigen::Vector3d bend(fitted.bundle.bend_m.data());
    const Eigen::Vector3d sigma = covariance.diagonal().cwiseSqrt();
    // Chi^2 of three numbers as a normal one: Wilson and Hilferty 1931.
    const double chi2 = bend.dot(covariance.ldlt().solve(bend));
    constexpr double kSpread2 = 2.0 / 27.0;
    return BoardBend{{bend.x(), bend.y(), bend.z()},
                     {sigma.x(), sigma.y(), sigma.z()},
                     (std::cbrt(chi2 / 3.0) - (1.0 - kSpread2)) / std::sqrt(kSpread2)};
}

}  // namespace nearfield::calibrate
