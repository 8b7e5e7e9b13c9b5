// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration_errors.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::bench {
namespace {

// Middles of count x count equal parts of the picture.
std::vector<glm::dvec2> picture_points_px(glm::ivec2 size_px, int count) {
    std::vector<glm::dvec2> points;
    for (int row = 0; row < count; ++row)
        for (int column = 0; column < count; ++column)
            points.push_back((glm::dvec2(column, row) + 0.5) / static_cast<double>(count) *
                             glm::dvec2(size_px));
    return points;
}

struct FarPair {
    glm::dvec2 at_px;       // where the truth sees it
    glm::dvec3 ray_camera;  // in the truth's camera frame
};

std::vector<FarPair> far_pairs(const rig::Lens& truth) {
    std::vector<FarPair> pairs;
    for (const glm::dvec2 at_px : picture_points_px(truth.size_px, 16))
        if (const auto ray = rig::ray_camera(truth, at_px))
            pairs.push_back({at_px, *ray});
    return pairs;
}

glm::dmat3 small_turn(glm::dvec3 turn_rad) {
    const double angle_rad = glm::length(turn_rad);
    return angle_rad > 0.0 ? glm::mat3_cast(glm::angleAxis(angle_rad, turn_rad / angle_rad))
                           : glm::dmat3(1.0);
}

std::optional<glm::dvec2> missed_px(const rig::Lens& lens,
                                    const FarPair& pair,
                                    const glm::dmat3& turn) {
    const auto at_px = rig::project_px(lens, turn * pair.ray_camera);
    return at_px ? std::optional(*at_px - pair.at_px) : std::nullopt;
}

// One step of Gauss and Newton, slopes by central differences.
glm::dmat3 turned_nearer(const rig::Lens& lens,
                         const std::vector<FarPair>& pairs,
                         const glm::dmat3& turn) {
    constexpr double kStep_rad = 1e-5;  // its square, what differences neglect, is below rounding
    glm::dmat3 square(0.0);
    glm::dvec3 slope(0.0);
    for (const FarPair& pair : pairs) {
        const auto missed = missed_px(lens, pair, turn);
        glm::dmat3x2 by_turn(0.0);
        bool is_seen = missed.has_value();
        for (int axis = 0; axis < 3 && is_seen; ++axis) {
            glm::dvec3 by(0.0);
            by[axis] = kStep_rad;
            const auto more = missed_px(lens, pair, small_turn(by) * turn);
            const auto less = missed_px(lens, pair, small_turn(-by) * turn);
            is_seen = more && less;
            if (is_seen)
                by_turn[axis] = (*more - *less) / (2.0 * kStep_rad);
        }
        if (!is_seen)
            continue;
        square += glm::transpose(by_turn) * by_turn;
        slope += glm::transpose(by_turn) * *missed;
    }
    return small_turn(-(glm::inverse(square) * slope)) * turn;
}

double projection_error_px(const rig::Lens& found, const rig::Lens& truth) {
    constexpr int kSteps = 4;
    const std::vector<FarPair> pairs = far_pairs(truth);
    glm::dmat3 turn(1.0);
    for (int step = 0; step < kSteps; ++step)
        turn = turned_nearer(found, pairs, turn);
    double sum = 0.0, count = 0.0;
    for (const FarPair& pair : pairs)
        if (const auto missed = missed_px(found, pair, turn)) {
            sum += glm::dot(*missed, *missed);
            ++count;
        }
    return std::sqrt(sum / std::max(count, 1.0));
}

// The map holds sigmas along an axis: the length's square is twice theirs.
double predicted_projection_px(const calibrate::PictureMap& uncertainty) {
    double sum = 0.0, count = 0.0;
    for (const double sigma_px : uncertainty.value_px)
        if (std::isfinite(sigma_px)) {
            sum += 2.0 * sigma_px * sigma_px;
            ++count;
        }
    return std::sqrt(sum / std::max(count, 1.0));
}

CheckedError checked_rel(const calibrate::Geometry& found, const char* name, double truth) {
    const auto parameter =
        std::find_if(found.parameters.begin(), found.parameters.end(),
                     [&](const rig::Parameter& candidate) { return candidate.name == name; });
    return {(parameter->value - truth) / truth, parameter->sigma / truth};
}

// Where a pixel sees S.
std::optional<glm::dvec3> seen_on_s_slab(const rig::Lens& lens,
                                         const Rigid& camera_from_slab,
                                         glm::dvec2 at_px) {
    const auto ray = rig::ray_camera(lens, at_px);
    if (!ray)
        return std::nullopt;
    const glm::dmat3 slab_from_camera = glm::transpose(camera_from_slab.rotation);
    const glm::dvec3 eye = slab_from_camera * -camera_from_slab.translation_m;
    const glm::dvec3 along = slab_from_camera * *ray;
    return eye - along * (eye.z / along.z);
}

double squared_angle(glm::dvec3 a, glm::dvec3 b) {
    const double sine = glm::length(glm::cross(glm::normalize(a), glm::normalize(b)));
    return sine * sine;  // small: their difference is of the fourth order
}

void add_directions(const calibrate::Geometry& found,
                    const CalibrationTruth& truth,
                    CalibrationErrors& errors) {
    const rig::Planes& planes = found.planes->planes;
    double sum = 0.0, sum_parallel = 0.0, count = 0.0;
    for (const glm::dvec2 at_px : picture_points_px(truth.lens.size_px, 5)) {
        const auto true_s = seen_on_s_slab(truth.lens, truth.camera_from_slab, at_px);
        const auto found_s = seen_on_s_slab(found.lens, planes.camera_from_slab, at_px);
        if (!true_s || !found_s)
            continue;
        for (std::size_t i = 0; i < truth.center_slab.size(); ++i) {
            const glm::dvec3 true_ray = *true_s - truth.center_slab[i];
            const glm::dvec3 parallel(glm::dvec2(planes.position_m[i]), -planes.delta_m);
            sum += squared_angle(*found_s - planes.position_m[i], true_ray);
            sum_parallel += squared_angle(*found_s - parallel, true_ray);
            ++count;
        }
    }
    errors.direction_rad = std::sqrt(sum / std::max(count, 1.0));
    errors.direction_parallel_rad = std::sqrt(sum_parallel / std::max(count, 1.0));
}

}  // namespace

CalibrationErrors errors_of(const calibrate::Geometry& found, const CalibrationTruth& truth) {
    CalibrationErrors errors;
    errors.delta_rel = checked_rel(found, "delta_m", truth.delta_m);
    errors.focal_rel = checked_rel(found, "fx_px", truth.lens.fx_px);
    errors.projection_px = projection_error_px(found.lens, truth.lens);
    errors.projection_predicted_px = predicted_projection_px(found.uncertainty);
    add_directions(found, truth, errors);
    return errors;
}

}  // namespace nearfield::bench
