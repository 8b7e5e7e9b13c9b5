// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/board.h"

#include "sample_data/bench/dictionary.h"

#include <algorithm>
#include <cmath>

namespace nearfield::sample_data {
namespace {

constexpr int kMarkerBits = 6;  // 4 x 4 and the border

struct Box {
    glm::dvec2 lower{0.0}, upper{0.0};
};

double area(const Box& box) {
    const glm::dvec2 size = glm::max(box.upper - box.lower, glm::dvec2(0.0));
    return size.x * size.y;
}

Box overlap(const Box& a, const Box& b) {
    return {glm::max(a.lower, b.lower), glm::min(a.upper, b.upper)};
}

// Cells of a grid that a box touches, clamped to count.
struct CellRange {
    glm::ivec2 first{0}, end{0};
};

CellRange cells_of(const Box& box, glm::dvec2 origin, double cell, glm::ivec2 count) {
    const auto index = [&](glm::dvec2 at) {
        return glm::clamp((at - origin) / cell, glm::dvec2(0.0), glm::dvec2(count));
    };
    return {glm::ivec2(glm::floor(index(box.lower))), glm::ivec2(glm::ceil(index(box.upper)))};
}

bool is_black_bit(int marker, int column, int row) {
    if (column == 0 || row == 0 || column == kMarkerBits - 1 || row == kMarkerBits - 1)
        return true;
    const int bit = 15 - (4 * (row - 1) + column - 1);
    return ((kMarkers4x4[static_cast<std::size_t>(marker)] >> bit) & 1) == 0;
}

double black_of_marker(const BenchBoard& board, int marker, glm::dvec2 corner, const Box& box) {
    const double bit_m = board.marker_m / kMarkerBits;
    const CellRange range = cells_of(box, corner, bit_m, glm::ivec2(kMarkerBits));
    double sum = 0.0;
    for (int row = range.first.y; row < range.end.y; ++row) {
        for (int column = range.first.x; column < range.end.x; ++column) {
            const glm::dvec2 lower = corner + glm::dvec2(column, row) * bit_m;
            if (is_black_bit(marker, column, row))
                sum += area(overlap(box, {lower, lower + bit_m}));
        }
    }
    return sum;
}

// The top left square is black; white ones hold markers, numbered row by row.
double black_of_square(const BenchBoard& board, int column, int row, const Box& box) {
    const glm::dvec2 lower = glm::dvec2(column, row) * board.square_m;
    if ((column + row) % 2 == 0)
        return area(overlap(box, {lower, lower + board.square_m}));
    const int before = row * board.squares.x + column;
    const int marker = board.squares.x % 2 == 0 ? before / 2 : (before - 1) / 2;
    const glm::dvec2 corner = lower + 0.5 * (board.square_m - board.marker_m);
    return black_of_marker(board, marker, corner, box);
}

}  // namespace

BoardArea board_area(const BenchBoard& board, glm::dvec2 center_m, glm::dvec2 size_m) {
    const Box box{center_m - 0.5 * size_m, center_m + 0.5 * size_m};
    const glm::dvec2 printed_m = glm::dvec2(board.squares) * board.square_m;
    const double on_board =
        area(overlap(box, {glm::dvec2(-board.margin_m), printed_m + board.margin_m}));
    if (on_board <= 0.0)
        return {};
    double black = 0.0;
    const CellRange range = cells_of(box, glm::dvec2(0.0), board.square_m, board.squares);
    for (int row = range.first.y; row < range.end.y; ++row) {
        for (int column = range.first.x; column < range.end.x; ++column)
            black += black_of_square(board, column, row, box);
    }
    const double whole = area(box);
    return {on_board / whole, (board.white * (on_board - black) + board.black * black) / whole};
}

}  // namespace nearfield::sample_data
