// SPDX-License-Identifier: Apache-2.0
/// Fits that find out by themselves how noisy corners are and which are wrong.
#pragma once

#include "calibrate/bundle.h"
#include "calibrate/observations.h"

#include <cstddef>
#include <vector>

namespace nearfield::calibrate {

struct FitSettings {
    rig::LensModel model = rig::LensModel::Brown5;
    bool has_square_pixels = false;
    bool is_board_flat = true;
    glm::dvec2 board_middle_m{0.0}, board_half_m{1.0};
    double outlier_sigmas = 5;
    double corner_sigma_px = 0;  // 0: estimated
};

struct Fitted {
    Bundle bundle;
    Weights weights;
    Choice choice;
    double step_sigma_m = 0;  // the stage's noise
    int iterations = 0;
};

/// The lens and all boards as free ones: Huber's loss from a guess, Cauchy's, then least squares
/// over what is no outlier, so that covariances are those of least squares.
Fitted fit_lens(const Observations& observations, const FitSettings& settings);

/// Least squares from where the bundle is; outliers, corners' noise and the stage's noise are
/// estimated anew until they stand still.
void settle(Fitted& fitted, const Observations& observations, const FitSettings& settings);

/// Boards' poses alone, the lens (and bend) as given: the boards of other views.
Fitted fit_poses(const Observations& observations,
                 const Bundle& lens_from,
                 const FitSettings& settings);

/// Root of the mean square of residuals' lengths, outliers left out.
double rms_px(const Fitted& fitted, const Observations& observations);

/// True where enough filter centers were seen to tell the stage's noise from its regular grid.
bool can_tell_step_sigma(const Observations& observations);

/// Covariance of a filter center's place on U from its place in the picture, m^2.
glm::dmat2 seen_covariance_m2(const Bundle& bundle, const FilterView& filter);

}  // namespace nearfield::calibrate
