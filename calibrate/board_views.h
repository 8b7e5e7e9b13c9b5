// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/observations.h"
#include "formats/capture/capture.h"

#include <functional>
#include <string>
#include <vector>

namespace nearfield::calibrate {

/// The board's corners in all of a capture's target views, in the order of views; of a view that
/// shows no board the corners are empty.
///
/// Throws Error where the plan says no board, the capture has no views of it, or they differ in
/// size.
/// Cost   512 x 512: some 10 ms a view. Parallel (TBB) over views; progress is called by one thread
///        at a time.
std::vector<BoardView> board_views(const std::string& folder,
                                   const capture::Capture& capture,
                                   const std::function<void(double fraction)>& progress);

}  // namespace nearfield::calibrate
