// SPDX-License-Identifier: Apache-2.0
/// The lamp of `bench fit`: the headlight by formula, behind a filter in U, and what it lights.
#pragma once

#include "fit/design.h"
#include "formats/model/luminaire.h"
#include "sample_data/headlight.h"

#include <cstddef>
#include <vector>

namespace nearfield::bench {

/// Light through nodes of the lens to texels of S: f_s(u) of fit/design.h times the node's area,
/// mean over four points of a texel.
struct LampLight {
    Slab planes;  // its S and texels, and delta
    std::vector<glm::dvec2> node_u_m;
    std::vector<float> light_lx;  // [j][i][node]
};

/// Cost    texels x nodes evaluations of the formula, and as many floats. Parallel over rows (TBB).
LampLight lamp_light(const sample_data::Headlight& headlight,
                     double delta_m,
                     glm::ivec2 texels,
                     double node_spacing_m);

/// What the screen sees behind a filter on U: lx, [k][j][i].
std::vector<double> measured_lx(const LampLight& light, const fit::Optics& optics);

/// Receivers facing the lens 1 ... 25 m away, within the beam, and their illuminance by formula;
/// those alone that see at least 1 % of the largest intensity (E d^2). z = 0 is the lens.
struct LitReceivers {
    std::vector<model::Receiver> at_lens;
    std::vector<double> truth_lx;
};

LitReceivers lit_receivers(const sample_data::Headlight& headlight, int count);

}  // namespace nearfield::bench
