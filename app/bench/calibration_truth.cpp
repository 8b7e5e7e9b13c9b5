// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration_truth.h"

#include "formats/shared/rng.glsl.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <optional>

namespace nearfield::bench {
namespace {

using capture::TargetPlane;
using rig::LensModel;

constexpr glm::ivec2 kSquares{8, 6};
constexpr double kSquare_m = 0.03;
constexpr double kFilterSigma_px = 0.02;
constexpr double kPi = 3.14159265358979324;

enum class Use : std::uint32_t { Corner = 1, Filter, Step, OnPlane, FreePlace, FreeTurn };

/// Numbers that are a function of what they are for.
struct Draws {
    std::uint32_t seed = 0, trial = 0;

    glm::dvec4 uniform(Use use, std::uint32_t index) const {
        constexpr double kStep = 1.0 / 4294967296.0;
        const glm::uvec4 words =
            shared::hash4(glm::uvec4(seed, trial, static_cast<std::uint32_t>(use), index));
        return (glm::dvec4(words) + 0.5) * kStep;
    }
    /// Two standard normal numbers: Box and Muller 1958.
    glm::dvec2 normal(Use use, std::uint32_t index) const {
        const glm::dvec4 u = uniform(use, index);
        const double angle = 2.0 * kPi * u.y;
        return std::sqrt(-2.0 * std::log(u.x)) * glm::dvec2(std::cos(angle), std::sin(angle));
    }
};

rig::Lens truth_lens(LensModel model, bool is_wide) {
    rig::Lens lens;
    lens.model = model;
    lens.size_px = {512, 512};
    lens.fx_px = is_wide ? 400.0 : 800.0;
    lens.fy_px = 1.001 * lens.fx_px;
    lens.cx_px = 258.3;
    lens.cy_px = 254.1;
    switch (model) {
        case LensModel::Brown5:
            lens.distortion = {is_wide ? -0.28 : -0.11, 0.09, 0.0004, -0.0003,
                               is_wide ? -0.02 : 0.02};
            break;
        case LensModel::Brown8:
            lens.distortion = {0.12, -0.03, 0.0004, -0.0003, 0.004, 0.42, 0.03, 0.001};
            break;
        case LensModel::Fisheye:
            lens.distortion = {-0.02, 0.01, -0.005, 0.002};
            break;
    }
    return lens;
}

glm::dmat3 turn_about(double angle_rad, glm::dvec3 axis) {
    return glm::mat3_cast(glm::angleAxis(angle_rad, axis));
}

glm::dvec3 applied(const Rigid& a_from_b, glm::dvec3 p_b) {
    return a_from_b.rotation * p_b + a_from_b.translation_m;
}

Rigid joined(const Rigid& a_from_b, const Rigid& b_from_c) {
    return {a_from_b.rotation * b_from_c.rotation, applied(a_from_b, b_from_c.translation_m)};
}

// A board of that direction whose middle is there.
Rigid board_at(const glm::dmat3& a_from_board, glm::dvec3 middle_a_m) {
    const glm::dvec3 middle_board_m(0.5 * kSquare_m * glm::dvec2(kSquares), 0.0);
    return {a_from_board, middle_a_m - a_from_board * middle_board_m};
}

// A camera beyond S looks back at the lamp.
glm::dmat3 facing_back() {
    return glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
}

Rigid slab_from_u(const CalibrationTruth& truth, double tilt_rad) {
    const double by_axis_rad = tilt_rad / std::sqrt(2.0);
    return {turn_about(-by_axis_rad, {0, 1, 0}) * turn_about(by_axis_rad, {1, 0, 0}),
            {0.0, 0.0, -truth.delta_m}};
}

// Lies in the plane, turned and shifted within it.
Rigid plane_from_board(const Draws& draws, std::uint32_t index) {
    const glm::dvec4 u = draws.uniform(Use::OnPlane, index) - 0.5;
    const double turn_rad = 0.3 * u.z + (index % 2 == 1 ? 0.5 * kPi : 0.0);
    return board_at(turn_about(turn_rad, {0, 0, 1}) * facing_back(), {0.1 * u.x, 0.1 * u.y, 0.0});
}

// Tilted by 20 to 35 degrees to any side, its middle in the inner half of the picture, 45 to 75 %
// of the picture wide.
Rigid free_pose_of(const CalibrationTruth& truth, const Draws& draws, std::uint32_t index) {
    const glm::dvec4 place = draws.uniform(Use::FreePlace, index);
    const glm::dvec4 turn = draws.uniform(Use::FreeTurn, index);
    const glm::dvec2 at_px = (0.25 + 0.5 * glm::dvec2(place)) * glm::dvec2(truth.lens.size_px);
    const double wide_px = (0.45 + 0.3 * place.z) * truth.lens.size_px.x;
    const double distance_m = truth.lens.fx_px * kSquares.x * kSquare_m / wide_px;
    const double tilt_rad = (20.0 + 15.0 * turn.x) * kPi / 180.0, side_rad = 2.0 * kPi * turn.y;
    const glm::dmat3 rotation =
        turn_about(tilt_rad, {std::cos(side_rad), std::sin(side_rad), 0.0}) *
        turn_about((turn.z - 0.5) * 0.5 * kPi, {0, 0, 1});
    const glm::dvec3 ray = rig::ray_camera(truth.lens, at_px).value_or(glm::dvec3(0.0, 0.0, 1.0));
    return board_at(rotation, distance_m * ray);
}

// Where a point is seen within the picture; none beyond its edge, or where the distortion's formula
// has folded back.
std::optional<glm::dvec2> seen_in_picture(const rig::Lens& lens, glm::dvec3 p_camera) {
    constexpr double kEdge_px = 1.0, kSame = 1e-6;
    const auto at_px = rig::project_px(lens, p_camera);
    if (!at_px || !(glm::all(glm::greaterThan(*at_px, glm::dvec2(kEdge_px))) &&
                    glm::all(glm::lessThan(*at_px, glm::dvec2(lens.size_px) - kEdge_px))))
        return std::nullopt;
    const auto ray = rig::ray_camera(lens, *at_px);
    if (!ray || glm::distance(*ray, p_camera / p_camera.z) > kSame)
        return std::nullopt;
    return at_px;
}

}  // namespace

CalibrationTruth make_calibration_truth(const TruthOptions& options) {
    const Draws draws{options.seed, options.trial};
    CalibrationTruth truth;
    truth.lens = truth_lens(options.lens_model, options.is_wide);
    truth.delta_m = 0.2;
    truth.grid = {9, 7};
    truth.pitch_m = {0.02, 0.0215};
    truth.bend_m = options.bend_m;
    const glm::dvec3 camera_slab(0.02, -0.03, 0.8);
    const glm::dmat3 camera_from_slab = glm::transpose(
        turn_about(0.03, glm::normalize(glm::dvec3(1.0, -1.5, 0.7))) * facing_back());
    truth.camera_from_slab = {camera_from_slab, -(camera_from_slab * camera_slab)};

    const Rigid u = slab_from_u(truth, options.u_tilt_rad);
    for (int i = 0; i < truth.grid.x * truth.grid.y; ++i) {
        const glm::dvec2 steps =
            glm::dvec2(i % truth.grid.x, i / truth.grid.x) - 0.5 * glm::dvec2(truth.grid - 1);
        const glm::dvec2 error_m =
            options.step_sigma_m * draws.normal(Use::Step, static_cast<std::uint32_t>(i));
        truth.center_slab.push_back(applied(u, {steps * truth.pitch_m + error_m, 0.0}));
    }

    for (std::uint32_t i = 0; i < 2; ++i)
        truth.views.push_back(
            {TargetPlane::Screen, joined(truth.camera_from_slab, plane_from_board(draws, i))});
    for (std::uint32_t i = 2; i < 4; ++i)
        truth.views.push_back({TargetPlane::Filter, joined(joined(truth.camera_from_slab, u),
                                                           plane_from_board(draws, i))});
    for (int i = 0; i < options.free_views; ++i)
        truth.views.push_back(
            {TargetPlane::Free, free_pose_of(truth, draws, static_cast<std::uint32_t>(i))});
    return truth;
}

calibrate::Observations observe(const CalibrationTruth& truth,
                                double corner_sigma_px,
                                std::uint32_t seed,
                                std::uint32_t trial) {
    const Draws draws{seed, trial};
    const glm::ivec2 inner = kSquares - 1;
    const int corners = inner.x * inner.y;
    calibrate::Observations seen;
    seen.size_px = truth.lens.size_px;
    seen.grid = truth.grid;
    seen.pitch_m = truth.pitch_m;
    for (std::size_t view = 0; view < truth.views.size(); ++view) {
        calibrate::BoardView board{
            static_cast<int>(view), truth.views[view].plane, fmt::format("view {}", view), {}};
        for (int id = 0; id < corners; ++id) {
            const glm::ivec2 place(id % inner.x, id / inner.x);
            // -1 ... 1 from the first to the last inner corner.
            const glm::dvec2 part =
                2.0 * glm::dvec2(place) / glm::dvec2(inner - 1) - glm::dvec2(1.0);
            const double z_m = truth.bend_m * (part.x * part.x + 0.5 * part.y * part.y);
            const glm::dvec2 board_m = kSquare_m * glm::dvec2(place + 1);
            const auto at_px = seen_in_picture(
                truth.lens, applied(truth.views[view].camera_from_board, {board_m, z_m}));
            const auto index = static_cast<std::uint32_t>(static_cast<int>(view) * corners + id);
            if (at_px)
                board.corners.push_back(
                    {id, board_m,
                     glm::clamp(*at_px + corner_sigma_px * draws.normal(Use::Corner, index),
                                glm::dvec2(0.0), glm::dvec2(truth.lens.size_px))});
        }
        seen.boards.push_back(std::move(board));
    }
    for (int row = 0; row < truth.grid.y; row += (truth.grid.y - 1) / 2) {
        for (int column = 0; column < truth.grid.x; column += (truth.grid.x - 1) / 2) {
            const int index = row * truth.grid.x + column;
            const auto at_px = seen_in_picture(
                truth.lens, applied(truth.camera_from_slab,
                                    truth.center_slab[static_cast<std::size_t>(index)]));
            if (at_px)
                seen.filters.push_back(
                    {{column, row},
                     *at_px + kFilterSigma_px *
                                  draws.normal(Use::Filter, static_cast<std::uint32_t>(index)),
                     glm::dmat2(kFilterSigma_px * kFilterSigma_px)});
        }
    }
    return seen;
}

}  // namespace nearfield::bench
