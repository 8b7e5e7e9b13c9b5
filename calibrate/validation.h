// SPDX-License-Identifier: Apache-2.0
/// What tells whether a lens is as good as its sigmas say. A lens that is turned together with
/// everything it was calibrated on projects the same, so that differences of lenses mean something
/// only once the rotation that they imply is removed (after Kogan's mrcal, "Noise model and
/// uncertainty quantification").
#pragma once

#include "calibrate/geometry.h"
#include "calibrate/robust_fit.h"

#include <Eigen/Core>

#include <optional>

namespace nearfield::calibrate {

/// Sigma (RMS of both axes) of where points at infinity are seen, the implied rotation removed;
/// NaN where the lens sees nothing. lens_covariance in the order of Bundle::lens.
PictureMap uncertainty_map(const Bundle& bundle,
                           const Eigen::MatrixXd& lens_covariance,
                           glm::ivec2 points);

/// Views 0, 2, 4, ... against 1, 3, 5, ...; none with fewer than three views in a half.
std::optional<HalvesCheck> check_halves(const Observations& observations,
                                        const FitSettings& settings,
                                        glm::ivec2 points);

/// Every view is held out once; none with fewer than three others.
std::optional<HeldOut> check_held_out(const Observations& observations,
                                      const FitSettings& settings,
                                      int folds);

/// The board's bend, estimated together with all else; none where the views cannot tell.
std::optional<BoardBend> board_bend(Fitted fitted,
                                    const Observations& observations,
                                    FitSettings settings);

}  // namespace nearfield::calibrate
