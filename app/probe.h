// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"
#include "formats/files/points.h"
#include "formats/model/sampler.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::app {

enum class ProbeMethod {
    Sum,       // exact, in double; with q > 0 on coarser images, in float
    Aperture,  // Monte Carlo over U: an independent check
    Sampler,   // what renderers draw: ProbeSampler::sampler
};

/// A name of --sampler.
struct ProbeSampler {
    ProbeMethod method = ProbeMethod::Sum;
    model::Sampler sampler = model::Sampler::Systematic;  // of ProbeMethod::Sampler
    bool operator==(const ProbeSampler&) const = default;
};

// A sampler's samples are drawn as so many independent sets, whose spread is sigma.
constexpr int kProbeSets = 16;

struct ProbeOptions {
    ProbeSampler sampler;
    std::uint32_t samples = 4096;  // Aperture: of a point and slab; Sampler: of a point, all sets
    int q = 0;                     // Sum: windows of at most so many texels; 0: exact
    std::uint32_t seed = 1;
};

/// Irradiance at one point, the standard deviations of its Y, and the bound of its bias (Sum, q >
/// 0).
struct Probed {
    glm::dvec3 rgb{0.0};
    double sigma_sampling_y = 0, sigma_measured_y = 0, bias_bound_y = 0;
};

/// Every point has random numbers of its own, also where two are equal.
std::vector<Probed> probe(const LightField& lightfield,
                          const PointList& points,
                          const ProbeOptions& options);

/// The points' columns, then e_r_lx,e_g_lx,e_b_lx,e_y_lx,sigma_sampling_y_lx,sigma_measured_y_lx
/// (_w_m2 where the quantity is radiometric); has_bias: and bias_bound_y_lx.
std::string as_csv(Quantity quantity,
                   bool has_bias,
                   const PointList& points,
                   const std::vector<Probed>& results);
/// {"points": [{the same names: numbers}, ...]}
std::string as_json(Quantity quantity,
                    bool has_bias,
                    const PointList& points,
                    const std::vector<Probed>& results);

}  // namespace nearfield::app
