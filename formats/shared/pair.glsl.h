// SPDX-License-Identifier: Apache-2.0
// Numbers as a sum of two floats, 48 bits: for differences of summed-area tables, which cancel.
#ifndef NEARFIELD_PAIR_GLSL_H
#define NEARFIELD_PAIR_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

struct Pair {
    float hi, lo;
};

// a - b. The difference of the his is exact: what its float leaves joins the los (Knuth, "The Art
// of Computer Programming", vol. 2, 4.2.2, theorem B).
GPU_FN Pair pair_difference(Pair a, Pair b) {
    PRECISE float rounded = a.hi - b.hi;
    PRECISE float minus_b = rounded - a.hi;
    PRECISE float left = (a.hi - (rounded - minus_b)) - (b.hi + minus_b);
    Pair d;
    d.hi = rounded;
    d.lo = left + (a.lo - b.lo);
    return d;
}

// a - b as a float. Where the his cancel their difference is exact; where they do not, a float is
// as good as the result.
GPU_FN float float_difference(Pair a, Pair b) {
    PRECISE float d = (a.hi - b.hi) + (a.lo - b.lo);
    return d;
}

SHARED_END

#endif
