// SPDX-License-Identifier: Apache-2.0
/// The first half of a capture's fit: from frames to illuminance of texels.
#pragma once

#include "fit/fit_capture.h"
#include "fit/measured_texels.h"

namespace nearfield::fit {

constexpr double kMergeShare = 0.7;  // of the progress

struct RectifiedCapture {
    Slab planes;    // without coefficients
    Optics optics;  // the filter as the rig knows it
    MeasuredTexels texels;
    CaptureFit seen;  // what was seen on the way; no light field yet
    double scale_sigma_rel = 0;
    std::vector<Optics> drawn_optics;  // of replicates: as the rig's covariance lets them be
};

/// Throws and costs as fit_capture, without the solution.
RectifiedCapture rectify_capture(const Measurement& measurement, const CaptureFitOptions& options);

}  // namespace nearfield::fit
