// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/bench/bench.h"

#include <glm/glm.hpp>

namespace nearfield::sample_data {

/// How much of a small rectangle is board, and how bright that is.
struct BoardArea {
    double covered = 0.0;      // share of the rectangle that lies on the board, 0 ... 1
    double reflectance = 0.0;  // of the rectangle: mean over it, zero beside the board
};

/// Exact for a rectangle along the board's axes: center and size in metres, in `board`.
BoardArea board_area(const BenchBoard& board, glm::dvec2 center_m, glm::dvec2 size_m);

}  // namespace nearfield::sample_data
