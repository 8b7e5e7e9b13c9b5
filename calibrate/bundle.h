// SPDX-License-Identifier: Apache-2.0
/// The bundle adjustment: all unknowns of the geometry, and their best values and covariance.
#pragma once

#include "calibrate/observations.h"
#include "formats/files/lightfield.h"
#include "formats/rig/lens.h"

#include <Eigen/Core>
#include <glm/glm.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace nearfield::calibrate {

/// A board's pose. Free: camera_from_board as angle-axis (rad) and shift (m). On a plane: x and y
/// (m) of its origin and its turn (rad) in the plane's frame.
struct BoardPose {
    capture::TargetPlane plane = capture::TargetPlane::Free;
    std::array<double, 6> numbers{};
};

/// A plane near an anchor, whose z is the normal away from the camera: turns about the anchor's x
/// and y (rad), a shift along its z (m). Places on it stay relative to the anchor's origin.
struct PlaneMove {
    Rigid camera_from_anchor;
    std::array<double, 3> numbers{};
};

/// The stage's grid on U, in U's frame: middle x, y (m), turn of its x axis (rad), pitch x, y (m),
/// skew (rad). Its y axis is x turned by +90 degrees (handedness 1) or -90 (-1), less the skew.
struct StageGrid {
    std::array<double, 6> numbers{};
    double handedness = 1;
    glm::dvec2 middle{0.0};  // (columns - 1, rows - 1) / 2
    glm::ivec2 count{0};
};

/// All unknowns.
struct Bundle {
    rig::LensModel model = rig::LensModel::Brown5;
    glm::ivec2 size_px{0};
    std::vector<double> lens;  // fx fy cx cy, distortion
    std::array<double, 3> bend_m{};
    glm::dvec2 board_middle_m{0.0}, board_half_m{1.0};
    bool has_planes = false;
    PlaneMove s, u;
    StageGrid stage;
    std::vector<BoardPose> boards;  // one for each view
};

/// How much each observation counts.
struct Weights {
    double corner_sigma_px = 1;
    std::vector<std::vector<char>> is_outlier;  // [view][corner]: does not count
    std::vector<glm::dmat2> filter_whitening;   // times residual: independent, of variance 1
};

enum class Loss { Squares, Huber, Cauchy };

/// What is estimated.
struct Choice {
    Loss loss = Loss::Squares;
    double loss_scale = 1;  // of a whitened residual's length
    bool has_square_pixels = false;
    bool is_lens_known = false;
    bool is_board_flat = true;
    double tolerance = 1e-12;  // relative change of the cost at which to stop
};

/// Moves the bundle to the least cost; returns the number of iterations. Deterministic.
int solve(Bundle& bundle,
          const Observations& observations,
          const Weights& weights,
          const Choice& choice);

/// Residuals in pixels, observed minus predicted; none where a point lies behind the camera.
std::optional<glm::dvec2> corner_residual_px(const Bundle& bundle,
                                             std::size_t view,
                                             const Corner& corner);
std::optional<glm::dvec2> filter_residual_px(const Bundle& bundle, const FilterView& filter);

/// Columns: derivatives of the filter center's picture position by x and y of its place on U.
glm::dmat2 filter_px_by_m(const Bundle& bundle, glm::ivec2 position);

/// Where a center of the regular grid lies, in the camera's frame, and a board's pose.
glm::dvec3 filter_center_camera(const Bundle& bundle, glm::ivec2 position);
Rigid camera_from_board(const Bundle& bundle, std::size_t view);
Rigid camera_from_plane(const PlaneMove& plane);
rig::Lens lens_of(const Bundle& bundle);

/// Covariance of what all views share: [lens | bend | S | U | stage], in this order; numbers that
/// are not estimated have zeros. None where the views do not determine everything.
struct SharedCovariance {
    Eigen::MatrixXd matrix;
    std::vector<Eigen::MatrixXd> poses;  // [view]: of BoardPose's numbers; empty where none count
};
std::optional<SharedCovariance> shared_covariance(Bundle& bundle,
                                                  const Observations& observations,
                                                  const Weights& weights,
                                                  const Choice& choice);

/// Offsets of the parts in the shared covariance.
struct SharedLayout {
    int bend, s, u, stage, count;

    explicit SharedLayout(const Bundle& bundle)
        : bend(static_cast<int>(bundle.lens.size())),
          s(bend + 3),
          u(s + (bundle.has_planes ? 3 : 0)),
          stage(u + (bundle.has_planes ? 3 : 0)),
          count(stage + (bundle.has_planes ? 6 : 0)) {}
};

}  // namespace nearfield::calibrate
