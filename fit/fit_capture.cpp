// SPDX-License-Identifier: Apache-2.0
#include "fit/fit_capture.h"

#include "fit/solve_capture.h"

namespace nearfield::fit {

CaptureFit fit_capture(const Measurement& measurement, const CaptureFitOptions& options) {
    const RectifiedCapture capture = rectify_capture(measurement, options);
    return solve_capture(capture, capture.optics, options);
}

}  // namespace nearfield::fit
