// SPDX-License-Identifier: Apache-2.0
/// The windowed sum of one image in double: exact, also where the receiver's plane cuts the window.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/axis_window.h"

#undef SHARED_NAMESPACE
#define SHARED_NAMESPACE shared::f64
#include "formats/shared/pieces.glsl.h"
#undef SHARED_NAMESPACE
#define SHARED_NAMESPACE shared

#include <glm/glm.hpp>

#include <vector>

namespace nearfield::model {

using AxisViewD = shared::f64::AxisView;

/// A texel's overlap with one cell of a basis function.
struct Piece {
    int texel;
    shared::f64::PhiPiece phi;
};

/// What one basis function sees along one axis.
struct AxisWindow {
    AxisViewD view;
    double center_m, inv_pitch;
    double t_lo = 0, t_hi = 0;  // tangents between which anything is seen
    TexelRange range;
    std::vector<double> m0, m1;  // per texel of range: int phi dt, int t phi dt
    std::vector<Piece> pieces;
};

/// Builds the window of the basis function centered at center_m, for a view from height (s_of_u
/// gives the window on S) or a far direction.
struct AxisWindows {
    std::vector<AxisWindow> of_basis;  // one a grid column (row)
};
AxisWindows make_windows(const Slab& slab, int axis, double p_m, double height_m);
AxisWindows make_far_windows(const Slab& slab, int axis, double tangent);

/// int int C_m Phi_m max(0, n.(t, -1)) [/ (1 + |t|^2)^2 for radiance weighting] dt of one image,
/// for every channel's coefficients at coeffs[c * channel_stride + j * texels.x + i]. Writes
/// channels values to sums.
void add_image(const Slab& slab,
               const float* coeffs,
               std::size_t channel_stride,
               const AxisWindow& x,
               const AxisWindow& y,
               glm::dvec3 normal,
               double* sums);

/// Weight of texel (i, j) in that sum, for error propagation: irradiance weighting exact but for
/// cut texels.
double texel_weight(
    const Slab& slab, const AxisWindow& x, const AxisWindow& y, glm::dvec3 normal, int i, int j);

/// Least and largest n.(t, -1) over the window.
struct CosineRange {
    double least, largest;
};
CosineRange cosine_range(const AxisWindow& x, const AxisWindow& y, glm::dvec3 normal);

}  // namespace nearfield::model
