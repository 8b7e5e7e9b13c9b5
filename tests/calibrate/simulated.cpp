// SPDX-License-Identifier: Apache-2.0
#include "tests/calibrate/simulated.h"

#include "tests/support/random.h"

#include <cmath>

namespace nearfield::test {
namespace {

using capture::TargetPlane;

constexpr double kRadPerDeg = 3.14159265358979324 / 180.0;
const glm::dmat3 kFacing(1, 0, 0, 0, -1, 0, 0, 0, -1);  // a camera beyond S looks back at the lamp

enum What : std::uint64_t { kCornerX = 1, kCornerY, kFilterX, kFilterY, kStepX, kStepY };

glm::dvec3 apply(const Rigid& a_from_b, glm::dvec3 p_b) {
    return a_from_b.rotation * p_b + a_from_b.translation_m;
}

glm::dvec2 board_size_m(const SimulatedBench& bench) {
    return glm::dvec2(bench.squares) * bench.square_m;
}

// A board facing the camera with its middle here, in a frame whose z points to the camera.
Rigid facing_board(const SimulatedBench& bench, glm::dvec3 middle_m, glm::dvec3 turn_deg) {
    const glm::dmat3 rotation = kFacing * turn_xyz(turn_deg * kRadPerDeg);
    return {rotation, middle_m - rotation * glm::dvec3(0.5 * board_size_m(bench), 0.0)};
}

void add_view(SimulatedBench& bench, TargetPlane plane, const Rigid& slab_from_board) {
    bench.planes.push_back(plane);
    bench.camera_from_board.push_back(bench.camera_from_slab * slab_from_board);
}

}  // namespace

double normal(std::uint64_t seed, std::uint64_t what, std::uint64_t index) {
    support::Random random{seed * 0x9e3779b97f4a7c15ULL + what * 0xd1b54a32d192ed03ULL +
                           index * 0x8cb92ba72f3d8dd7ULL};
    random.bits();
    const double u = 1.0 - random.uniform(), v = random.uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
}

glm::dmat3 turn_xyz(glm::dvec3 angle_rad) {
    const glm::dvec3 c = glm::cos(angle_rad), s = glm::sin(angle_rad);
    const glm::dmat3 about_x(1, 0, 0, 0, c.x, s.x, 0, -s.x, c.x);
    const glm::dmat3 about_y(c.y, 0, -s.y, 0, 1, 0, s.y, 0, c.y);
    const glm::dmat3 about_z(c.z, s.z, 0, -s.z, c.z, 0, 0, 0, 1);
    return about_z * about_y * about_x;
}

Rigid operator*(const Rigid& a_from_b, const Rigid& b_from_c) {
    return {a_from_b.rotation * b_from_c.rotation, apply(a_from_b, b_from_c.translation_m)};
}

Rigid SimulatedBench::slab_from_u() const {
    return {turn_xyz({u_tilt_rad, 0.0}), {0.0, 0.0, -delta_m}};
}

glm::dvec3 SimulatedBench::center_slab(glm::ivec2 position) const {
    const glm::dvec2 along_m = (glm::dvec2(position) - 0.5 * glm::dvec2(grid - 1)) * pitch_m;
    const glm::dvec2 on_u(along_m.x + std::sin(skew_rad) * along_m.y,
                          std::cos(skew_rad) * along_m.y);
    const auto index = static_cast<std::size_t>(position.y * grid.x + position.x);
    return apply(slab_from_u(), glm::dvec3(on_u + step_error_m[index], 0.0));
}

rig::Lens simulated_lens(rig::LensModel model) {
    rig::Lens lens;
    lens.model = model;
    lens.size_px = {512, 512};
    lens.fx_px = 800;
    lens.fy_px = 800.8;
    lens.cx_px = 258.3;
    lens.cy_px = 254.1;
    lens.distortion = {-0.11, 0.09, 0.0004, -0.0003, 0.02};
    if (model == rig::LensModel::Brown8)
        lens.distortion.insert(lens.distortion.end(), {0.05, -0.02, 0.01});
    if (model == rig::LensModel::Fisheye)
        lens.distortion = {-0.02, 0.01, -0.005, 0.002};
    return lens;
}

SimulatedBench simulated_bench(rig::LensModel model, int free_count, double step_sigma_m) {
    SimulatedBench bench;
    bench.lens = simulated_lens(model);
    const glm::dmat3 slab_from_camera = turn_xyz(glm::dvec3(1.0, -1.5, 0.7) * kRadPerDeg) * kFacing;
    const glm::dvec3 camera_slab(0.02, -0.03, 0.8);
    bench.camera_from_slab = {glm::transpose(slab_from_camera),
                              -(glm::transpose(slab_from_camera) * camera_slab)};
    for (std::uint64_t i = 0; i < 63; ++i)
        bench.step_error_m.push_back(step_sigma_m *
                                     glm::dvec2(normal(7, kStepX, i), normal(7, kStepY, i)));
    add_view(bench, TargetPlane::Screen, facing_board(bench, {0.01, -0.02, 0.0}, {0, 0, 3}));
    add_view(bench, TargetPlane::Screen, facing_board(bench, {-0.03, 0.03, 0.0}, {0, 0, 91}));
    add_view(bench, TargetPlane::Filter,
             bench.slab_from_u() * facing_board(bench, {0.0, 0.0, 0.0}, {0, 0, -2}));
    add_view(bench, TargetPlane::Filter,
             bench.slab_from_u() * facing_board(bench, {0.05, -0.06, 0.0}, {0, 0, 12}));
    for (int i = 0; i < free_count; ++i) {
        // Tilts of 20 to 35 degrees to all sides, middles around the axis, nearer and further.
        const double around = 2.399963 * i;
        const double tilt_deg = 20.0 + 15.0 * ((i * 7) % 10) / 9.0;
        const glm::dvec3 turn_deg(tilt_deg * std::cos(around), tilt_deg * std::sin(around),
                                  40.0 * (i % 5) - 80.0);
        const glm::dvec3 middle_m(0.07 * std::cos(1.3 * around), 0.07 * std::sin(1.3 * around),
                                  0.12 * ((i % 4) - 1));
        add_view(bench, TargetPlane::Free, facing_board(bench, middle_m, turn_deg));
    }
    for (const int row : {0, 3, 6}) {
        for (const int column : {0, 4, 8})
            bench.filter_positions.emplace_back(column, row);
    }
    return bench;
}

calibrate::Observations observed(const SimulatedBench& bench, const SimulatedNoise& noise) {
    calibrate::Observations seen;
    seen.size_px = bench.lens.size_px;
    seen.grid = bench.grid;
    seen.pitch_m = {0.02, 0.0216666666666667};
    const glm::ivec2 inner = bench.squares - 1;
    std::uint64_t drawn = 0;
    for (std::size_t view = 0; view < bench.planes.size(); ++view) {
        calibrate::BoardView board{
            static_cast<int>(view), bench.planes[view], "view " + std::to_string(view), {}};
        for (int id = 0; id < inner.x * inner.y; ++id) {
            const glm::dvec2 at_m = glm::dvec2(id % inner.x + 1, id / inner.x + 1) * bench.square_m;
            const glm::dvec2 relative =
                (at_m - 0.5 * board_size_m(bench)) / (0.5 * glm::dvec2(inner - 1) * bench.square_m);
            const double z = glm::dot(bench.bend_m, relative * relative);
            const auto at_px =
                rig::project_px(bench.lens, apply(bench.camera_from_board[view], {at_m, z}));
            const glm::dvec2 error(normal(noise.seed, kCornerX, drawn),
                                   normal(noise.seed, kCornerY, drawn));
            ++drawn;
            const glm::dvec2 found = at_px.value_or(glm::dvec2(-1.0)) + noise.corner_px * error;
            if (found.x > 1 && found.y > 1 && found.x < 511 && found.y < 511)
                board.corners.push_back({id, at_m, found});
        }
        seen.boards.push_back(board);
    }
    for (std::size_t i = 0; i < bench.filter_positions.size(); ++i) {
        const glm::ivec2 position = bench.filter_positions[i];
        const glm::dvec2 error(normal(noise.seed, kFilterX, i), normal(noise.seed, kFilterY, i));
        const auto at_px =
            rig::project_px(bench.lens, apply(bench.camera_from_slab, bench.center_slab(position)));
        seen.filters.push_back({position,
                                at_px.value_or(glm::dvec2(-1.0)) + noise.filter_px * error,
                                glm::dmat2(noise.filter_px * noise.filter_px)});
    }
    return seen;
}

}  // namespace nearfield::test
