// SPDX-License-Identifier: Apache-2.0
#include "calibrate/robust.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::calibrate {
namespace {

constexpr float kSigmaPerMad = 1.4826F;  // of the normal distribution: 1 / its upper quartile

}  // namespace

float quantile_of(std::span<const float> values, double share) {
    if (values.empty())
        return 0.0F;
    std::vector<float> sorted(values.begin(), values.end());
    const auto place = std::min(
        sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())));
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
}

float median_of(std::span<const float> values) {
    return quantile_of(values, 0.5);
}

float robust_sigma_of(std::span<const float> values) {
    const float middle = median_of(values);
    std::vector<float> distances;
    distances.reserve(values.size());
    for (const float value : values)
        distances.push_back(std::abs(value - middle));
    return kSigmaPerMad * median_of(distances);
}

}  // namespace nearfield::calibrate
