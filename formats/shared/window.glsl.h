// SPDX-License-Identifier: Apache-2.0
// One axis of the windowed sum: how the texels of S, seen from a receiver, fall onto the basis
// functions of U. No include guard: C++ compiles it once for float and once for double
// (axis_window.h), GLSL once for float.
//
// From a receiver p at height Delta above S, the ray through u on U and s on S has the tangent
//
//     t = (u - p) / (delta + Delta) = (s - p) / Delta            (per axis)
//
// and with it both weightings' irradiance is free of prefactors, for every Delta > -delta:
//
//     irradiance weighting   E = delta^2 sum_m int C_m(s) Phi_m(u) max(0, n.(t_x, t_y, -1)) dt
//     radiance weighting     E =         sum_m int C_m(s) Phi_m(u) max(0, n.(t_x, t_y, -1)) / (1 +
//     |t|^2)^2 dt
//
// (du = (delta+Delta)^2 dt in PDIS' U form.) Intervals are measured in a coordinate e, affine in s,
// u and t, chosen so that no difference of large numbers is taken: e = u where Delta >= -delta/2
// (far away all t are nearly equal), e = t nearer to U (there all u of a texel are nearly equal).

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

// Widest texel, in tangents, over which one node at the centroid stands for 1 / (1 + t^2)^2
// (radiance weighting): relative error h^2 / 12 f'' / 2 < 1e-4.
const real kWidestCentroidTexelT = REAL(0.015);

struct AxisView {
    real s_keep, p, s_slope, s_shift;  // e(s) = s_keep * s + (s - p) * s_slope + s_shift
    real cell_origin, cell_scale;      // e(u) = (u - cell_origin) * cell_scale
    real u_origin, u_scale;            // u(e) = u_origin + e * u_scale
    real t_origin, t_scale;            // t(e) = (e - t_origin) * t_scale
};

// Moments of phi over an interval: int phi dt, int t phi dt.
struct CellMoments {
    real m0, m1;
};

// The receiver's coordinate p on this axis; height = Delta > -delta. At Delta = 0 every u sees the
// one texel that holds p: 1e-20 delta stands for it, so that e(s) jumps from far below to far above
// U where s passes p.
GPU_FN AxisView axis_view(real p, real delta, real height) {
    real tiny = delta * REAL(1e-20);
    real h = abs(height) < tiny ? tiny : height;
    real distance = delta + height;
    AxisView v;
    v.p = p;
    v.s_shift = REAL(0);
    if (h >= REAL(-0.5) * delta) {
        v.s_keep = REAL(1);
        v.s_slope = delta / h;
        v.cell_origin = REAL(0);
        v.cell_scale = REAL(1);
        v.u_origin = REAL(0);
        v.u_scale = REAL(1);
        v.t_origin = p;
        v.t_scale = REAL(1) / distance;
    } else {
        v.s_keep = REAL(0);
        v.s_slope = REAL(1) / h;
        v.cell_origin = p;
        v.cell_scale = REAL(1) / distance;
        v.u_origin = p;
        v.u_scale = distance;
        v.t_origin = REAL(0);
        v.t_scale = REAL(1);
    }
    return v;
}

// All rays of one direction: tangent = d_axis / d_z; u = s - delta * tangent. Moments are over u (t
// scale 1).
GPU_FN AxisView axis_view_far(real tangent, real delta) {
    AxisView v;
    v.s_keep = REAL(1);
    v.p = REAL(0);
    v.s_slope = REAL(0);
    v.s_shift = -delta * tangent;
    v.cell_origin = REAL(0);
    v.cell_scale = REAL(1);
    v.u_origin = REAL(0);
    v.u_scale = REAL(1);
    v.t_origin = REAL(0);
    v.t_scale = REAL(1);
    return v;
}

GPU_FN real e_of_s(AxisView v, real s) {
    return v.s_keep * s + (s - v.p) * v.s_slope + v.s_shift;
}

GPU_FN real e_of_u(AxisView v, real u) {
    return (u - v.cell_origin) * v.cell_scale;
}

GPU_FN real u_of_e(AxisView v, real e) {
    return v.u_origin + e * v.u_scale;
}

GPU_FN real t_of_e(AxisView v, real e) {
    return (e - v.t_origin) * v.t_scale;
}

// s where a ray from p (or of a far direction) through u meets S: s = u + (p - u) delta / (delta +
// Delta).
GPU_FN real s_of_u(real u, real p, real delta, real height) {
    return u + (p - u) * (delta / (delta + height));
}

// Texels that a basis function of so many cells shows a receiver along one axis of S.
GPU_FN real window_texels(real cells, real pitch, real texel, real delta, real height) {
    return cells * abs(height) / (delta + height) * pitch / texel;
}

// The finest of levels 0 ... coarsest on which the window spans at most q texels, each level's
// twice as wide as the one's before; the coarsest where none is coarse enough.
GPU_FN int mip_level(real texels_on_finest, real q, int coarsest) {
    real texels = texels_on_finest;
    int level = 0;
    while (level < coarsest && texels > q) {
        texels *= REAL(0.5);
        level += 1;
    }
    return level;
}

// Moments over e in [lo, hi] of phi(x) = a0 + a1 x + a2 x^2, x = (u - center) * inv_pitch. Exact:
// with c the middle and h the width, int phi = h (phi(c) + a2 h^2 / 12) and int (t - t_c) phi =
// phi'(c) h^3 / 12; every term of m0 is as accurate as phi itself, whatever the width.
GPU_FN CellMoments
cell_moments(AxisView v, real lo, real hi, real a0, real a1, real a2, real center, real inv_pitch) {
    real middle = REAL(0.5) * (lo + hi);
    real width = hi - lo;
    real x = (u_of_e(v, middle) - center) * inv_pitch;
    real width_x = width * v.u_scale * inv_pitch;
    real width_t = width * v.t_scale;
    real phi = a0 + x * (a1 + x * a2);
    real slope = a1 + REAL(2) * a2 * x;
    CellMoments m;
    m.m0 = width_t * (phi + a2 * width_x * width_x * REAL(1.0 / 12.0));
    m.m1 = t_of_e(v, middle) * m.m0 + slope * width_x * width_t * width_t * REAL(1.0 / 12.0);
    return m;
}

SHARED_END
