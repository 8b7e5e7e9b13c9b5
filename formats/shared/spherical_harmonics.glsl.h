// SPDX-License-Identifier: Apache-2.0
// Real spherical harmonics up to l = 3, orthonormal over the sphere, and what a cosine makes of
// them.
#ifndef NEARFIELD_SPHERICAL_HARMONICS_GLSL_H
#define NEARFIELD_SPHERICAL_HARMONICS_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

const int kHarmonicsOfIrradiance = 9;  // l <= 2
const int kHarmonics = 16;             // l <= 3

// Function l (l + 1) + m of a direction of unit length.
GPU_FN float harmonic(int index, vec3 d) {
    switch (index) {
        case 0:
            return 0.282094792f;
        case 1:
            return 0.488602512f * d.y;
        case 2:
            return 0.488602512f * d.z;
        case 3:
            return 0.488602512f * d.x;
        case 4:
            return 1.092548431f * d.x * d.y;
        case 5:
            return 1.092548431f * d.y * d.z;
        case 6:
            return 0.315391565f * (3.0f * d.z * d.z - 1.0f);
        case 7:
            return 1.092548431f * d.x * d.z;
        case 8:
            return 0.546274215f * (d.x * d.x - d.y * d.y);
        case 9:
            return 0.590043590f * d.y * (3.0f * d.x * d.x - d.y * d.y);
        case 10:
            return 2.890611442f * d.x * d.y * d.z;
        case 11:
            return 0.457045799f * d.y * (5.0f * d.z * d.z - 1.0f);
        case 12:
            return 0.373176333f * d.z * (5.0f * d.z * d.z - 3.0f);
        case 13:
            return 0.457045799f * d.x * (5.0f * d.z * d.z - 1.0f);
        case 14:
            return 1.445305721f * d.z * (d.x * d.x - d.y * d.y);
        default:
            return 0.590043590f * d.x * (d.x * d.x - 3.0f * d.y * d.y);
    }
}

// What multiplies radiance's coefficients to give irradiance's: the integral of a cosine over its
// hemisphere against Legendre polynomials (Ramamoorthi and Hanrahan, "An efficient representation
// for irradiance environment maps", 2001, eq. (8)): pi, 2 pi/3, pi/4, 0.
GPU_FN float cosine_factor(int index) {
    return index == 0 ? 3.14159265f : index < 4 ? 2.09439510f : index < 9 ? 0.785398163f : 0.0f;
}

// Where harmonics hold a function times a cosine, it is divided out by this at least: they say
// little where it is small, and are not made larger than 5 times.
const float kLeastHiddenCosine = 0.2f;

SHARED_END

#endif
