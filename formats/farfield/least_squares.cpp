// SPDX-License-Identifier: Apache-2.0
#include "formats/farfield/least_squares.h"

#include <array>

namespace nearfield::farfield {
namespace {

double sum_of_squares(const std::vector<double>& residuals) {
    double sum = 0;
    for (const double residual : residuals)
        sum += residual * residual;
    return sum;
}

}  // namespace

glm::dvec3 least_squares(const std::function<std::vector<double>(const glm::dvec3&)>& residuals,
                         glm::dvec3 start,
                         double step) {
    constexpr int kMostSteps = 20;
    constexpr double kSmallStep = 1e-3;  // of `step`: derivatives are no finer
    glm::dvec3 x = start;
    std::vector<double> r = residuals(x);
    double damping = 1e-3;
    for (int k = 0; k < kMostSteps; ++k) {
        std::array<std::vector<double>, 3> slope;
        for (int a = 0; a < 3; ++a) {
            glm::dvec3 aside(0.0);
            aside[a] = step;
            slope[static_cast<std::size_t>(a)] = residuals(x + aside);
            const std::vector<double> before = residuals(x - aside);
            for (std::size_t i = 0; i < r.size(); ++i)
                slope[static_cast<std::size_t>(a)][i] =
                    (slope[static_cast<std::size_t>(a)][i] - before[i]) / (2 * step);
        }
        glm::dmat3 normal(0.0);
        glm::dvec3 right(0.0);
        for (std::size_t i = 0; i < r.size(); ++i) {
            const glm::dvec3 row(slope[0][i], slope[1][i], slope[2][i]);
            normal += glm::outerProduct(row, row);
            right -= row * r[i];
        }
        const double trace = normal[0][0] + normal[1][1] + normal[2][2];
        if (!(trace > 0))
            return x;
        const glm::dvec3 change = glm::inverse(normal + glm::dmat3(damping * trace / 3)) * right;
        const std::vector<double> there = residuals(x + change);
        if (sum_of_squares(there) < sum_of_squares(r)) {
            x += change;
            r = there;
            damping *= 0.1;
            if (glm::length(change) < kSmallStep * step)
                return x;
        } else if ((damping *= 10) > 1e6) {
            return x;
        }
    }
    return x;
}

}  // namespace nearfield::farfield
