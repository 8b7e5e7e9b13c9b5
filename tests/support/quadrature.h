// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace nearfield::support {

/// Gauss-Legendre nodes and weights on [0, 1].
struct GaussRule {
    std::vector<double> node, weight;
};

/// Roots of the Legendre polynomial of degree `order` by Newton's method from Tricomi's first
/// guess.
inline GaussRule gauss_rule(int order) {
    const double pi = std::acos(-1.0);
    GaussRule rule;
    for (int k = 0; k < order; ++k) {
        double x = std::cos(pi * (k + 0.75) / (order + 0.5));
        double slope = 1.0;
        for (int step = 0; step < 50; ++step) {
            double value = 1.0, before = 0.0;
            for (int d = 1; d <= order; ++d) {
                const double next = ((2 * d - 1) * x * value - (d - 1) * before) / d;
                before = value;
                value = next;
            }
            slope = order * (x * value - before) / (x * x - 1.0);
            const double change = value / slope;
            x -= change;
            if (std::abs(change) < 1e-16)
                break;
        }
        rule.node.push_back(0.5 * (1.0 - x));
        rule.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
    }
    return rule;
}

}  // namespace nearfield::support
