// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/filter_profile.h"

namespace nearfield::calibrate {

/// A pixel that may see the filter.
struct FilterSample {
    glm::dvec2 u_m{0};       // where its center's ray meets U
    glm::dvec2 spread_m{0};  // sigma of its footprint along U's axes
    float transmission = 0, sigma = 0;
    int color = 0, view = 0;
};

/// Pixels within `reach_pitches` of each view's first guess of the center.
struct FilterSamples {
    std::vector<FilterSample> samples;
    std::vector<glm::dvec2> guess_u_m;  // [view]
};

/// The point of plane U that is seen at a picture position; none where the ray misses it.
std::optional<glm::dvec2> on_filter_plane(const FilterGeometry& geometry, glm::dvec2 at_px);

/// Throws as filter_profile_of does.
FilterSamples filter_samples_of(std::span<const FilterPicture> pictures,
                                const FilterGeometry& geometry,
                                double reach_pitches,
                                const std::vector<int>& color_of);

}  // namespace nearfield::calibrate
