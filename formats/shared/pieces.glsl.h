// SPDX-License-Identifier: Apache-2.0
// The windowed sum piece by piece: where a receiver's plane cuts a window, or radiance weighting's
// kernel varies over a texel. A piece is the part of a texel in which one axis of a basis function
// is a single polynomial; the integral over a pair of them, one an axis, is
//
//     int int phi_x phi_y max(0, n.(t, -1)) [/ (1 + |t|^2)^2 with radiance weighting] dt_x dt_y
//
// Each piece has a coordinate w of its own, -1 ... 1, so that nothing far from zero is subtracted:
// t, phi and the cosine n.(t, -1) are polynomials in w about the piece's middle.
//
// No include guard, like window.glsl.h. In C++ include formats/model/axis_window.h first.

#include "formats/shared/portable.glsl.h"
#ifndef __cplusplus
#include "formats/shared/window.glsl.h"
#endif

SHARED_BEGIN

// Widest piece, in tangents, over which 3 Gauss nodes integrate 1 / (1 + t^2)^2 to 1e-7: the next
// term of the rule is h^7 f'''''' / 2,016,000 with f'''''' below 5,000.
const real kWidestKernelPiece = REAL(0.2);

// Pieces that one is split into: a bound on the work where a texel spans nearly a half-space.
const real kMostKernelPieces = REAL(1000);

struct PhiPiece {
    real t_middle, t_half;  // t = t_middle + t_half w
    real b0, b1, b2;        // phi = b0 + w (b1 + w b2)
};

// n.(t, -1) = at_middle + along_x w_x + along_y w_y.
struct PairCosine {
    real at_middle, along_x, along_y;
};

// Two numbers; in ascending order where they are ends.
struct Ends {
    real lo, hi;
};

// Where e is in [lo, hi] and phi = a0 + a1 x + a2 x^2, x = (u - center) * inv_pitch.
GPU_FN PhiPiece
phi_piece(AxisView v, real lo, real hi, real a0, real a1, real a2, real center, real inv_pitch) {
    real middle = REAL(0.5) * (lo + hi);
    real e_half = REAL(0.5) * (hi - lo);
    real x = (u_of_e(v, middle) - center) * inv_pitch;
    real x_half = e_half * v.u_scale * inv_pitch;
    PhiPiece piece;
    piece.t_middle = t_of_e(v, middle);
    piece.t_half = e_half * v.t_scale;
    piece.b0 = a0 + x * (a1 + x * a2);
    piece.b1 = (a1 + REAL(2) * a2 * x) * x_half;
    piece.b2 = a2 * x_half * x_half;
    return piece;
}

// How many pieces of at most kWidestKernelPiece a piece so wide in tangents is split into.
GPU_FN int kernel_pieces(real t_width) {
    return max(1, int(ceil(min(t_width / kWidestKernelPiece, kMostKernelPieces))));
}

GPU_FN real phi_of_w(PhiPiece piece, real w) {
    return piece.b0 + w * (piece.b1 + w * piece.b2);
}

GPU_FN PairCosine pair_cosine(PhiPiece x, PhiPiece y, real3 normal, real at_middle) {
    PairCosine cosine;
    cosine.at_middle = at_middle;
    cosine.along_x = normal.x * x.t_half;
    cosine.along_y = normal.y * y.t_half;
    return cosine;
}

// Its least and largest value.
GPU_FN Ends cosine_ends(PairCosine cosine) {
    real reach = abs(cosine.along_x) + abs(cosine.along_y);
    Ends ends;
    ends.lo = cosine.at_middle - reach;
    ends.hi = cosine.at_middle + reach;
    return ends;
}

// What phi_x phi_y is multiplied by, at a point of a pair.
GPU_FN real
pair_kernel(PhiPiece x, PhiPiece y, PairCosine cosine, bool is_radiance, real w_x, real w_y) {
    real value = cosine.at_middle + cosine.along_x * w_x + cosine.along_y * w_y;
    if (!is_radiance)
        return value;
    real t_x = x.t_middle + x.t_half * w_x;
    real t_y = y.t_middle + y.t_half * w_y;
    real r2 = REAL(1) + t_x * t_x + t_y * t_y;
    return value / (r2 * r2);
}

// Gauss-Legendre nodes on [-1, 1] and their weights.
GPU_FN real gauss3_node(int i) {
    return REAL(i - 1) * REAL(0.7745966692414834);
}
GPU_FN real gauss3_weight(int i) {
    return i == 1 ? REAL(0.8888888888888889) : REAL(0.5555555555555556);
}
GPU_FN real gauss4_node(int i) {
    real node = i == 0 || i == 3 ? REAL(0.8611363115940526) : REAL(0.3399810435848563);
    return i < 2 ? -node : node;
}
GPU_FN real gauss4_weight(int i) {
    return i == 0 || i == 3 ? REAL(0.3478548451374538) : REAL(0.6521451548625461);
}

// A pair wholly in front of the receiver, without kernel: products of int phi dw and int w phi dw.
GPU_FN real integrate_moments(PhiPiece x, PhiPiece y, PairCosine cosine) {
    real third = REAL(1.0 / 3.0);
    real x0 = x.b0 + x.b2 * third;
    real y0 = y.b0 + y.b2 * third;
    real sum = cosine.at_middle * x0 * y0 + cosine.along_x * third * x.b1 * y0 +
               cosine.along_y * third * x0 * y.b1;
    return REAL(4) * x.t_half * y.t_half * sum;
}

// The same with radiance weighting: 3 x 3 Gauss nodes.
GPU_FN real integrate_kernel(PhiPiece x, PhiPiece y, PairCosine cosine) {
    real sum = REAL(0);
    for (int i = 0; i < 3; ++i) {
        real w_x = gauss3_node(i);
        real inner = REAL(0);
        for (int j = 0; j < 3; ++j) {
            real w_y = gauss3_node(j);
            inner +=
                gauss3_weight(j) * phi_of_w(y, w_y) * pair_kernel(x, y, cosine, true, w_x, w_y);
        }
        sum += gauss3_weight(i) * phi_of_w(x, w_x) * inner;
    }
    return sum * x.t_half * y.t_half;
}

// The part of axis b, at w_a of the other axis a, that is in front of the receiver. The cosine's
// slope along b is not 0.
GPU_FN Ends part_in_front(real at_middle, real along_a, real along_b, real w_a) {
    real line = clamp(-(at_middle + along_a * w_a) / along_b, REAL(-1), REAL(1));
    Ends part;
    part.lo = along_b > REAL(0) ? line : REAL(-1);
    part.hi = along_b > REAL(0) ? REAL(1) : line;
    return part;
}

// The part of a cut pair with w_a in [lo_a, hi_a], where the line's end on b is linear in w_a: 4 x
// 3 Gauss nodes, exact without kernel (degree 7 and 5 suffice: 6 and 3 occur).
GPU_FN real
integrate_strip(PhiPiece x, PhiPiece y, PairCosine cosine, bool is_radiance, bool a_is_x, Ends a) {
    real along_a = a_is_x ? cosine.along_x : cosine.along_y;
    real along_b = a_is_x ? cosine.along_y : cosine.along_x;
    real half_a = REAL(0.5) * (a.hi - a.lo);
    real sum = REAL(0);
    for (int i = 0; i < 4; ++i) {
        real w_a = REAL(0.5) * (a.lo + a.hi) + half_a * gauss4_node(i);
        Ends b = part_in_front(cosine.at_middle, along_a, along_b, w_a);
        real half_b = REAL(0.5) * (b.hi - b.lo);
        real inner = REAL(0);
        for (int j = 0; j < 3; ++j) {
            real w_b = REAL(0.5) * (b.lo + b.hi) + half_b * gauss3_node(j);
            real w_x = a_is_x ? w_a : w_b;
            real w_y = a_is_x ? w_b : w_a;
            inner += gauss3_weight(j) * phi_of_w(x, w_x) * phi_of_w(y, w_y) *
                     pair_kernel(x, y, cosine, is_radiance, w_x, w_y);
        }
        sum += gauss4_weight(i) * half_b * inner;
    }
    return sum * half_a * x.t_half * y.t_half;
}

// A pair that the receiver's plane cuts. Where the cosine is 0 lies a line that bounds b, the axis
// along which the cosine varies more, as a linear function of a; a is split where the line enters
// and leaves the pair.
GPU_FN real integrate_cut(PhiPiece x, PhiPiece y, PairCosine cosine, bool is_radiance) {
    bool a_is_x = abs(cosine.along_y) >= abs(cosine.along_x);
    real along_a = a_is_x ? cosine.along_x : cosine.along_y;
    real along_b = a_is_x ? cosine.along_y : cosine.along_x;
    if (along_b == REAL(0))
        return REAL(0);
    real enters = REAL(1);
    real leaves = REAL(1);
    if (along_a != REAL(0)) {
        real below = clamp(-(cosine.at_middle - along_b) / along_a, REAL(-1), REAL(1));
        real above = clamp(-(cosine.at_middle + along_b) / along_a, REAL(-1), REAL(1));
        enters = min(below, above);
        leaves = max(below, above);
    }
    real sum = REAL(0);
    for (int k = 0; k < 3; ++k) {
        Ends a;
        a.lo = k == 0 ? REAL(-1) : k == 1 ? enters : leaves;
        a.hi = k == 0 ? enters : k == 1 ? leaves : REAL(1);
        if (a.hi > a.lo)
            sum += integrate_strip(x, y, cosine, is_radiance, a_is_x, a);
    }
    return max(sum, REAL(0));
}

// The part of a pair that is in front of the receiver.
GPU_FN real integrate_pair(PhiPiece x, PhiPiece y, PairCosine cosine, bool is_radiance) {
    Ends ends = cosine_ends(cosine);
    if (ends.hi <= REAL(0))
        return REAL(0);
    if (ends.lo < REAL(0))
        return integrate_cut(x, y, cosine, is_radiance);
    return is_radiance ? integrate_kernel(x, y, cosine) : integrate_moments(x, y, cosine);
}

SHARED_END
