// SPDX-License-Identifier: Apache-2.0
#include "calibrate/plane_frames.h"

#include "calibrate/slab_frame.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::calibrate {
namespace {

using Number = ceres::Jet<double, kSlabNumbers>;
using Numbers = std::array<Number, kSlabNumbers>;

std::array<double, kSlabNumbers> slab_numbers(const Bundle& bundle) {
    std::array<double, kSlabNumbers> numbers{};
    std::copy(bundle.s.numbers.begin(), bundle.s.numbers.end(), numbers.begin());
    std::copy(bundle.u.numbers.begin(), bundle.u.numbers.end(), numbers.begin() + 3);
    std::copy(bundle.stage.numbers.begin(), bundle.stage.numbers.end(), numbers.begin() + 6);
    return numbers;
}

Numbers as_jets(const std::array<double, kSlabNumbers>& values) {
    Numbers numbers;
    for (int i = 0; i < kSlabNumbers; ++i)
        numbers[static_cast<std::size_t>(i)] = Number(values[static_cast<std::size_t>(i)], i);
    return numbers;
}

// How much the second direction turns towards the first, rad.
Number turn_towards(const Vector3<Number>& to, const Vector3<Number>& moving) {
    Number sum(0.0);
    for (int i = 0; i < 3; ++i)
        sum += Number(to[i].a) * moving[i];
    return sum - sum.a;
}

// Where a center is, its own step error included.
Vector3<Number> center_slab(const Bundle& bundle,
                            const SlabFrame<Number>& frame,
                            const Numbers& numbers,
                            glm::ivec2 position,
                            glm::dvec2 step_error_u_m) {
    Vector3<Number> p_u = grid_point_plane(numbers.data() + 6, bundle.stage.handedness,
                                           glm::dvec2(position) - bundle.stage.middle);
    p_u[0] += step_error_u_m.x;
    p_u[1] += step_error_u_m.y;
    return u_point_slab(bundle, frame, numbers.data(), p_u);
}

// What a center's picture tells of its own error on U: a prior of the stage's noise, the residual.
struct StepError {
    glm::dvec2 mean_m{0.0};
    glm::dmat2 covariance_m2{0.0};
    double grid_share = 1;  // of the grid's error that stays in the position
};

StepError step_error(const Fitted& fitted, const FilterView* filter) {
    const double prior_m2 = fitted.step_sigma_m * fitted.step_sigma_m;
    StepError error{glm::dvec2(0.0), glm::dmat2(prior_m2)};
    if (filter == nullptr || prior_m2 == 0.0)
        return error;
    const auto residual_px = filter_residual_px(fitted.bundle, *filter);
    if (!residual_px)
        return error;
    const glm::dmat2 m_by_px = glm::inverse(filter_px_by_m(fitted.bundle, filter->position));
    const glm::dmat2 gain =
        prior_m2 * glm::inverse(seen_covariance_m2(fitted.bundle, *filter) + glm::dmat2(prior_m2));
    error.mean_m = gain * (m_by_px * *residual_px);
    error.covariance_m2 = prior_m2 * (glm::dmat2(1.0) - gain);
    error.grid_share = 1.0 - 0.5 * (gain[0][0] + gain[1][1]);
    return error;
}

const FilterView* view_of(const Observations& observations, glm::ivec2 position) {
    for (const FilterView& filter : observations.filters) {
        if (filter.position == position)
            return &filter;
    }
    return nullptr;
}

// RMS of a position's sigmas along x and y. Where the picture decides, the grid's error does not
// count.
double position_sigma_m(const Vector3<Number>& position,
                        const Eigen::Matrix<double, kSlabNumbers, kSlabNumbers>& covariance,
                        const StepError& step) {
    double variance = 0.5 * (step.covariance_m2[0][0] + step.covariance_m2[1][1]);
    for (int axis = 0; axis < 2; ++axis)
        variance += 0.5 * step.grid_share * step.grid_share *
                    position[axis].v.dot(covariance * position[axis].v);
    return std::sqrt(std::max(variance, 0.0));
}

// Points of S that the picture's edge and inside see.
std::vector<glm::dvec2> seen_on_s(const Bundle& bundle, const Rigid& camera_from_slab) {
    constexpr int kPoints = 9;
    const rig::Lens lens = lens_of(bundle);
    const glm::dmat3 slab_from_camera = glm::transpose(camera_from_slab.rotation);
    const glm::dvec3 origin = slab_from_camera * -camera_from_slab.translation_m;
    std::vector<glm::dvec2> points;
    for (int row = 0; row < kPoints; ++row) {
        for (int column = 0; column < kPoints; ++column) {
            const glm::dvec2 at_px =
                glm::dvec2(column, row) * glm::dvec2(lens.size_px) / double(kPoints - 1);
            const auto ray = rig::ray_camera(lens, at_px);
            if (!ray)
                continue;
            const glm::dvec3 along = slab_from_camera * *ray;
            const double distance = -origin.z / along.z;
            if (distance > 0.0)
                points.emplace_back(origin + along * distance);
        }
    }
    return points;
}

ParallelCost parallel_cost(const Bundle& bundle, const rig::Planes& planes) {
    ParallelCost cost;
    const std::vector<glm::dvec2> on_s = seen_on_s(bundle, planes.camera_from_slab);
    for (std::size_t i = 0; i < planes.position_m.size(); ++i) {
        const glm::dvec3 center = planes.position_m[i];
        const auto index = static_cast<int>(i);
        const glm::dvec2 steps =
            glm::dvec2(index % planes.grid.x, index / planes.grid.x) - bundle.stage.middle;
        cost.center_m.push_back(glm::length(glm::dvec2(center) - steps * planes.pitch_m));
        cost.center_most_m = std::max(cost.center_most_m, cost.center_m.back());
        for (const glm::dvec2 s : on_s) {
            const glm::dvec3 ray = glm::dvec3(s, 0.0) - center;
            const glm::dvec3 taken(s - glm::dvec2(center), planes.delta_m);
            const glm::dvec2 missed_m = glm::dvec2(ray) * (planes.delta_m / ray.z - 1.0);
            cost.position_m = std::max(cost.position_m, glm::length(missed_m));
            const double sine = glm::length(glm::cross(glm::normalize(ray), glm::normalize(taken)));
            cost.direction_rad = std::max(cost.direction_rad, std::asin(std::min(sine, 1.0)));
        }
    }
    return cost;
}

glm::dvec3 values_of(const Vector3<Number>& v) {
    return {v[0].a, v[1].a, v[2].a};
}

}  // namespace

PlaneParameters plane_parameters(const Bundle& bundle) {
    const Numbers numbers = as_jets(slab_numbers(bundle));
    const SlabFrame<Number> frame = slab_frame(bundle, numbers.data());
    const std::vector<std::pair<const char*, Number>> named = {
        {"delta_m", frame.delta_m},
        {"u_tilt_x_rad", frame.tilt_x_rad},
        {"u_tilt_y_rad", frame.tilt_y_rad},
        {"pitch_x_m", numbers[9]},
        {"pitch_y_m", numbers[10]},
        {"skew_rad", numbers[11]},
        {"slab_x_m", frame.origin[0]},
        {"slab_y_m", frame.origin[1]},
        {"slab_z_m", frame.origin[2]},
        {"slab_turn_x_rad", turn_towards(frame.z, frame.y)},
        {"slab_turn_y_rad", turn_towards(frame.x, frame.z)},
        {"slab_turn_z_rad", turn_towards(frame.y, frame.x)},
    };
    const SharedLayout layout(bundle);
    PlaneParameters parameters;
    const auto count = static_cast<Eigen::Index>(named.size());
    parameters.values.resize(count);
    parameters.by_shared = Eigen::MatrixXd::Zero(count, layout.count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto& [name, number] = named[static_cast<std::size_t>(i)];
        parameters.names.emplace_back(name);
        parameters.values[i] = number.a;
        parameters.by_shared.block<1, kSlabNumbers>(i, layout.s) = number.v.transpose();
    }
    return parameters;
}

PlanesResult planes_result(const Fitted& fitted,
                           const Observations& observations,
                           const Eigen::MatrixXd& shared_covariance) {
    const Bundle& bundle = fitted.bundle;
    const Numbers numbers = as_jets(slab_numbers(bundle));
    const SlabFrame<Number> frame = slab_frame(bundle, numbers.data());
    PlanesResult result;
    rig::Planes& planes = result.planes;
    planes.camera_from_slab.rotation = {values_of(frame.x), values_of(frame.y), values_of(frame.z)};
    planes.camera_from_slab.translation_m = values_of(frame.origin);
    planes.delta_m = frame.delta_m.a;
    planes.u_tilt_rad = {frame.tilt_x_rad.a, frame.tilt_y_rad.a};
    planes.grid = bundle.stage.count;
    planes.pitch_m = {bundle.stage.numbers[3], bundle.stage.numbers[4]};
    planes.skew_rad = bundle.stage.numbers[5];
    result.step_sigma_m = fitted.step_sigma_m;
    result.is_step_sigma_known = can_tell_step_sigma(observations);

    const SharedLayout layout(bundle);
    const Eigen::Matrix<double, kSlabNumbers, kSlabNumbers> covariance =
        shared_covariance.block<kSlabNumbers, kSlabNumbers>(layout.s, layout.s);
    for (int row = 0; row < planes.grid.y; ++row) {
        for (int column = 0; column < planes.grid.x; ++column) {
            const FilterView* seen = view_of(observations, {column, row});
            const StepError step = step_error(fitted, seen);
            const auto regular = center_slab(bundle, frame, numbers, {column, row}, {0.0, 0.0});
            const auto position = center_slab(bundle, frame, numbers, {column, row}, step.mean_m);
            planes.position_m.push_back(values_of(position));
            result.position_sigma_m.push_back(position_sigma_m(position, covariance, step));
            if (seen == nullptr)
                continue;
            result.filters.push_back({seen->position,
                                      filter_residual_px(bundle, *seen).value_or(glm::dvec2(0.0)),
                                      glm::dvec2(values_of(position) - values_of(regular))});
        }
    }
    result.parallel = parallel_cost(bundle, planes);
    return result;
}

}  // namespace nearfield::calibrate
