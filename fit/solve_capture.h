// SPDX-License-Identifier: Apache-2.0
/// The second half of a capture's fit: from illuminance of texels to coefficients.
#pragma once

#include "fit/rectify_capture.h"
#include "fit/stream.h"

#include <functional>
#include <vector>

namespace nearfield::fit {

/// Where a fit goes, in rows of texels: the fit itself, then replicate by replicate.
struct FitSink {
    WriteTile put;
    std::function<void(int replicate, TileRange rows, const std::vector<float>& coeffs)>
        put_replicate;
};

/// Chooses the smoothness unless it is given and solves all texels. `optics` may be others than the
/// rig's: of a bench whose truth is known. The fit's light field has planes and no coefficients:
/// those are the sink's, with sigma infinite where nothing was seen.
/// Throws and costs as fit_capture, without the frames.
/// Memory  a tile
CaptureFit solve_capture(const RectifiedCapture& capture,
                         const Optics& optics,
                         const CaptureFitOptions& options,
                         const FitSink& sink);

/// The same in memory, with sigma as large as the brightest coefficient where nothing was seen.
CaptureFit solve_capture(const RectifiedCapture& capture,
                         const Optics& optics,
                         const CaptureFitOptions& options);

}  // namespace nearfield::fit
