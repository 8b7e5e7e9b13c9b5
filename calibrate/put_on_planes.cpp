// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bundle_residuals.h"
#include "calibrate/initial_pose.h"
#include "calibrate/plane_frames.h"
#include "formats/files/error.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr const char* kWhat = "cannot find the planes";

Rigid free_pose(const BoardPose& board) {
    const double angle = std::hypot(board.numbers[0], board.numbers[1], board.numbers[2]);
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    if (angle > 0.0)
        ceres::AngleAxisToRotationMatrix(board.numbers.data(), rotation.data());
    Rigid pose;
    for (int column = 0; column < 3; ++column)
        pose.rotation[column] = glm_from(rotation.col(column));
    pose.translation_m = {board.numbers[3], board.numbers[4], board.numbers[5]};
    return pose;
}

// The plane's anchor is the first board on it; the others get their places.
PlaneMove put_boards(Bundle& bundle, const Observations& observations, capture::TargetPlane on) {
    PlaneMove plane;
    bool has_anchor = false;
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        BoardPose& board = bundle.boards[view];
        if (observations.boards[view].plane != on)
            continue;
        const Rigid pose = free_pose(board);
        if (!has_anchor)
            plane.camera_from_anchor = pose;
        has_anchor = true;
        const glm::dmat3 anchor_from_camera = glm::transpose(plane.camera_from_anchor.rotation);
        const glm::dvec3 at =
            anchor_from_camera * (pose.translation_m - plane.camera_from_anchor.translation_m);
        const glm::dvec3 x = anchor_from_camera * pose.rotation[0];
        board.plane = on;
        board.numbers = {at.x, at.y, std::atan2(x.y, x.x)};
    }
    if (!has_anchor) {
        const bool is_screen = on == capture::TargetPlane::Screen;
        throw Error{kWhat,
                    is_screen ? "views of boards on the screen" : "views of boards on the filter",
                    is_screen ? "at least one: hold the board flat against the screen"
                              : "at least one: take the screen away and hold the board where the "
                                "filter moves",
                    "none"};
    }
    return plane;
}

// Where the line of sight meets U, in U's frame.
glm::dvec2 seen_on_u(const Bundle& bundle, const FilterView& filter) {
    const auto ray = rig::ray_camera(lens_of(bundle), filter.center_px);
    const Rigid& anchor = bundle.u.camera_from_anchor;
    const glm::dmat3 anchor_from_camera = glm::transpose(anchor.rotation);
    const glm::dvec3 origin = anchor_from_camera * -anchor.translation_m;
    const glm::dvec3 along = ray ? anchor_from_camera * *ray : glm::dvec3(0.0);
    if (!(along.z > 0.0))
        throw Error{
            kWhat,
            fmt::format("the filter's center at ({}, {})", filter.position.x, filter.position.y),
            "on a line of sight that meets the filter's plane",
            fmt::format("({:.1f}, {:.1f}) px", filter.center_px.x, filter.center_px.y)};
    return glm::dvec2(origin - along * (origin.z / along.z));
}

// Middle, step along columns and step along rows, by least squares; steps that there are not stay
// 0.
struct Lattice {
    glm::dvec2 middle_m{0.0}, column_m{0.0}, row_m{0.0};
};

Lattice fit_lattice(const Bundle& bundle, const Observations& observations) {
    const bool has_columns = bundle.stage.count.x > 1, has_rows = bundle.stage.count.y > 1;
    const Eigen::Index unknowns = 1 + (has_columns ? 1 : 0) + (has_rows ? 1 : 0);
    const auto count = static_cast<Eigen::Index>(observations.filters.size());
    Eigen::MatrixXd steps = Eigen::MatrixXd::Ones(count, unknowns);
    Eigen::MatrixXd seen(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
        const FilterView& filter = observations.filters[static_cast<std::size_t>(i)];
        const glm::dvec2 step = glm::dvec2(filter.position) - bundle.stage.middle;
        if (has_columns)
            steps(i, 1) = step.x;
        if (has_rows)
            steps(i, unknowns - 1) = step.y;
        const glm::dvec2 at = seen_on_u(bundle, filter);
        seen.row(i) << at.x, at.y;
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(steps);
    if (count < unknowns || factors.rank() < unknowns)
        throw Error{kWhat, "views of the filter",
                    fmt::format("at least {} positions that are not on one line of the grid: its "
                                "corners and its middle are best",
                                unknowns),
                    fmt::format("{} that do not tell its steps", count)};
    const Eigen::MatrixXd found = factors.solve(seen);
    const auto row = [&](Eigen::Index i) { return glm::dvec2(found(i, 0), found(i, 1)); };
    Lattice lattice;
    lattice.middle_m = row(0);
    if (has_columns)
        lattice.column_m = row(1);
    if (has_rows)
        lattice.row_m = row(unknowns - 1);
    return lattice;
}

// +1 where light goes away from the camera: S lies beyond U.
double light_sign(const Bundle& bundle) {
    const glm::dvec3 between_m =
        bundle.s.camera_from_anchor.translation_m - bundle.u.camera_from_anchor.translation_m;
    // The boards' origins are in different places on their planes: measure along S's normal.
    const double apart_m = glm::dot(bundle.s.camera_from_anchor.rotation[2], between_m);
    if (apart_m == 0.0)
        throw Error{kWhat, "boards on the screen and on the filter", "two planes", "one"};
    return apart_m > 0.0 ? 1.0 : -1.0;
}

void put_stage(Bundle& bundle, const Observations& observations) {
    StageGrid& stage = bundle.stage;
    const Lattice lattice = fit_lattice(bundle, observations);
    const bool has_columns = stage.count.x > 1, has_rows = stage.count.y > 1;
    stage.handedness = light_sign(bundle);
    const double area = lattice.column_m.x * lattice.row_m.y - lattice.column_m.y * lattice.row_m.x;
    if (has_columns && has_rows && area * stage.handedness < 0.0)
        throw Error{kWhat, "positions of the filter",
                    "columns that rise with x and rows with y, seen along +z from the lamp",
                    "a mirrored grid: columns or rows count the other way"};
    // Turned back by 90 degrees, the rows' direction is the columns'.
    const glm::dvec2 row_turned_m =
        glm::dvec2(lattice.row_m.y, -lattice.row_m.x) * stage.handedness;
    const glm::dvec2 x_m = has_columns ? lattice.column_m
                           : has_rows  ? row_turned_m
                                       : glm::dvec2(1.0, 0.0);
    const double turn = std::atan2(x_m.y, x_m.x);
    const double row_turn = std::atan2(row_turned_m.y, row_turned_m.x);
    const double skew =
        has_columns && has_rows
            ? std::remainder(turn - row_turn, 2.0 * std::acos(-1.0)) * stage.handedness
            : 0.0;
    stage.numbers = {lattice.middle_m.x,
                     lattice.middle_m.y,
                     turn,
                     has_columns ? glm::length(lattice.column_m) : observations.pitch_m.x,
                     has_rows ? glm::length(lattice.row_m) : observations.pitch_m.y,
                     skew};
}

}  // namespace

void put_on_planes(Bundle& bundle, const Observations& observations) {
    if (observations.grid.x < 1 || observations.grid.y < 1)
        throw Error{kWhat, "the stage's grid", "columns and rows of at least 1",
                    fmt::format("{} x {}", observations.grid.x, observations.grid.y)};
    for (const FilterView& filter : observations.filters) {
        const glm::ivec2 at = filter.position;
        if (at.x < 0 || at.y < 0 || at.x >= observations.grid.x || at.y >= observations.grid.y)
            throw Error{
                kWhat, "views of the filter",
                fmt::format("positions within {} x {}", observations.grid.x, observations.grid.y),
                fmt::format("({}, {})", at.x, at.y)};
    }
    bundle.s = put_boards(bundle, observations, capture::TargetPlane::Screen);
    bundle.u = put_boards(bundle, observations, capture::TargetPlane::Filter);
    bundle.stage.count = observations.grid;
    bundle.stage.middle = 0.5 * glm::dvec2(observations.grid - 1);
    put_stage(bundle, observations);
    bundle.has_planes = true;
}

}  // namespace nearfield::calibrate
