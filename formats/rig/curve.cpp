// SPDX-License-Identifier: Apache-2.0
#include "formats/rig/curve.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace nearfield::rig {

double value_at(const Curve& curve, double x, double without) {
    if (curve.x.empty())
        return without;
    const auto above = std::upper_bound(curve.x.begin(), curve.x.end(), x);
    if (above == curve.x.begin())
        return curve.y.front();
    if (above == curve.x.end())
        return curve.y.back();
    const auto k = static_cast<std::size_t>(std::distance(curve.x.begin(), above));
    const double part = (x - curve.x[k - 1]) / (curve.x[k] - curve.x[k - 1]);
    return curve.y[k - 1] + part * (curve.y[k] - curve.y[k - 1]);
}

double linear_dn(const Radiometry& radiometry, double dn) {
    return value_at(radiometry.linear, dn, dn);
}

}  // namespace nearfield::rig
