// SPDX-License-Identifier: Apache-2.0
/// What pictures of boards and of the filter tell about where things are.
///
/// Board frame: origin in the outer corner of the printed area's first square, x along columns, y
/// along rows, z into the board; a camera sees it from z < 0. Picture positions are ours: pixel
/// centers at (0.5, 0.5).
#pragma once

#include "formats/capture/plan.h"

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace nearfield::calibrate {

/// An inner corner of the board: id = row * (columns - 1) + column.
struct Corner {
    int id = 0;
    glm::dvec2 board_m{0.0};
    glm::dvec2 at_px{0.0};
};

/// The corners that one picture shows. Screen: the board lies on S; Filter: on U.
struct BoardView {
    int view = 0;
    capture::TargetPlane plane = capture::TargetPlane::Free;
    std::string name;  // for people: the frame's
    std::vector<Corner> corners;
};

/// The filter's center in the picture, at a position of the stage (column, row).
struct FilterView {
    glm::ivec2 position{0};
    glm::dvec2 center_px{0.0};
    glm::dmat2 covariance_px2{0.0};
};

struct Observations {
    glm::ivec2 size_px{0};  // of every picture
    glm::ivec2 grid{0};     // of the stage: columns, rows
    glm::dvec2 pitch_m{0};  // the stage's nominal step
    std::vector<BoardView> boards;
    std::vector<FilterView> filters;
};

}  // namespace nearfield::calibrate
