// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/places.h"

#include "sample_data/bench/bench_random.h"

#include <glm/gtc/constants.hpp>

#include <cmath>

namespace nearfield::sample_data {
namespace {

constexpr double kRadPerDeg = glm::pi<double>() / 180.0;

Rigid tilted(glm::dvec2 tilt_deg, double z_m) {
    return {turn_xyz(glm::dvec3(tilt_deg * kRadPerDeg, 0.0)), {0.0, 0.0, z_m}};
}

glm::dvec2 stage_position_m(const Bench& bench, int column, int row) {
    const BenchFilter& filter = bench.filter;
    const glm::dvec2 steps = glm::dvec2(column, row) - 0.5 * glm::dvec2(filter.grid - 1);
    const glm::dvec2 along_m = steps * filter.pitch_m * filter.stage_scale;
    const double skew_rad = filter.stage_skew_deg * kRadPerDeg;
    const glm::dvec2 skewed_m(along_m.x + std::sin(skew_rad) * along_m.y,
                              std::cos(skew_rad) * along_m.y);
    const auto index = static_cast<std::uint32_t>(row * filter.grid.x + column);
    return filter.center_m + skewed_m +
           filter.step_sigma_m * normal_pair(bench.seed, Draw::Step, 0, index);
}

Rigid hand_error(const Bench& bench, std::uint32_t view) {
    const glm::dvec2 a = normal_pair(bench.seed, Draw::Hand, view, 0);
    const glm::dvec2 b = normal_pair(bench.seed, Draw::Hand, view, 1);
    const glm::dvec2 c = normal_pair(bench.seed, Draw::Hand, view, 2);
    const BenchTargets& targets = bench.targets;
    return {turn_xyz(glm::dvec3(a, b.x) * targets.hand_sigma_deg * kRadPerDeg),
            glm::dvec3(b.y, c) * targets.hand_sigma_m};
}

// Brown's distortion of a normalized image point.
glm::dvec2 distorted(const BenchCamera& camera, glm::dvec2 p) {
    const double r2 = glm::dot(p, p);
    const double radial = 1.0 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
    return {p.x * radial + 2.0 * camera.p1 * p.x * p.y + camera.p2 * (r2 + 2.0 * p.x * p.x),
            p.y * radial + camera.p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * camera.p2 * p.x * p.y};
}

glm::dmat2 distortion_slope(const BenchCamera& camera, glm::dvec2 p) {
    const double r2 = glm::dot(p, p);
    const double radial = 1.0 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3));
    const double by_r2 = camera.k1 + r2 * (2.0 * camera.k2 + 3.0 * r2 * camera.k3);
    const double cross = 2.0 * by_r2 * p.x * p.y + 2.0 * camera.p1 * p.x + 2.0 * camera.p2 * p.y;
    const double xx =
        radial + 2.0 * by_r2 * p.x * p.x + 2.0 * camera.p1 * p.y + 6.0 * camera.p2 * p.x;
    const double yy =
        radial + 2.0 * by_r2 * p.y * p.y + 6.0 * camera.p1 * p.y + 2.0 * camera.p2 * p.x;
    return {xx, cross, cross, yy};
}

}  // namespace

glm::dmat3 turn_xyz(glm::dvec3 angle_rad) {
    const glm::dvec3 c = glm::cos(angle_rad), s = glm::sin(angle_rad);
    const glm::dmat3 about_x(1, 0, 0, 0, c.x, s.x, 0, -s.x, c.x);
    const glm::dmat3 about_y(c.y, 0, -s.y, 0, 1, 0, s.y, 0, c.y);
    const glm::dmat3 about_z(c.z, s.z, 0, -s.z, c.z, 0, 0, 0, 1);
    return about_z * about_y * about_x;
}

Places make_places(const Bench& bench) {
    Places places;
    places.bench_from_screen = tilted(bench.screen.tilt_deg, 0.0);
    places.bench_from_filter = tilted(bench.filter.tilt_deg, -bench.delta_m);
    places.bench_from_lamp =
        Rigid{glm::dmat3(1.0), {0.0, 0.0, -bench.delta_m}} * bench.lamp.u_from_lamp;
    for (int row = 0; row < bench.filter.grid.y; ++row) {
        for (int column = 0; column < bench.filter.grid.x; ++column)
            places.position_m.push_back(stage_position_m(bench, column, row));
    }
    for (std::size_t view = 0; view < bench.targets.views.size(); ++view) {
        const TargetView& given = bench.targets.views[view];
        const Rigid& pose = given.plane_from_board;
        places.bench_from_board.push_back(
            given.plane == BoardPlane::Screen ? places.bench_from_screen * pose
            : given.plane == BoardPlane::Filter
                ? places.bench_from_filter * pose
                : pose * hand_error(bench, static_cast<std::uint32_t>(view)));
    }
    return places;
}

std::optional<glm::dvec2> project_px(const BenchCamera& camera, glm::dvec3 point_camera) {
    if (point_camera.z <= 0.0)
        return std::nullopt;
    const glm::dvec2 p = distorted(camera, glm::dvec2(point_camera) / point_camera.z);
    return glm::dvec2(camera.fx_px * p.x + camera.cx_px, camera.fy_px * p.y + camera.cy_px);
}

glm::dvec3 ray_camera(const BenchCamera& camera, glm::dvec2 position_px) {
    const glm::dvec2 seen((position_px.x - camera.cx_px) / camera.fx_px,
                          (position_px.y - camera.cy_px) / camera.fy_px);
    glm::dvec2 p = seen;
    constexpr int kMostSteps = 20;
    for (int step = 0; step < kMostSteps; ++step) {
        const glm::dvec2 change =
            glm::inverse(distortion_slope(camera, p)) * (distorted(camera, p) - seen);
        p -= change;
        if (glm::dot(change, change) < 1e-26)
            break;
    }
    return {p, 1.0};
}

double vignetting(const BenchCamera& camera, glm::dvec2 position_px, glm::dvec2 tangent) {
    const double square = 1.0 + glm::dot(tangent, tangent);  // 1 / cos^2
    const glm::dvec2 half_px = 0.5 * glm::dvec2(camera.size_px);
    const glm::dvec2 from_center_px = position_px - half_px;
    const double r2 = glm::dot(from_center_px, from_center_px) / glm::dot(half_px, half_px);
    const glm::dvec3& v = camera.vignetting;
    return std::pow(square, -2.0 * camera.vignetting_cos4) *
           (1.0 + r2 * (v.x + r2 * (v.y + r2 * v.z)));
}

std::optional<double> meet_plane(glm::dvec3 origin, glm::dvec3 direction) {
    if (direction.z == 0.0)
        return std::nullopt;
    return -origin.z / direction.z;
}

}  // namespace nearfield::sample_data
