// SPDX-License-Identifier: Apache-2.0
/// The second half of a capture's fit: from illuminance of texels to coefficients.
#pragma once

#include "fit/rectify_capture.h"

namespace nearfield::fit {

/// Chooses the smoothness unless it is given and solves all texels. `optics` may be others than the
/// rig's: of a bench whose truth is known.
/// Throws and costs as fit_capture, without the frames.
CaptureFit solve_capture(const RectifiedCapture& capture,
                         const Optics& optics,
                         const CaptureFitOptions& options);

}  // namespace nearfield::fit
