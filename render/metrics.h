// SPDX-License-Identifier: Apache-2.0
/// How far a picture, or a list of numbers, is from a reference.
#pragma once

#include <cstddef>
#include <span>

namespace nearfield::render {

/// E/E* - 1 over the values whose reference E* exceeds 1e-3 of the largest.
struct RelativeError {
    double rms = 0;  // "relative RMS"
    double p50 = 0, p95 = 0,
           largest = 0;  // of |E/E* - 1|: the smallest value that at least 50 %, 95 % do not exceed
    double bias = 0;     // mean of E/E* - 1
    std::size_t count = 0;  // values compared; all figures are 0 where it is 0
};

/// Throws Error if the two differ in size.
RelativeError relative_error(std::span<const float> values, std::span<const float> reference);

/// The papers' picture metric: both pictures are tone mapped by 1 - exp(-L / mean), mean being the
/// luminance that the reference's frame has on average; the result, taken as linear Rec.709, goes
/// to CIELAB (D65, 2 degrees); the mean of Delta E*ab (1976) over pixels that the reference's light
/// reaches. Encoding in sRGB and decoding cancel out. rgb: [pixel][r, g, b]. Throws Error if the
/// two differ in size.
double lab_difference(std::span<const float> rgb, std::span<const float> reference_rgb);

}  // namespace nearfield::render
