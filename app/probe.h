// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"
#include "formats/files/points.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::app {

enum class Sampler {
    Sum,       // exact
    Aperture,  // Monte Carlo over U: an independent check
};

struct ProbeOptions {
    Sampler sampler = Sampler::Sum;
    std::uint32_t samples = 4096;  // of Aperture, a point and slab
    std::uint32_t seed = 1;
};

/// Irradiance at one point, and the standard deviations of its Y.
struct Probed {
    glm::dvec3 rgb{0.0};
    double sigma_sampling_y = 0, sigma_measured_y = 0;
};

/// Every point has random numbers of its own, also where two are equal.
std::vector<Probed> probe(const LightField& lightfield,
                          const PointList& points,
                          const ProbeOptions& options);

/// The points' columns, then e_r_lx,e_g_lx,e_b_lx,e_y_lx,sigma_sampling_y_lx,sigma_measured_y_lx
/// (_w_m2 where the quantity is radiometric).
std::string as_csv(Quantity quantity, const PointList& points, const std::vector<Probed>& results);
/// {"points": [{the same names: numbers}, ...]}
std::string as_json(Quantity quantity, const PointList& points, const std::vector<Probed>& results);

}  // namespace nearfield::app
