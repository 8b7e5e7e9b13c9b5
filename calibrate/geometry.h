// SPDX-License-Identifier: Apache-2.0
/// The camera's lens and where the planes S and U are, from pictures of boards and of the filter:
/// one bundle adjustment over everything, with a sigma on everything.
///
/// Residuals are observed minus predicted, in pixels. Sigmas are one standard deviation and follow
/// from the Jacobian and the noise of corners, which is estimated from the residuals.
#pragma once

#include "calibrate/observations.h"
#include "formats/files/lightfield.h"
#include "formats/rig/lens.h"
#include "formats/rig/rig.h"

#include <glm/glm.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::calibrate {

struct GeometryOptions {
    rig::LensModel lens_model = rig::LensModel::Brown5;
    bool with_planes = true;         // false: the lens and the boards' poses alone
    bool is_board_flat = true;       // false: the board's bend is estimated and used
    bool has_square_pixels = false;  // true: fx = fy
    double outlier_sigmas = 5;       // corners further off are named and left out
    double corner_sigma_px = 0;      // noise of a corner along an axis; 0: from the residuals
    double focal_limit_rel = 0.02;   // a larger sigma of fx or fy is refused
    bool with_validation = true;     // two halves, held-out views, the board's bend
    int held_out_folds = 4;          // parts into which views are dealt, each held out once
    glm::ivec2 map_points{16, 12};   // of the maps over the picture: columns, rows
};

struct CornerResidual {
    int id = 0;
    glm::dvec2 board_m{0.0}, at_px{0.0}, residual_px{0.0};
    bool is_outlier = false;
};

struct ViewResult {
    int view = 0;
    std::string name;
    capture::TargetPlane plane = capture::TargetPlane::Free;
    Rigid camera_from_board;
    /// Sigmas of the pose's numbers. Free: angle-axis (rad) and shift (m) of camera_from_board; on
    /// a plane: x, y (m) and turn (rad) in it.
    std::vector<double> pose_sigma;
    double rms_px = 0;  // of the residuals' length, outliers left out
    std::vector<CornerResidual> corners;
};

struct FilterResult {
    glm::ivec2 position{0};
    glm::dvec2 residual_px{0.0};   // from the regular grid: noise of picture and stage
    glm::dvec2 step_error_m{0.0};  // its part that is the stage's, along the slab's x and y
};

/// A corner that does not fit: named, and left out.
struct Outlier {
    int view = 0;
    std::string name;
    int corner = 0;
    double residual_px = 0;
};

/// A view that shows too little of the board to be used.
struct UnusedView {
    int view = 0;
    std::string name, why;
};

/// Something over the picture: [row][column] at points count.x x count.y.
struct PictureMap {
    glm::ivec2 count{0};
    std::vector<glm::dvec2> at_px;
    std::vector<double> value_px;
};

/// Two lenses from two halves of the views: how far apart they project far points, the rotation
/// that fits them best removed, and what their sigmas predict.
struct HalvesCheck {
    PictureMap difference;
    double difference_rms_px = 0, predicted_rms_px = 0;
};

/// Views that the lens was not fitted to, RMS of residuals' length after a fit of their pose.
struct HeldOut {
    int folds = 0;
    double rms_px = 0;
    double fitted_rms_px = 0;  // of views that the same lenses were fitted to
};

/// The board's shape: z = a x^2 + b x y + c y^2 into the board, x and y from its middle in units of
/// half its width and height.
struct BoardBend {
    glm::dvec3 bend_m{0.0}, sigma_m{0.0};  // a, b, c
    double significance_sigma = 0;  // of a, b, c together: sqrt(chi^2) of one number as unlikely
};

/// What it costs to take the planes for parallel and the grid for regular.
struct ParallelCost {
    double position_m = 0;     // largest error of u for rays from S through a filter's center, if
                               // its z is taken for -delta
    double direction_rad = 0;  // largest error of a ray's direction for the same reason
    std::vector<double> center_m;  // [row * columns + column] from a regular grid, along x and y
    double center_most_m = 0;
};

struct PlanesResult {
    rig::Planes planes;
    double step_sigma_m = 0;               // the stage's noise along an axis
    bool is_step_sigma_known = false;      // false: too few positions were seen to tell
    std::vector<double> position_sigma_m;  // [row * columns + column] along an axis of U
    std::vector<FilterResult> filters;
    ParallelCost parallel;
};

/// Sigmas if views of one kind counted twice, [parameter]: what as many again would buy.
struct MoreViews {
    std::string what;
    std::vector<double> sigma;
};

struct Geometry {
    rig::Lens lens;
    std::optional<PlanesResult> planes;
    std::vector<rig::Parameter> parameters;  // lens, then planes
    std::vector<std::string> covariance_of;  // their names, in the matrix' order
    std::vector<double> covariance;          // row by row
    std::vector<MoreViews> more_views;       // with validation
    std::vector<ViewResult> views;
    std::vector<Outlier> outliers;
    std::vector<UnusedView> unused;
    double rms_px = 0;           // of residuals' length, outliers left out
    double corner_sigma_px = 0;  // noise of a corner along an axis
    PictureMap uncertainty;      // sigma of where a far point is seen, by axis, with the rotation
                                 // that the lens' errors imply removed
    std::optional<HalvesCheck> halves;
    std::optional<HeldOut> held_out;
    std::optional<BoardBend> bend;
    int iterations = 0;
    double time_s = 0;
};

/// Throws  Error that says what to do where the views cannot tell: fewer than 3 boards, boards that
///         are all parallel, no board on S or on U, filter centers that do not span the grid,
///         positions beyond the picture.
/// Cost    20 views of 35 corners, with validation: some 0.2 s. 100 views of 500 corners without
///         it: docs/calibration_geometry.md. Parallel (TBB) in the validation alone.
/// Source  Zhang, "A flexible new technique for camera calibration", 2000; Triggs et al., "Bundle
///         adjustment, a modern synthesis", 2000; projection uncertainty after Kogan's mrcal.
Geometry calibrate_geometry(const Observations& observations, const GeometryOptions& options);

}  // namespace nearfield::calibrate
