// SPDX-License-Identifier: Apache-2.0
#include "fit/keep_light.h"

namespace nearfield::fit {

void keep_light(std::span<const double> b,
                std::span<const double> weight,
                Workspace& work,
                TexelFit& fit) {
    double measured = 0, fitted = 0;
    for (std::size_t k = 0; k < b.size(); ++k)
        if (weight[k] > 0.0) {
            measured += b[k];
            fitted += b[k] + work.residual[k];
        }
    if (!(measured > 0.0 && fitted > 0.0))
        return;
    const double factor = measured / fitted;
    for (double& coefficient : fit.coeffs)
        coefficient *= factor;
    for (double& sigma : fit.sigma)
        sigma *= factor;
    fit.chi_square = 0;
    for (std::size_t k = 0; k < b.size(); ++k)
        if (weight[k] > 0.0) {
            work.residual[k] = factor * (b[k] + work.residual[k]) - b[k];
            fit.chi_square += weight[k] * work.residual[k] * work.residual[k];
        }
}

}  // namespace nearfield::fit
