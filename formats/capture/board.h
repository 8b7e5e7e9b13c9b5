// SPDX-License-Identifier: Apache-2.0
/// A flat printed board whose corners a camera finds: the target of geometric calibration.
#pragma once

#include "formats/files/json_field.h"

#include <glm/glm.hpp>

#include <string>

namespace nearfield::capture {

/// Chessboard: dark and light squares alone. Charuco: with a marker in every light square, so that
/// a part of the board is enough (Garrido-Jurado et al. 2014; OpenCV's CharucoBoard).
enum class BoardKind { Charuco, Chessboard };

/// Board frame: origin in the outer corner of the first square, x along columns, y along rows, z
/// into the board; a camera sees it from z < 0. Corners that are found are the inner ones,
/// (squares.x - 1) * (squares.y - 1) of them.
struct BoardPlan {
    BoardKind kind = BoardKind::Charuco;
    glm::ivec2 squares{0};   // columns, rows; at least 3
    double square_m = 0;     // a square's side
    double marker_m = 0;     // a marker's side, below square_m; 0 on a chessboard
    std::string dictionary;  // OpenCV's predefined ones: "4x4_50"; empty on a chessboard
};

/// {"kind": "charuco", "squares": [8, 6], "square_m": 0.03, "marker_m": 0.0225,
/// "dictionary": "4x4_50"}; a chessboard has neither of the last two. Throws Error naming the key.
BoardPlan board_from(const JsonField& field);
Json json_of(const BoardPlan& board);

/// The same in short, for options: "charuco:8x6:0.03:0.0225:4x4_50", "chessboard:10x7:0.025".
/// Throws Error naming `where`.
BoardPlan board_from_text(const std::string& text, const std::string& where);

}  // namespace nearfield::capture
