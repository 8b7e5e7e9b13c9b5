// SPDX-License-Identifier: Apache-2.0
// A one-dimensional basis function phi(x), quadratic on each of n unit cells; x in pitches from its
// center. No include guard: C++ compiles it for double (profile.cpp), GLSL for float.

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

// The cell that holds x: 0 ... n - 1 within the support. A cell owns its lower edge.
GPU_FN real profile_cell(real x, real cells) {
    return floor(x + REAL(0.5) * cells);
}

// a0 + a1 x + a2 x^2.
GPU_FN real profile_value(real x, real a0, real a1, real a2) {
    return a0 + x * (a1 + x * a2);
}

SHARED_END
