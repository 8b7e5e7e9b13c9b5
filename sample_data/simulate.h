// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/headlight.h"
#include "sample_data/project.h"
#include "sample_data/wall.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nearfield::sample_data {

struct SimulateOptions {
    double delta_m =
        3.0;  // distance of the planes; farther resolves the cut-off better, nearer the lens
    glm::ivec2 grid{11, 9};       // basis functions over the lens
    glm::ivec2 texels{256, 128};  // over the beam on S
    std::string basis = "bspline";
    Weighting weighting = Weighting::Irradiance;
    int channels = 3;        // 3 or 1
    std::uint64_t seed = 1;  // the facets' pattern
    int refine = 1;          // multiplies the quadrature's nodes per axis
};

struct SimulatedHeadlight {
    Headlight headlight;
    LightField lightfield;  // with provenance: options, figures
    ProjectFigures figures;
    std::vector<WallError> walls;  // at 1 m and 10 m from the lens
};

/// The headlight of a seed, projected, and what the projection misses.
SimulatedHeadlight simulate_headlight(const SimulateOptions& options,
                                      const std::function<void(double fraction)>& progress);

/// The reference lamp with its provenance.
LightField simulate_reference();

/// The reference lamp's receivers as CSV text with the columns that `probe` reads.
std::string receivers_csv();

}  // namespace nearfield::sample_data
