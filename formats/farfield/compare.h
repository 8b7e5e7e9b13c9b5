// SPDX-License-Identifier: Apache-2.0
/// How far two lamps differ: flux, intensity, and near the lamp where both are light fields.
#pragma once

#include "formats/farfield/lamp_view.h"
#include "formats/files/lightfield.h"

#include <vector>

namespace nearfield::farfield {

/// Differences B - A relative to the mean of both, where light goes: weighted by flux, so that
/// every figure is of all light alike. At most 2.
struct Differences {
    double mean_rel = 0;                 // signed
    double median_rel = 0, p95_rel = 0;  // of absolute values
    double rms_rel = 0;
    /// Root mean square of the differences over their sigma, and of that sigma, relative; 0 where
    /// neither lamp has one.
    double rms_in_sigmas = 0, sigma_rel = 0;
    double worst = 0;                     // largest absolute difference, in the quantity's unit
    glm::dvec3 worst_direction{0, 0, 1};  // in A's frame
};

struct NearDifferences {
    double distance_m = 0;  // from the center of A's light
    Differences illuminance;
};

struct CompareOptions {
    int directions = 1000;  // drawn from each lamp, 10 ... 1e6
    std::uint32_t seed = 0;
    /// Distances in lamp sizes (lamp_size_m of A).
    std::vector<double> distances_sizes{1, 2, 5, 20};
};

struct Comparison {
    double flux_a = 0, flux_b = 0, flux_a_sigma = 0, flux_b_sigma = 0;
    Differences intensity;
    std::vector<NearDifferences> near_field;  // empty unless both are light fields
};

/// `a_from_b`: p_a = R p_b + t, as align gives it; identity compares the lamps as they are.
/// Illuminance is on surfaces that face the center of A's light. Throws Error for options out of
/// range and for lamps of different quantities.
/// Cost: two far-field intensities and two irradiances with sigma a direction and distance.
Comparison compare(const LampView& a,
                   const LampView& b,
                   const Rigid& a_from_b,
                   const CompareOptions& options = {});

}  // namespace nearfield::farfield
