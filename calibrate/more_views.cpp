// SPDX-License-Identifier: Apache-2.0
#include "calibrate/more_views.h"

#include <array>
#include <utility>

namespace nearfield::calibrate {
namespace {

using capture::TargetPlane;

CountedTwice with_boards_twice(const Fitted& fitted,
                               const Observations& observations,
                               TargetPlane plane) {
    CountedTwice twice{"", fitted, observations};
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        if (observations.boards[view].plane != plane)
            continue;
        twice.observations.boards.push_back(observations.boards[view]);
        twice.fitted.bundle.boards.push_back(fitted.bundle.boards[view]);
        twice.fitted.weights.is_outlier.push_back(fitted.weights.is_outlier[view]);
    }
    return twice;
}

CountedTwice with_filters_twice(const Fitted& fitted, const Observations& observations) {
    CountedTwice twice{"", fitted, observations};
    auto& filters = twice.observations.filters;
    filters.insert(filters.end(), observations.filters.begin(), observations.filters.end());
    auto& whitening = twice.fitted.weights.filter_whitening;
    whitening.insert(whitening.end(), fitted.weights.filter_whitening.begin(),
                     fitted.weights.filter_whitening.end());
    return twice;
}

}  // namespace

std::vector<CountedTwice> counted_twice(const Fitted& fitted, const Observations& observations) {
    constexpr std::array<std::pair<TargetPlane, const char*>, 3> kPlanes = {
        {{TargetPlane::Screen, "boards on S twice"},
         {TargetPlane::Filter, "boards on U twice"},
         {TargetPlane::Free, "boards by hand twice"}}};
    std::vector<CountedTwice> all;
    for (const auto& [plane, what] : kPlanes) {
        CountedTwice twice = with_boards_twice(fitted, observations, plane);
        twice.what = what;
        if (twice.observations.boards.size() > observations.boards.size())
            all.push_back(std::move(twice));
    }
    if (fitted.bundle.has_planes && !observations.filters.empty()) {
        all.push_back(with_filters_twice(fitted, observations));
        all.back().what = "views of the filter twice";
    }
    return all;
}

}  // namespace nearfield::calibrate
