// SPDX-License-Identifier: Apache-2.0
#include "calibrate/far_points.h"

#include "calibrate/bundle_residuals.h"

#include <Eigen/Dense>
#include <ceres/jet.h>

#include <array>

namespace nearfield::calibrate {
namespace {

constexpr int kMostLensNumbers = 12;
using FarNumber = ceres::Jet<double, kMostLensNumbers + 3>;

// Picture position of a direction, with derivatives by the lens and by a turn.
std::array<FarNumber, 2> seen_far_px(const Bundle& bundle, const Eigen::Vector3d& ray) {
    std::array<FarNumber, kMostLensNumbers> lens;
    for (std::size_t i = 0; i < bundle.lens.size(); ++i)
        lens[i] = FarNumber(bundle.lens[i], static_cast<int>(i));
    const FarNumber turn[3] = {FarNumber(0.0, kMostLensNumbers),
                               FarNumber(0.0, kMostLensNumbers + 1),
                               FarNumber(0.0, kMostLensNumbers + 2)};
    const Vector3<FarNumber> from = ray.cast<FarNumber>();
    Vector3<FarNumber> turned;
    ceres::AngleAxisRotatePoint(turn, from.data(), turned.data());
    std::array<FarNumber, 2> at_px;
    if (!seen_px(bundle.model, lens.data(), turned, at_px.data()))
        at_px = {FarNumber(0.0), FarNumber(0.0)};
    return at_px;
}

FarPoint far_point(const Bundle& bundle, std::size_t index, const Eigen::Vector3d& ray) {
    const std::array<FarNumber, 2> at_px = seen_far_px(bundle, ray);
    const auto numbers = static_cast<Eigen::Index>(bundle.lens.size());
    FarPoint point;
    point.index = index;
    point.ray = ray;
    point.by_lens.resize(2, numbers);
    for (int axis = 0; axis < 2; ++axis) {
        const auto& slopes = at_px[static_cast<std::size_t>(axis)].v;
        point.by_lens.row(axis) = slopes.head(numbers).transpose();
        point.by_turn.row(axis) = slopes.tail<3>().transpose();
    }
    return point;
}

Eigen::Matrix3d turns_square(const std::vector<FarPoint>& points) {
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
    for (const FarPoint& point : points)
        square += point.by_turn.transpose() * point.by_turn;
    return square;
}

}  // namespace

PictureMap map_points(glm::ivec2 size_px, glm::ivec2 count) {
    PictureMap map;
    map.count = count;
    for (int row = 0; row < count.y; ++row) {
        for (int column = 0; column < count.x; ++column)
            map.at_px.push_back((glm::dvec2(column, row) + 0.5) / glm::dvec2(count) *
                                glm::dvec2(size_px));
    }
    return map;
}

std::vector<FarPoint> far_points(const Bundle& bundle, const PictureMap& map) {
    const rig::Lens lens = lens_of(bundle);
    std::vector<FarPoint> points;
    for (std::size_t i = 0; i < map.at_px.size(); ++i) {
        const auto ray = rig::ray_camera(lens, map.at_px[i]);
        if (ray)
            points.push_back(far_point(bundle, i, eigen_from(*ray)));
    }
    if (points.empty())
        return points;
    Eigen::Matrix<double, 3, Eigen::Dynamic> moved =
        Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, points.front().by_lens.cols());
    for (const FarPoint& point : points)
        moved += point.by_turn.transpose() * point.by_lens;
    const Eigen::Matrix<double, 3, Eigen::Dynamic> implied =
        turns_square(points).ldlt().solve(moved);
    for (FarPoint& point : points)
        point.by_lens -= point.by_turn * implied;
    return points;
}

std::vector<glm::dvec2> turned_differences_px(const Bundle& bundle,
                                              const PictureMap& map,
                                              const std::vector<FarPoint>& points) {
    constexpr int kSteps = 5;  // of Gauss and Newton; lenses of one camera are a small turn apart
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    std::vector<glm::dvec2> difference_px(points.size());
    for (int step = 0; step < kSteps; ++step) {
        std::vector<FarPoint> turned;
        Eigen::Vector3d slope = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Eigen::Vector3d ray = turn * points[i].ray;
            const std::array<FarNumber, 2> at = seen_far_px(bundle, ray);
            difference_px[i] = glm::dvec2(at[0].a, at[1].a) - map.at_px[points[i].index];
            turned.push_back(far_point(bundle, points[i].index, ray));
            slope += turned.back().by_turn.transpose() *
                     Eigen::Vector2d(difference_px[i].x, difference_px[i].y);
        }
        const Eigen::Vector3d change = -turns_square(turned).ldlt().solve(slope);
        Eigen::Matrix3d by;
        ceres::AngleAxisToRotationMatrix(change.data(), by.data());
        turn = by * turn;
    }
    return difference_px;
}

}  // namespace nearfield::calibrate
