// SPDX-License-Identifier: Apache-2.0
#include "calibrate/filter_profile.h"

#include "calibrate/filter_model.h"
#include "formats/files/error.h"
#include "formats/model/profile.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr double kBesideSupport_pitches = 0.5;  // pixels there say where the profile ends
constexpr double kLeastJump = 0.005, kJumpSigmas = 3.0;
constexpr int kMostSteps = 100;
constexpr int kProfileBins = 40;

struct FilterFit {
    FilterParameters parameters;
    Eigen::MatrixXd covariance;  // scaled by chi-square where that is above 1
    NormalEquations normal;
    double inflation = 1;
};

FilterParameters first_guess(const FilterSamples& found,
                             const FilterGeometry& geometry,
                             const Profile& nominal,
                             int colors) {
    FilterParameters parameters;
    for (const glm::dvec2 guess_m : found.guess_u_m)
        parameters.center.push_back(guess_m / geometry.pitch_m);
    parameters.turn_rad = geometry.turn_guess_rad;
    parameters.peak.assign(static_cast<std::size_t>(colors), 0.0);
    for (const FilterSample& sample : found.samples) {
        double& peak = parameters.peak[static_cast<std::size_t>(sample.color)];
        peak = std::max(peak, static_cast<double>(sample.transmission));
    }
    parameters.cells = nominal.cells;
    const double at_center = model::eval(nominal, 0.0);
    for (std::array<double, 3>& cell : parameters.cells) {
        for (double& coefficient : cell)
            coefficient /= at_center;
    }
    return parameters;
}

// Levenberg and Marquardt's iteration: Gauss and Newton's, damped while it does not descend.
FilterFit minimize(const std::vector<FilterSample>& samples,
                   FilterParameters start,
                   glm::dvec2 pitch_m,
                   const std::vector<Condition>& conditions) {
    constexpr double kDone = 1e-2;     // of chi-square: a tenth of a sigma
    constexpr double kUndamped = 1e3;  // beyond, a small gain may be that of a small step
    FilterFit fit{std::move(start), {}, {}, 1.0};
    fit.normal = normal_equations(samples, fit.parameters, pitch_m, conditions);
    double damping = 1e-3;
    bool is_done = false;
    for (int step = 0; step < kMostSteps && !is_done; ++step) {
        Eigen::MatrixXd damped = fit.normal.matrix;
        damped.diagonal() *= 1.0 + damping;
        FilterParameters next = fit.parameters;
        next.add(damped.ldlt().solve(fit.normal.gradient));
        NormalEquations then = normal_equations(samples, next, pitch_m, conditions);
        const double before = fit.normal.chi2 + fit.normal.conditions_chi2;
        const double after = then.chi2 + then.conditions_chi2;
        if (!(after <= before)) {
            damping *= 10.0;
            is_done = damping > 1e8;
            continue;
        }
        is_done = before - after < kDone && damping < kUndamped;
        damping = std::max(damping * 0.1, 1e-12);
        fit.parameters = std::move(next);
        fit.normal = std::move(then);
    }
    if (!is_done)
        throw Error{"the filter's profile cannot be fitted", "filter views", "a fit that converges",
                    fmt::format("chi-square {:.3g} after {} steps", fit.normal.chi2, kMostSteps)};
    const auto count = static_cast<Eigen::Index>(fit.parameters.count());
    const double freedom = static_cast<double>(samples.size()) - static_cast<double>(count);
    fit.inflation = std::max(1.0, fit.normal.chi2 / std::max(1.0, freedom));
    fit.covariance =
        fit.inflation * fit.normal.matrix.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
    return fit;
}

double sigma_along(const FilterFit& fit, const Eigen::VectorXd& row) {
    return std::sqrt(std::max(0.0, row.dot(fit.covariance * row)));
}

double knot_jump(const FilterFit& fit, const Eigen::VectorXd& row) {
    double jump = 0;
    for (std::size_t c = 0; c < fit.parameters.cells.size(); ++c) {
        for (std::size_t power = 0; power < 3; ++power)
            jump += row[fit.parameters.cell_index(c) + static_cast<int>(power)] *
                    fit.parameters.cells[c][power];
    }
    return jump;
}

FilterCenter center_of(const FilterFit& fit,
                       std::size_t view,
                       glm::ivec2 position,
                       const FilterGeometry& geometry) {
    FilterCenter center;
    center.position = position;
    center.center_u_m = fit.parameters.center[view] * geometry.pitch_m;
    const auto seen_px = [&](glm::dvec2 u_m) {
        const auto at =
            rig::project_px(geometry.lens, geometry.camera_from_u.rotation * glm::dvec3(u_m, 0.0) +
                                               geometry.camera_from_u.translation_m);
        if (!at)
            throw Error{"the filter is behind the camera", "filter views", "planes before it", ""};
        return *at;
    };
    center.center_px = seen_px(center.center_u_m);
    const double step = 1e-4;  // of a pitch
    const glm::dvec2 by_x =
        (seen_px((fit.parameters.center[view] + glm::dvec2(step, 0.0)) * geometry.pitch_m) -
         center.center_px) /
        step;
    const glm::dvec2 by_y =
        (seen_px((fit.parameters.center[view] + glm::dvec2(0.0, step)) * geometry.pitch_m) -
         center.center_px) /
        step;
    const glm::dmat2 px_from_pitches(by_x, by_y);
    const int at = 2 * static_cast<int>(view);
    const glm::dmat2 covariance(fit.covariance(at, at), fit.covariance(at, at + 1),
                                fit.covariance(at + 1, at), fit.covariance(at + 1, at + 1));
    center.covariance_px2 = px_from_pitches * covariance * glm::transpose(px_from_pitches);
    center.pixels = fit.normal.view_pixels[view];
    center.chi2_per_pixel = fit.normal.view_chi2[view] / static_cast<double>(center.pixels);
    return center;
}

// Means along one axis: how much of what the other axis lets through arrives.
std::vector<ProfilePoint> points_along(const std::vector<FilterSample>& samples,
                                       const FilterFit& fit,
                                       glm::dvec2 pitch_m,
                                       int axis) {
    constexpr double kLeastThrough = 0.2;  // of what the other axis lets through at its best
    const auto cells = static_cast<double>(fit.parameters.cells.size());
    struct Bin {
        double weight = 0, value = 0, fitted = 0, x = 0;
    };
    std::vector<Bin> bins(kProfileBins);
    for (const FilterSample& sample : samples) {
        const OnFilter at = on_filter(sample, fit.parameters, pitch_m);
        const double place = (at.x[axis] / cells + 0.5) * kProfileBins;
        if (!(place >= 0.0 && place < kProfileBins))
            continue;
        const double other =
            fit.parameters.peak[static_cast<std::size_t>(sample.color)] *
            blurred_value(fit.parameters.cells, at.x[1 - axis], at.spread[1 - axis]);
        if (other < kLeastThrough * fit.parameters.peak[static_cast<std::size_t>(sample.color)])
            continue;
        const double own = blurred_value(fit.parameters.cells, at.x[axis], at.spread[axis]);
        const double inverse = 1.0 / (static_cast<double>(sample.sigma) * sample.sigma);
        Bin& bin = bins[static_cast<std::size_t>(place)];
        bin.weight += inverse * other * other;
        bin.value += inverse * other * sample.transmission;
        bin.fitted += inverse * other * other * own;
        bin.x += inverse * other * other * at.x[axis];
    }
    std::vector<ProfilePoint> points;
    for (const Bin& bin : bins) {
        if (bin.weight > 0.0)
            points.push_back({bin.x / bin.weight, bin.value / bin.weight,
                              std::sqrt(fit.inflation / bin.weight), bin.fitted / bin.weight});
    }
    return points;
}

void compare_axes(FilterProfileResult& result) {
    const std::size_t count = std::min(result.along_x.size(), result.along_y.size());
    double squares = 0, chi2 = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const ProfilePoint &a = result.along_x[k], &b = result.along_y[k];
        const double difference = (a.value - a.fitted) - (b.value - b.fitted);
        squares += difference * difference;
        chi2 += difference * difference / (a.sigma * a.sigma + b.sigma * b.sigma);
    }
    if (count == 0)
        return;
    const auto n = static_cast<double>(count);
    result.asymmetry = std::sqrt(squares / n);
    result.asymmetry_sigmas = (chi2 - n) / std::sqrt(2.0 * n);
}

void compare_nominal(const FilterFit& fit, const Profile& nominal, FilterProfileResult& result) {
    constexpr int kPlaces = 400;
    const std::size_t cells = fit.parameters.cells.size();
    const double at_center = model::eval(nominal, 0.0);
    for (int k = 0; k < kPlaces; ++k) {
        const double x = (double(k + 0.5) / kPlaces - 0.5) * static_cast<double>(cells);
        const auto cell = static_cast<std::size_t>(x + 0.5 * static_cast<double>(cells));
        const double difference =
            std::abs(model::eval(result.profile, x) - model::eval(nominal, x) / at_center);
        if (difference <= result.nominal_deviation)
            continue;
        Eigen::VectorXd row = Eigen::VectorXd::Zero(fit.parameters.count());
        for (int power = 0; power < 3; ++power)
            row[fit.parameters.cell_index(cell) + power] = std::pow(x, power);
        result.nominal_deviation = difference;
        result.nominal_sigmas = difference / std::max(sigma_along(fit, row), 1e-12);
    }
}

// Fits freely, then with all knots continuous where nothing speaks against it.
FilterFit fit_profile(const FilterSamples& found,
                      const FilterGeometry& geometry,
                      const Profile& nominal,
                      int colors,
                      int& jumps) {
    const FilterParameters start = first_guess(found, geometry, nominal, colors);
    std::vector<Condition> conditions{peak_condition(start), center_condition(start)};
    FilterFit fit = minimize(found.samples, start, geometry.pitch_m, conditions);
    for (std::size_t knot = 0; knot <= nominal.cells.size(); ++knot) {
        const Eigen::VectorXd row = jump_row(fit.parameters, knot);
        const double jump = std::abs(knot_jump(fit, row));
        if (jump > kLeastJump && jump > kJumpSigmas * sigma_along(fit, row))
            ++jumps;
        else
            conditions.push_back({row, 0.0});
    }
    return minimize(found.samples, fit.parameters, geometry.pitch_m, conditions);
}

}  // namespace

FilterProfileResult filter_profile_of(std::span<const FilterPicture> pictures,
                                      const FilterGeometry& geometry,
                                      const Profile& nominal,
                                      int colors,
                                      const std::vector<int>& color_of) {
    const double reach = 0.5 * static_cast<double>(nominal.cells.size()) + kBesideSupport_pitches;
    const FilterSamples found = filter_samples_of(pictures, geometry, reach, color_of);
    FilterProfileResult result;
    const FilterFit fit = fit_profile(found, geometry, nominal, colors, result.jumps);
    result.profile = {"measured", fit.parameters.cells};
    result.peak = fit.parameters.peak;
    for (int color = 0; color < colors; ++color) {
        const int at = fit.parameters.peak_index(color);
        result.peak_sigma.push_back(std::sqrt(fit.covariance(at, at)));
    }
    result.turn_rad = fit.parameters.turn_rad;
    const int turn = fit.parameters.turn_index();
    result.turn_sigma_rad = std::sqrt(fit.covariance(turn, turn));
    for (std::size_t view = 0; view < pictures.size(); ++view)
        result.centers.push_back(center_of(fit, view, pictures[view].position, geometry));
    result.chi2 = fit.normal.chi2;
    result.pixels = found.samples.size();
    result.parameters = fit.parameters.count();
    result.along_x = points_along(found.samples, fit, geometry.pitch_m, 0);
    result.along_y = points_along(found.samples, fit, geometry.pitch_m, 1);
    compare_axes(result);
    compare_nominal(fit, nominal, result);
    return result;
}

}  // namespace nearfield::calibrate
