// SPDX-License-Identifier: Apache-2.0
/// The truth of a virtual bench in the frame of a slab that was measured on it: what ideal frames,
/// an ideal calibration, or both would have led to. Reports alone read it.
#pragma once

#include "fit/stream.h"
#include "formats/rig/rig.h"
#include "sample_data/bench/lens_light.h"
#include "sample_data/headlight.h"

#include <vector>

namespace nearfield::app {

struct LabTruth {
    sample_data::Bench bench;
    sample_data::Places places;
    sample_data::Headlight headlight;
    Rigid bench_from_slab;   // by the camera's true pose and the rig's view of S from it
    double lamp_factor = 1;  // the lamp's light when it was measured over its nominal
};

/// In      time_s: of the first look at the reference, on the bench's clock
/// Throws Error where the bench's lamp is not the headlight by formula.
LabTruth lab_truth(const sample_data::Bench& bench, const rig::Rig& rig, double time_s);

/// The filter as it really is, where it really was; peak 1.
fit::Optics true_optics(const LabTruth& truth);

/// Distance of the filter positions' middle from the real screen.
double true_delta_m(const LabTruth& truth);

/// The lamp's own numbers when it was measured: flux, lm, and illuminance, lx.
double true_flux_lm(const LabTruth& truth);
double true_irradiance_lx(const LabTruth& truth, const model::Receiver& receiver_slab);

/// Noise-free measurements: illuminance, a texel's mean, behind every position, as through a filter
/// of peak 1, of the lamp when it was measured.
struct TrueTexels {
    glm::ivec2 texels{0};
    std::size_t positions = 0;
    std::vector<float> lux;  // [position][j][i]

    fit::TileInput read(fit::TileRange rows) const;
};

/// Cost    seconds; 4 bytes a texel and position, twice while it is made.
TrueTexels true_texels(const LabTruth& truth, const Slab& planes);

/// One channel, as fit_capture would fit these data with these optics and this smoothness.
LightField fit_true_texels(const TrueTexels& texels,
                           const Slab& planes,
                           const fit::Optics& optics,
                           double lambda,
                           double model_error_rel);

}  // namespace nearfield::app
