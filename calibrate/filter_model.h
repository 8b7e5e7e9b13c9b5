// SPDX-License-Identifier: Apache-2.0
/// The model of filter_profile.h as a least-squares problem.
#pragma once

#include "calibrate/filter_samples.h"

#include <Eigen/Core>

#include <vector>

namespace nearfield::calibrate {

/// All that is estimated. Centers in pitches along U's axes, so that every number is about 1.
struct FilterParameters {
    std::vector<glm::dvec2> center;  // [view]
    double turn_rad = 0;
    std::vector<double> peak;  // [color]
    std::vector<std::array<double, 3>> cells;

    int count() const;
    int turn_index() const { return 2 * static_cast<int>(center.size()); }
    int peak_index(int color) const { return turn_index() + 1 + color; }
    int cell_index(std::size_t cell) const;
    void add(const Eigen::VectorXd& step);
};

/// Where a sample is, in pitches along the filter's axes, and how wide.
struct OnFilter {
    glm::dvec2 x{0}, spread{0};
};

OnFilter on_filter(const FilterSample& sample,
                   const FilterParameters& parameters,
                   glm::dvec2 pitch_m);

/// phi, blurred by a gaussian.
double blurred_value(const std::vector<std::array<double, 3>>& cells, double x, double spread);

/// Value of row * parameters, for conditions on the profile.
struct Condition {
    Eigen::VectorXd row;
    double wanted = 0;
};

/// phi(0) = 1: what tells peak and profile apart.
Condition peak_condition(const FilterParameters& parameters);
/// The integral of x phi(x) is 0: where the center is. Without it a shift of all centers looks like
/// another profile, since a spline's slope is a sum of the same pieces.
Condition center_condition(const FilterParameters& parameters);
/// What phi jumps by at knot 0 ... n (outside it is zero).
Eigen::VectorXd jump_row(const FilterParameters& parameters, std::size_t knot);

struct NormalEquations {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd gradient;
    double chi2 = 0;             // without conditions
    double conditions_chi2 = 0;  // of them
    std::vector<double> view_chi2;
    std::vector<std::size_t> view_pixels;
};

NormalEquations normal_equations(const std::vector<FilterSample>& samples,
                                 const FilterParameters& parameters,
                                 glm::dvec2 pitch_m,
                                 const std::vector<Condition>& conditions);

}  // namespace nearfield::calibrate
