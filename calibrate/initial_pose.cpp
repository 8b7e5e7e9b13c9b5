// SPDX-License-Identifier: Apache-2.0
#include "calibrate/initial_pose.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::calibrate {
namespace {

using Points = Eigen::Matrix2Xd;

// Moves points to mean 0 and mean distance sqrt(2), without which the equations lose digits.
Eigen::Matrix3d normalization(const Points& points) {
    const Eigen::Vector2d mean = points.rowwise().mean();
    const double distance = (points.colwise() - mean).colwise().norm().mean();
    const double scale = std::sqrt(2.0) / std::max(distance, 1e-300);
    Eigen::Matrix3d to;
    to << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
    return to;
}

// to ~ H * from, by the direct linear transformation.
std::optional<Eigen::Matrix3d> homography(const Points& from, const Points& to) {
    if (from.cols() < 4)
        return std::nullopt;
    const Eigen::Matrix3d n_from = normalization(from), n_to = normalization(to);
    Eigen::Matrix<double, 9, 9> sum = Eigen::Matrix<double, 9, 9>::Zero();
    for (Eigen::Index i = 0; i < from.cols(); ++i) {
        const Eigen::Vector3d a = n_from * from.col(i).homogeneous();
        const Eigen::Vector3d b = n_to * to.col(i).homogeneous();
        Eigen::Matrix<double, 2, 9> rows;
        rows << a.transpose(), Eigen::RowVector3d::Zero(), -b.x() * a.transpose(),
            Eigen::RowVector3d::Zero(), a.transpose(), -b.y() * a.transpose();
        sum.noalias() += rows.transpose() * rows;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(sum);
    // A second vanishing eigenvalue: points on a line leave a family of homographies.
    constexpr double kOnALine = 1e-9;
    if (!(eigen.eigenvalues()[1] > kOnALine * eigen.eigenvalues()[8]))
        return std::nullopt;
    const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
    const Eigen::Matrix3d normalized =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
    return n_to.inverse() * normalized * n_from;
}

// The rigid pose nearest to a homography from the board to tangents.
std::optional<Rigid> pose_from(const Eigen::Matrix3d& h) {
    const double length = 0.5 * (h.col(0).norm() + h.col(1).norm());
    if (!(length > 0.0) || h(2, 2) == 0.0)
        return std::nullopt;
    const Eigen::Matrix3d m = h * ((h(2, 2) > 0.0 ? 1.0 : -1.0) / length);
    Eigen::Matrix3d axes;
    axes << m.col(0), m.col(1), m.col(0).cross(m.col(1));
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
    if (!(rotation.determinant() > 0.0) || !m.allFinite())
        return std::nullopt;
    Rigid pose;
    for (int column = 0; column < 3; ++column)
        pose.rotation[column] = {rotation(0, column), rotation(1, column), rotation(2, column)};
    pose.translation_m = {m(0, 2), m(1, 2), m(2, 2)};
    return pose;
}

// Root of the mean square of a board's residuals' lengths.
double rms_of(const rig::Lens& lens, const Rigid& pose, const std::vector<Corner>& corners) {
    double sum = 0.0;
    for (const Corner& corner : corners) {
        const glm::dvec3 p = pose.rotation * glm::dvec3(corner.board_m, 0.0) + pose.translation_m;
        const auto seen = rig::project_px(lens, p);
        if (!seen)
            return std::numeric_limits<double>::infinity();
        const glm::dvec2 residual = corner.at_px - *seen;
        sum += glm::dot(residual, residual);
    }
    return std::sqrt(sum / static_cast<double>(corners.size()));
}

rig::Lens ideal_lens(const Observations& observations, rig::LensModel model, double focal_px) {
    rig::Lens lens;
    lens.model = model;
    lens.size_px = observations.size_px;
    lens.fx_px = lens.fy_px = focal_px;
    lens.cx_px = 0.5 * observations.size_px.x;
    lens.cy_px = 0.5 * observations.size_px.y;
    lens.distortion.assign(static_cast<std::size_t>(rig::distortion_count(model)), 0.0);
    return lens;
}

// Mean over some of the views; those that the lens cannot have seen count as very bad.
double badness_px(const rig::Lens& lens, const Observations& observations) {
    constexpr std::size_t kMostViews = 16;
    const std::size_t count = observations.boards.size();
    const std::size_t every = (count + kMostViews - 1) / kMostViews;
    const double unseen_px = lens.size_px.x;
    double sum = 0.0;
    for (std::size_t view = 0; view < count; view += every) {
        const std::vector<Corner>& corners = observations.boards[view].corners;
        const auto pose = flat_pose(lens, corners);
        sum += pose ? std::min(rms_of(lens, *pose, corners), unseen_px) : unseen_px;
    }
    return sum;
}

}  // namespace

glm::dvec3 angle_axis(const glm::dmat3& rotation) {
    const Eigen::Matrix3d matrix = Eigen::Map<const Eigen::Matrix3d>(&rotation[0][0]);
    const Eigen::AngleAxisd turn(matrix);
    const Eigen::Vector3d axis = turn.angle() * turn.axis();
    return {axis.x(), axis.y(), axis.z()};
}

std::optional<Rigid> flat_pose(const rig::Lens& lens, const std::vector<Corner>& corners) {
    Points board(2, corners.size()), tangents(2, corners.size());
    Eigen::Index count = 0;
    for (const Corner& corner : corners) {
        const auto ray = rig::ray_camera(lens, corner.at_px);
        if (!ray)
            continue;
        board.col(count) << corner.board_m.x, corner.board_m.y;
        tangents.col(count) << ray->x, ray->y;
        ++count;
    }
    const auto h = homography(board.leftCols(count), tangents.leftCols(count));
    return h ? pose_from(*h) : std::nullopt;
}

Bundle first_guess(const Observations& observations, rig::LensModel model) {
    constexpr double kShortest = 0.2, kLongest = 20.0, kStep = 1.1;
    const double width_px = observations.size_px.x;
    rig::Lens best = ideal_lens(observations, model, width_px);
    double best_px = std::numeric_limits<double>::infinity();
    for (double focal = kShortest; focal < kLongest; focal *= kStep) {
        const rig::Lens lens = ideal_lens(observations, model, focal * width_px);
        const double bad_px = badness_px(lens, observations);
        if (bad_px < best_px) {
            best_px = bad_px;
            best = lens;
        }
    }
    Bundle bundle;
    bundle.model = model;
    bundle.size_px = observations.size_px;
    bundle.lens = {best.fx_px, best.fy_px, best.cx_px, best.cy_px};
    bundle.lens.insert(bundle.lens.end(), best.distortion.begin(), best.distortion.end());
    for (const BoardView& view : observations.boards) {
        const auto seen = flat_pose(best, view.corners);
        Rigid pose;
        pose.translation_m.z = 1.0;
        if (seen)
            pose = *seen;
        const glm::dvec3 turn = angle_axis(pose.rotation), shift = pose.translation_m;
        bundle.boards.push_back(
            {capture::TargetPlane::Free, {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z}});
    }
    return bundle;
}

}  // namespace nearfield::calibrate
