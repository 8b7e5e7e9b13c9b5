// SPDX-License-Identifier: Apache-2.0
#include "app/bench/arrival.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::bench {
namespace {

double geometric_mix(double a, double b, double share) {
    if (!(a > 0.0 && b > 0.0))
        return share < 1.0 ? a : b;  // the exact sum: error 0, or size 0, which has no logarithm
    return std::exp(std::log(a) + share * (std::log(b) - std::log(a)));
}

bool beats(const CostPoint& a, const CostPoint& b) {
    return a.error_rel <= b.error_rel && a.time_us <= b.time_us &&
           (a.error_rel < b.error_rel || a.time_us < b.time_us);
}

}  // namespace

std::optional<CostPoint> arrival(std::span<const CostPoint> curve, double error_rel) {
    std::size_t first = curve.size();
    while (first > 0 && curve[first - 1].error_rel <= error_rel)
        --first;
    if (first == curve.size())
        return std::nullopt;
    if (first == 0)
        return curve.front();
    const CostPoint &above = curve[first - 1], &below = curve[first];
    if (!(below.error_rel > 0.0))
        return below;
    const double share =
        std::log(above.error_rel / error_rel) / std::log(above.error_rel / below.error_rel);
    return CostPoint{error_rel, geometric_mix(above.time_us, below.time_us, share),
                     geometric_mix(above.size, below.size, share)};
}

std::vector<bool> pareto_front(std::span<const CostPoint> points) {
    std::vector<bool> is_on_front;
    for (const CostPoint& point : points)
        is_on_front.push_back(
            std::none_of(points.begin(), points.end(),
                         [&](const CostPoint& other) { return beats(other, point); }));
    return is_on_front;
}

}  // namespace nearfield::bench
