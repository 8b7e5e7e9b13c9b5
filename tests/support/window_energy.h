// SPDX-License-Identifier: Apache-2.0
/// What samplers draw from, by sums over texels in double: without tables, tangents or any of the
/// model's code. An interval of U is seen through one texel; s and u are related as the ray through
/// p relates them, s = u + (p - u) delta / (delta + Delta).
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/prepared.h"

#include <glm/glm.hpp>

#include <vector>

namespace nearfield::support {

/// A stretch of U along an axis that lies within one cell of U and is seen through one texel.
struct AxisPart {
    double u_lo_m = 0, u_hi_m = 0;
    int texel = 0;
    int cell = 0;  // of U: basis function k covers cells k ... k + n - 1; outside of the grid's too

    double width_u_m() const { return u_hi_m - u_lo_m; }
    double middle_u_m() const { return 0.5 * (u_lo_m + u_hi_m); }
};

/// All of them along an axis, for everything of U that is seen through S.
std::vector<AxisPart> axis_parts(const Slab& slab, const model::ReceiverF& receiver, int axis);

/// The integral over the support of Phi_m, or over one of its cells times Phi's mean there, of C_m
/// in luminance, dt, times delta^2 with irradiance weighting.
double support_energy(const Slab& slab, const model::ReceiverF& receiver, int image);
double cell_energy(const Slab& slab, const model::ReceiverF& receiver, int image, glm::ivec2 cell);

}  // namespace nearfield::support
