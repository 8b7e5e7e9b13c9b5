// SPDX-License-Identifier: Apache-2.0
/// Finds the corners of a printed board in a picture.
#pragma once

#include "calibrate/observations.h"
#include "formats/capture/frame.h"

#include <string>
#include <vector>

namespace nearfield::calibrate {

/// Inner corners of the board that the frame shows, by id; empty if there is none. A chessboard is
/// found as a whole or not at all, and may be turned by half a turn; of a ChArUco board a part is
/// enough.
///
/// In      mosaic: "mono", "rggb", "grbg", "gbrg" or "bggr" for frames of one channel; frames of
///         three are averaged.
/// Throws  Error where the board cannot be looked for: a dictionary or mosaic that does not exist.
/// Cost    512 x 512: some 10 ms. Thread-safe.
/// Source  first guess of corners: Forstner and Gulch 1987 (OpenCV's cornerSubPix), then
/// corner_fit.h;
///         markers: Garrido-Jurado et al. 2014.
std::vector<Corner> find_board(const capture::Frame& frame,
                               const std::string& mosaic,
                               const capture::BoardPlan& board);

/// Where a corner lies on the board.
glm::dvec2 corner_board_m(const capture::BoardPlan& board, int id);

}  // namespace nearfield::calibrate
