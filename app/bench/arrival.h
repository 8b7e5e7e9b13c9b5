// SPDX-License-Identifier: Apache-2.0
/// What measured points of error and time say: when an estimator arrives at an error, and which
/// points no other beats.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace nearfield::bench {

/// One setting of an estimator: error and time, and its K or Q.
struct CostPoint {
    double error_rel = 0, time_us = 0, size = 0;
};

/// Where a curve of points (in order of rising time) falls to an error and stays there: straight
/// between the two points around it in logarithms of error, time and size. The first point, where
/// that is good enough already. Nothing where the last point is still above.
std::optional<CostPoint> arrival(std::span<const CostPoint> curve, double error_rel);

/// For each point whether no other is at least as good in both error and time, and better in one.
std::vector<bool> pareto_front(std::span<const CostPoint> points);

}  // namespace nearfield::bench
