// SPDX-License-Identifier: Apache-2.0
/// From boards' poses and filter centers to the planes S and U, and to the slab's frame.
#pragma once

#include "calibrate/bundle.h"
#include "calibrate/geometry.h"
#include "calibrate/observations.h"
#include "calibrate/robust_fit.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace nearfield::calibrate {

/// Puts the boards of S and U on planes and the stage's grid on U, from free poses.
/// Throws Error that says which views are missing, or that positions are mirrored.
void put_on_planes(Bundle& bundle, const Observations& observations);

/// The slab as numbers that can be named: parameters, and how they follow from the shared numbers
/// (bundle.h, SharedLayout).
struct PlaneParameters {
    std::vector<std::string> names;
    Eigen::VectorXd values;
    Eigen::MatrixXd by_shared;  // derivatives, [parameter][shared number]
};
PlaneParameters plane_parameters(const Bundle& bundle);

/// The planes as a rig has them, and what it costs to take them for parallel.
PlanesResult planes_result(const Fitted& fitted,
                           const Observations& observations,
                           const Eigen::MatrixXd& shared_covariance);

}  // namespace nearfield::calibrate
