// SPDX-License-Identifier: Apache-2.0
/// HDR merge: one light from exposures of different lengths, each weighed by what it knows.
///
///     y_i = linear(DN_i) - black - dark t_i = light t_i + noise
///     variance of y_i = read^2 + (light + dark) t_i / gain           DN^2
///
/// with the light of the estimate in it, never the datum's own: weights from noisy data favor data
/// that came out low. The estimate solves sum_i t_i (y_i - light t_i) / variance_i(light) = 0.
/// An exposure whose predicted value comes near saturation is left out although its own datum may
/// lie below: noise would decide who stays. Negative values stay: cutting them off brightens the
/// dark.
/// Source    Granados, Ajdin, Wand, Theobalt, Seidel, Lensch, "Optimal HDR reconstruction with
///           linear digital cameras", 2010; for response curves Mitsunaga and Nayar,
///           "Radiometric self calibration", 1999.
#pragma once

#include "formats/rig/rig.h"

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::fit {

/// A camera's noise and its curve.
struct SensorNoise {
    double gain_e_per_dn = 0;  // of linear DN; 0: photon noise is not known and left out
    double read_noise_dn = 0;  // of one frame, quantization included; of raw DN
    double saturation_dn = 0;  // raw DN from here on are not used
    rig::Curve linear;         // raw to linear DN, rising; empty: linear
};

/// One pixel's own numbers.
struct PixelTraits {
    double black_dn = 0;            // linear DN
    double dark_dn_per_s = 0;       // at the frames' temperature
    double response = 1;            // light is divided by it
    double response_sigma_rel = 0;  // common to all exposures
};

struct PixelExposure {
    double dn = 0;  // raw
    double exposure_s = 0;
};

/// Light that falls on a pixel, DN/s of a pixel of response 1.
struct MergedPixel {
    double light_dn_per_s = 0;
    double variance = 0;    // (DN/s)^2, response's included; infinity: nothing to use
    double chi_square = 0;  // of the exposures against each other
    int used_count = 0;
    bool is_saturated = false;  // even the shortest exposure
};

/// Throws Error if a datum or exposure is not finite or an exposure is not positive.
MergedPixel merge_pixel(std::span<const PixelExposure> exposures,
                        const PixelTraits& pixel,
                        const SensorNoise& noise);

/// One frame of a position: raw values, [row from the top][column].
struct ExposedFrame {
    std::span<const std::uint16_t> values_dn;
    double exposure_s = 0;  // the true one
};

/// A picture in DN/s of pixels of response 1, [row from the top][column].
struct MergedImage {
    glm::ivec2 size_px{0};
    std::vector<float> light_dn_per_s;
    std::vector<float> variance;  // infinity: saturated, bad
    std::size_t saturated_count = 0, bad_count = 0;
    double chi_square_mean = 0;  // by degree of freedom, of pixels with two exposures or more
};

/// All pixels of one position's frames. `dark_factor`: dark current at the frames' temperature over
/// that of the maps.
/// Throws Error if sizes differ from the maps', or there is no frame.
/// Cost    O(pixels x exposures), up to 16 evaluations of each. Parallel over rows (TBB).
MergedImage merge_frames(std::span<const ExposedFrame> frames,
                         const rig::Radiometry& radiometry,
                         const rig::Maps& maps,
                         double dark_factor);

}  // namespace nearfield::fit
