// SPDX-License-Identifier: Apache-2.0
/// Boards and where they lie, until captures say them.
#pragma once

#include <glm/glm.hpp>

#include <string>

namespace nearfield::capture {

enum class TargetPlane { Screen, Filter, Free };
enum class BoardKind { Charuco, Chessboard };

struct BoardPlan {
    BoardKind kind = BoardKind::Charuco;
    glm::ivec2 squares{0};
    double square_m = 0;
    double marker_m = 0;
    std::string dictionary;
};

}  // namespace nearfield::capture
