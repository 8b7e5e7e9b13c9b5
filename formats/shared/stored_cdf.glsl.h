// SPDX-License-Identifier: Apache-2.0
// An image's stored CDFs, over columns and over the rows of each, restricted to boxes by an affine
// transformation: how Lu, Pacanowski and Granier draw (eq. (8)).
#ifndef NEARFIELD_STORED_CDF_GLSL_H
#define NEARFIELD_STORED_CDF_GLSL_H

#include "formats/shared/portable.glsl.h"
#include "formats/shared/restricted.glsl.h"

SHARED_BEGIN

// Where a CDF is, as each side keeps it, and its value at the lower edge of texel i.
#ifdef __cplusplus
struct StoredCdf {
    const float* values;
};
inline float cdf_at(StoredCdf cdf, int i) {
    return cdf.values[i];
}
#else
struct StoredCdf {
    int image, column;  // column -1: over columns
};
float cdf_at(StoredCdf cdf, int i);
#endif

// A box' part of a CDF: positions in texels and the CDF at its ends.
struct RestrictedCdf {
    int first, last;
    float x_lo, x_hi;  // ends of the box, in texels
    float c_lo, c_hi;  // the CDF there
};

// One axis of an image that is drawn from as a whole, in units of its texels.
GPU_FN AxisBox whole_axis(int texels) {
    AxisBox box;
    box.first = 0;
    box.last = texels - 1;
    box.e_lo = 0.0f;
    box.e_hi = 0.0f;
    box.first_width = 1.0f;
    box.last_width = texels > 1 ? 1.0f : 0.0f;
    box.texel_width = 1.0f;
    return box;
}

GPU_FN RestrictedCdf restrict_cdf(StoredCdf cdf, AxisBox box) {
    float part_first = min(box.first_width / box.texel_width, 1.0f);
    float part_last = min(box.last_width / box.texel_width, 1.0f);
    float after_first = cdf_at(cdf, box.first + 1);
    float at_last = cdf_at(cdf, box.last);
    RestrictedCdf r;
    r.first = box.first;
    r.last = box.last;
    r.x_lo = float(box.first + 1) - part_first;
    r.c_lo = after_first - part_first * (after_first - cdf_at(cdf, box.first));
    // Of a single texel any stretch as long as the box' is as good: the CDF is linear in it.
    bool is_single = box.first == box.last;
    r.x_hi = float(is_single ? box.first + 1 : box.last) + part_last;
    r.c_hi = is_single ? after_first : at_last + part_last * (cdf_at(cdf, box.last + 1) - at_last);
    return r;
}

// The texel where the CDF passes c_lo + xi (c_hi - c_lo), and where in its part of the box; texel
// -1 where the CDF does not rise: 0/0 as printed. Bisection or the paper's secant on whole texels;
// cut short after max_steps (0: never) the CDF is taken as linear over what is left.
GPU_FN TexelPick
invert_cdf(StoredCdf cdf, RestrictedCdf r, float xi, bool is_secant, int max_steps) {
    TexelPick pick;
    pick.texel = -1;
    pick.fraction = 0.5f;
    pick.steps = 0;
    if (!(r.c_hi > r.c_lo))
        return pick;
    float target = r.c_lo + xi * (r.c_hi - r.c_lo);
    int lo = r.first, hi = r.last + 1;
    float c_lo = r.c_lo, c_hi = r.c_hi;
    while (hi - lo > 1 && (max_steps == 0 || pick.steps < max_steps)) {
        int middle = (lo + hi) / 2;
        if (is_secant) {
            float along = (target - c_lo) / (c_hi - c_lo);
            middle = clamp(lo + int(along * float(hi - lo)), lo + 1, hi - 1);
        }
        pick.steps += 1;
        float value = cdf_at(cdf, middle);
        bool is_below = target < value;
        hi = is_below ? middle : hi;
        c_hi = is_below ? value : c_hi;
        lo = is_below ? lo : middle;
        c_lo = is_below ? c_lo : value;
    }
    float x_lo = max(float(lo), r.x_lo);
    float x_hi = min(float(hi), r.x_hi);
    float x = x_lo + fraction_of(target - c_lo, c_hi - c_lo) * (x_hi - x_lo);
    pick.texel = clamp(int(floor(x)), lo, hi - 1);
    float begin = max(float(pick.texel), r.x_lo);
    float end = min(float(pick.texel + 1), r.x_hi);
    pick.fraction = fraction_of(x - begin, end - begin);
    return pick;
}

GPU_FN float cdf_step(StoredCdf cdf, int i) {
    return cdf_at(cdf, i + 1) - cdf_at(cdf, i);
}

// How far a CDF rises within a box, from its beginning to a fraction of texel i's part of it.
GPU_FN float rise_until(StoredCdf cdf, AxisBox box, int i, float fraction) {
    float of_first = min(box.first_width / box.texel_width, 1.0f) * cdf_step(cdf, box.first);
    if (i == box.first)
        return fraction * of_first;
    float part = i == box.last ? min(box.last_width / box.texel_width, 1.0f) : 1.0f;
    return of_first + (cdf_at(cdf, i) - cdf_at(cdf, box.first + 1)) +
           fraction * part * cdf_step(cdf, i);
}

// Density along one axis: the CDF's step at a texel over the texel's width and the CDF's rise over
// the box.
GPU_FN float cdf_density(StoredCdf cdf, AxisBox box, int texel, float texel_width_m) {
    float rise = rise_until(cdf, box, box.last, 1.0f);
    return rise > 0.0f ? cdf_step(cdf, texel) / (rise * texel_width_m) : 0.0f;
}

SHARED_END

#endif
