// SPDX-License-Identifier: Apache-2.0
#include "calibrate/geometry.h"

#include "calibrate/initial_pose.h"
#include "calibrate/more_views.h"
#include "calibrate/plane_frames.h"
#include "calibrate/robust_fit.h"
#include "calibrate/validation.h"
#include "formats/files/error.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace nearfield::calibrate {
namespace {

constexpr const char* kWhatFailed = "cannot calibrate the camera";
constexpr std::size_t kLeastBoards = 3;

void check_positions(const Observations& observations) {
    const glm::dvec2 size_px(observations.size_px);
    for (const BoardView& view : observations.boards) {
        for (const Corner& corner : view.corners) {
            const glm::dvec2 at = corner.at_px;
            if (!(at.x >= 0.0 && at.y >= 0.0 && at.x <= size_px.x && at.y <= size_px.y))
                throw Error{kWhatFailed, fmt::format("{}, corner {}", view.name, corner.id),
                            fmt::format("a place in the picture of {} x {} px; all pictures of one "
                                        "camera are of one size",
                                        observations.size_px.x, observations.size_px.y),
                            fmt::format("({}, {})", at.x, at.y)};
        }
    }
}

// Why a view cannot be used; empty where it can.
std::string why_unused(const BoardView& view, glm::ivec2 size_px) {
    constexpr std::size_t kLeastCorners = 6;
    if (view.corners.empty())
        return "no board found";
    if (view.corners.size() < kLeastCorners)
        return fmt::format("{} corners found, at least {} are needed", view.corners.size(),
                           kLeastCorners);
    rig::Lens any;
    any.size_px = size_px;
    any.fx_px = any.fy_px = size_px.x;
    any.cx_px = 0.5 * size_px.x;
    any.cy_px = 0.5 * size_px.y;
    any.distortion.assign(5, 0.0);
    return flat_pose(any, view.corners) ? "" : "its corners lie on a line";
}

Observations usable_views(const Observations& observations, std::vector<UnusedView>& unused) {
    Observations usable = observations;
    usable.boards.clear();
    for (const BoardView& view : observations.boards) {
        const std::string why = why_unused(view, observations.size_px);
        if (why.empty())
            usable.boards.push_back(view);
        else
            unused.push_back({view.view, view.name, why});
    }
    if (usable.boards.size() >= kLeastBoards)
        return usable;
    std::string list;
    for (const UnusedView& view : unused)
        list += fmt::format("; {}: {}", view.name, view.why);
    throw Error{kWhatFailed, "views of boards",
                fmt::format("at least {} that show the board, better 15", kLeastBoards),
                fmt::format("{}{}", usable.boards.size(), list)};
}

FitSettings settings_of(const GeometryOptions& options, const Observations& observations) {
    FitSettings settings;
    settings.model = options.lens_model;
    settings.has_square_pixels = options.has_square_pixels;
    settings.is_board_flat = options.is_board_flat;
    settings.outlier_sigmas = options.outlier_sigmas;
    settings.corner_sigma_px = options.corner_sigma_px;
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const BoardView& view : observations.boards) {
        for (const Corner& corner : view.corners) {
            low = glm::min(low, corner.board_m);
            high = glm::max(high, corner.board_m);
        }
    }
    settings.board_middle_m = 0.5 * (low + high);
    settings.board_half_m = 0.5 * (high - low);
    return settings;
}

// Covariance of what is shared; refused where the views do not determine the lens. Noise is taken
// to be no less than what corners have on any bench, so that perfect data are not believed either.
SharedCovariance known_lens(Fitted& fitted,
                            const Observations& observations,
                            double focal_limit_rel) {
    constexpr double kUsualNoise_px = 0.05;
    auto covariance = shared_covariance(fitted.bundle, observations, fitted.weights, fitted.choice);
    const double worse = std::max(1.0, kUsualNoise_px / fitted.weights.corner_sigma_px);
    double focal_rel = std::numeric_limits<double>::infinity();
    if (covariance) {
        focal_rel = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
            const double focal_px = fitted.bundle.lens[static_cast<std::size_t>(axis)];
            const double sigma_px = worse * std::sqrt(covariance->matrix(axis, axis));
            focal_rel = std::max(focal_rel, sigma_px / std::abs(focal_px));
        }
    }
    if (!(focal_rel <= focal_limit_rel))
        throw Error{kWhatFailed, "boards' poses",
                    fmt::format("boards tilted by 20 to 45 degrees to either side, so that the "
                                "focal length is known to {:.1f} %",
                                100.0 * focal_limit_rel),
                    covariance ? fmt::format("a focal length of {:.0f} px +- {:.1f} %",
                                             fitted.bundle.lens[0], 100.0 * focal_rel)
                               : std::string("boards that do not tell it: they are parallel")};
    return *covariance;
}

void fill_views(const Fitted& fitted,
                const Observations& observations,
                const SharedCovariance& covariance,
                Geometry& geometry) {
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        const BoardView& board = observations.boards[view];
        ViewResult result{
            board.view, board.name, board.plane, camera_from_board(fitted.bundle, view),
            {},         0.0,        {}};
        for (const double variance : covariance.poses[view].diagonal())
            result.pose_sigma.push_back(std::sqrt(variance));
        double sum = 0.0;
        int used = 0;
        for (std::size_t i = 0; i < board.corners.size(); ++i) {
            const Corner& corner = board.corners[i];
            const auto residual = corner_residual_px(fitted.bundle, view, corner);
            const bool is_outlier = fitted.weights.is_outlier[view][i] != 0;
            const glm::dvec2 residual_px = residual.value_or(glm::dvec2(0.0));
            result.corners.push_back(
                {corner.id, corner.board_m, corner.at_px, residual_px, is_outlier});
            if (is_outlier) {
                geometry.outliers.push_back(
                    {board.view, board.name, corner.id, glm::length(residual_px)});
                continue;
            }
            sum += glm::dot(residual_px, residual_px);
            ++used;
        }
        result.rms_px = std::sqrt(sum / std::max(1, used));
        geometry.views.push_back(std::move(result));
    }
    geometry.rms_px = rms_px(fitted, observations);
    geometry.corner_sigma_px = fitted.weights.corner_sigma_px;
}

std::vector<std::string> lens_names(rig::LensModel model) {
    std::vector<std::string> names = {"fx_px", "fy_px", "cx_px", "cy_px"};
    if (model == rig::LensModel::Fisheye)
        names.insert(names.end(), {"k1", "k2", "k3", "k4"});
    else
        names.insert(names.end(), {"k1", "k2", "p1", "p2", "k3"});
    if (model == rig::LensModel::Brown8)
        names.insert(names.end(), {"k4", "k5", "k6"});
    return names;
}

// Lens, bend where it was estimated, and planes, with the covariance of all of them.
void fill_parameters(const Fitted& fitted, const Eigen::MatrixXd& shared, Geometry& geometry) {
    const Bundle& bundle = fitted.bundle;
    const SharedLayout layout(bundle);
    std::vector<std::string> names = lens_names(bundle.model);
    std::vector<double> values = bundle.lens;
    if (!fitted.choice.is_board_flat) {
        names.insert(names.end(), {"bend_xx_m", "bend_xy_m", "bend_yy_m"});
        values.insert(values.end(), bundle.bend_m.begin(), bundle.bend_m.end());
    }
    const auto direct = static_cast<Eigen::Index>(names.size());
    PlaneParameters planes;
    if (bundle.has_planes)
        planes = plane_parameters(bundle);
    const Eigen::Index count = direct + planes.values.size();
    Eigen::MatrixXd by_shared = Eigen::MatrixXd::Zero(count, layout.count);
    by_shared.topLeftCorner(direct, direct).setIdentity();
    if (bundle.has_planes)
        by_shared.bottomRows(planes.values.size()) = planes.by_shared;
    names.insert(names.end(), planes.names.begin(), planes.names.end());
    values.insert(values.end(), planes.values.begin(), planes.values.end());
    const Eigen::MatrixXd covariance = by_shared * shared * by_shared.transpose();
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        geometry.parameters.push_back(
            {names[at], values[at], std::sqrt(std::max(covariance(i, i), 0.0))});
        for (Eigen::Index j = 0; j < count; ++j)
            geometry.covariance.push_back(covariance(i, j));
    }
    geometry.covariance_of = names;
}

// Sigmas of the same parameters if views of one kind counted twice.
std::vector<MoreViews> more_views(const Fitted& fitted, const Observations& observations) {
    std::vector<MoreViews> all;
    for (CountedTwice& twice : counted_twice(fitted, observations)) {
        const auto covariance = shared_covariance(twice.fitted.bundle, twice.observations,
                                                  twice.fitted.weights, twice.fitted.choice);
        if (!covariance)
            continue;
        Geometry then;
        fill_parameters(twice.fitted, covariance->matrix, then);
        MoreViews more{twice.what, {}};
        for (const rig::Parameter& parameter : then.parameters)
            more.sigma.push_back(parameter.sigma);
        all.push_back(std::move(more));
    }
    return all;
}

// Views as they were fitted, without outliers.
Observations without_outliers(const Observations& observations, const Fitted& fitted) {
    Observations clean = observations;
    for (std::size_t view = 0; view < clean.boards.size(); ++view) {
        std::vector<Corner> kept;
        for (std::size_t i = 0; i < clean.boards[view].corners.size(); ++i) {
            if (fitted.weights.is_outlier[view][i] == 0)
                kept.push_back(clean.boards[view].corners[i]);
        }
        clean.boards[view].corners = std::move(kept);
    }
    return clean;
}

void validate(const Fitted& lens_fit,
              const Observations& observations,
              FitSettings settings,
              const GeometryOptions& options,
              Geometry& geometry) {
    const Observations clean = without_outliers(observations, lens_fit);
    settings.outlier_sigmas = std::numeric_limits<double>::infinity();
    Fitted all = lens_fit;
    for (std::size_t view = 0; view < clean.boards.size(); ++view)
        all.weights.is_outlier[view].assign(clean.boards[view].corners.size(), char{0});
    tbb::parallel_invoke(
        [&] { geometry.halves = check_halves(clean, settings, options.map_points); },
        [&] { geometry.held_out = check_held_out(clean, settings, options.held_out_folds); },
        [&] { geometry.bend = board_bend(std::move(all), clean, settings); });
}

}  // namespace

Geometry calibrate_geometry(const Observations& observations, const GeometryOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    Geometry geometry;
    check_positions(observations);
    const Observations usable = usable_views(observations, geometry.unused);
    const FitSettings settings = settings_of(options, usable);
    Fitted lens_fit = fit_lens(usable, settings);
    SharedCovariance covariance = known_lens(lens_fit, usable, options.focal_limit_rel);
    Fitted fitted = lens_fit;
    if (options.with_planes) {
        put_on_planes(fitted.bundle, usable);
        settle(fitted, usable, settings);
        covariance = known_lens(fitted, usable, options.focal_limit_rel);
        geometry.planes = planes_result(fitted, usable, covariance.matrix);
    }
    geometry.lens = lens_of(fitted.bundle);
    fill_views(fitted, usable, covariance, geometry);
    fill_parameters(fitted, covariance.matrix, geometry);
    const auto numbers = static_cast<Eigen::Index>(fitted.bundle.lens.size());
    geometry.uncertainty = uncertainty_map(
        fitted.bundle, covariance.matrix.topLeftCorner(numbers, numbers), options.map_points);
    if (options.with_validation)
        geometry.more_views = more_views(fitted, usable);
    if (options.with_validation)
        validate(lens_fit, usable, settings, options, geometry);
    geometry.iterations = fitted.iterations;
    geometry.time_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return geometry;
}

}  // namespace nearfield::calibrate
