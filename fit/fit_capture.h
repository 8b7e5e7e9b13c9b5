// SPDX-License-Identifier: Apache-2.0
/// From a capture and its rig to a light field: merge, rectify, solve.
#pragma once

#include "fit/position_light.h"
#include "fit/smoothness.h"
#include "fit/stream.h"
#include "fit/texel_plan.h"
#include "formats/files/lightfield.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::fit {

struct CaptureFitOptions {
    std::string basis = "bspline";  // on the stage's own grid
    Weighting weighting = Weighting::Irradiance;
    std::optional<glm::ivec2>
        texels;                    // none: as fine as the camera sees, at most 512 along an axis
    std::optional<Extent> extent;  // of S; none: what is lit
    double dark_share = 1e-3;      // of the brightest light: what still counts as lit
    std::optional<double> lambda;  // smoothness; none: by cross-validation
    /// What rig and basis get wrong, of a texel's brightest position: added to every measurement's
    /// sigma. Without it dark positions, whose counts are known best, would rule the bright ones,
    /// and the more so the less noise there is. None: as large as the error with which positions
    /// are foretold by the others.
    std::optional<double> model_error_rel;
    int replicates = 0;  // fits of other noise and another calibration; 16 give sigma to 18 %
    std::uint64_t seed = 1;
    bool wants_color = true;  // of a camera with colors; else luminance alone
    double tile_bytes = 256e6;
    std::string spool_folder = ".";  // for the rectified pictures while the fit runs
    std::function<void(double fraction, const std::string& what)> progress;
};

/// Light beside the filter, of a channel: mean over texels, as through a filter of peak 1.
struct BesideFilter {
    double mean_lx = 0, sigma_lx = 0;
    double chi_square = 0;  // of its texels against the parabola that is taken off
};

/// How well a share of the positions foretells the others, with the chosen smoothness: what fewer
/// or more positions are worth.
struct PositionShares {
    std::vector<double> share;       // used in the fits, rising
    std::vector<double> chi_square;  // by held-out measurement
};

/// What was seen on the way; for the report.
struct CaptureFit {
    LightField lightfield;
    FitReport report;
    SmoothnessCurve smoothness;  // empty where lambda was given
    double lambda = 0;
    double model_error_rel = 0;  // given or found
    PositionShares shares;
    int positions = 0, missing_positions = 0;
    int replicates = 0;
    double capture_s = 0;            // from the first frame to the last
    double drift_rel = 0;            // largest, of the lamp; corrected
    double saturated_share = 0;      // of pixels, in all exposures
    double exposure_chi_square = 0;  // of exposures against each other, by degree of freedom
    double outside_share = 0;        // of the light in the picture that falls beside the extent
    std::vector<BesideFilter> beside_filter;  // by channel; empty: not measured, not taken off
    double texel_cells_least = 0;   // texel's least width in cells of the sensor's lattice
    double resolution_m = 0;        // on S, what can be told apart: a texel or a cell, the larger
    std::vector<float> chi_square;  // by texel, [j][i], first channel, by degree of freedom
    double merge_s = 0, solve_s = 0, smoothness_s = 0;
};

/// Throws Error where the rig is another capture's, positions do not suffice, or all is saturated.
/// Memory  a position's frames, a tile, and the light field.
CaptureFit fit_capture(const Measurement& measurement, const CaptureFitOptions& options);

}  // namespace nearfield::fit
