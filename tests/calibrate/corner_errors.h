// SPDX-License-Identifier: Apache-2.0
/// Corners that are found against corners that are known.
#pragma once

#include "tests/calibrate/bench_views.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

namespace nearfield::test {

/// What was found against the truth.
struct CornerErrors {
    int found = 0, visible = 0, views = 0;
    glm::dvec2 sum_px{0.0};
    double square_sum_px2 = 0.0, worst_px = 0.0;

    glm::dvec2 mean_px() const { return sum_px / double(found); }
    double rms_px() const { return std::sqrt(square_sum_px2 / found); }  // of the lengths
    void add(glm::dvec2 error_px) {
        ++found;
        sum_px += error_px;
        square_sum_px2 += glm::dot(error_px, error_px);
        worst_px = std::max(worst_px, glm::length(error_px));
    }
};

inline std::ostream& operator<<(std::ostream& out, const CornerErrors& errors) {
    return out << errors.found << " of " << errors.visible << " corners in " << errors.views
               << " views, RMS " << errors.rms_px() << " px, worst " << errors.worst_px
               << " px, mean " << errors.mean_px().x << " " << errors.mean_px().y << " px";
}

/// The corners found in noisy pictures of a bench's views, [view].
inline std::vector<std::vector<calibrate::Corner>> found_corners(const sample_data::Bench& bench,
                                                                 const std::string& mosaic) {
    const sample_data::Prepared prepared = sample_data::prepare(bench);
    std::vector<std::vector<calibrate::Corner>> corners;
    for (std::size_t view = 0; view < bench.targets.views.size(); ++view)
        corners.push_back(calibrate::find_board(exposed(*prepared, view), mosaic, board_of(bench)));
    return corners;
}

inline CornerErrors errors_of(const sample_data::Bench& bench,
                              const std::vector<std::vector<calibrate::Corner>>& found) {
    const sample_data::Places places = sample_data::make_places(bench);
    const capture::BoardPlan board = board_of(bench);
    CornerErrors errors;
    for (std::size_t view = 0; view < found.size(); ++view) {
        const auto true_px = [&](glm::dvec2 board_m) {
            return seen_px(bench, apply(places.bench_from_board[view], glm::dvec3(board_m, 0.0)));
        };
        const glm::ivec2 inner = board.squares - 1;
        for (int id = 0; id < inner.x * inner.y; ++id) {
            const glm::dvec2 at = true_px(calibrate::corner_board_m(board, id));
            const glm::dvec2 size(bench.camera.size_px);
            errors.visible += at.x > 8 && at.y > 8 && at.x < size.x - 8 && at.y < size.y - 8;
        }
        errors.views += !found[view].empty();
        for (const calibrate::Corner& corner : found[view])
            errors.add(corner.at_px - true_px(corner.board_m));
    }
    return errors;
}

}  // namespace nearfield::test
