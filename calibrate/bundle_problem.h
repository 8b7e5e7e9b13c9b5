// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/bundle.h"

#include <ceres/ceres.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace nearfield::calibrate {

/// The bundle adjustment as Ceres takes it. It points into the bundle that it was made of.
struct BundleProblem {
    std::unique_ptr<ceres::LossFunction> loss;
    std::unique_ptr<ceres::Problem> problem;
    std::vector<double*> boards;     // poses that have residuals
    std::vector<std::size_t> views;  // theirs
};

BundleProblem make_problem(Bundle& bundle,
                           const Observations& observations,
                           const Weights& weights,
                           const Choice& choice);

}  // namespace nearfield::calibrate
