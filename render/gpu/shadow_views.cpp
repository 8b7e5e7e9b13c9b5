// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/shadow_views.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render::gpu {
namespace {

double squared_distance(const ShadowCell& a, const ShadowCell& b) {
    // No cell of another slab can stand for this one: farther than anything within a slab.
    constexpr double kOtherSlab = 1e12;
    if (a.slab != b.slab)
        return kOtherSlab;
    const glm::dvec2 difference = a.center_m - b.center_m;
    return glm::dot(difference, difference);
}

std::size_t nearest(const std::vector<ShadowCell>& kept, const ShadowCell& cell) {
    const auto found =
        std::min_element(kept.begin(), kept.end(), [&](const ShadowCell& a, const ShadowCell& b) {
            return squared_distance(a, cell) < squared_distance(b, cell);
        });
    return static_cast<std::size_t>(found - kept.begin());
}

/// First choices: the brightest cell, then again and again what is worst represented.
std::vector<ShadowCell> choose(const std::vector<ShadowCell>& cells, std::size_t most) {
    std::vector<ShadowCell> kept;
    std::vector<double> distance(cells.size(), 1.0);  // squared, to the nearest that is kept
    while (kept.size() < most) {
        std::size_t worst = 0;
        for (std::size_t k = 1; k < cells.size(); ++k)
            if (cells[k].energy * distance[k] > cells[worst].energy * distance[worst])
                worst = k;
        const bool is_first = kept.empty();
        kept.push_back(cells[worst]);
        for (std::size_t k = 0; k < cells.size(); ++k) {
            const double to_new = squared_distance(kept.back(), cells[k]);
            distance[k] = is_first ? to_new : std::min(distance[k], to_new);
        }
    }
    return kept;
}

/// One cell that stands for several.
ShadowCell merge(const std::vector<ShadowCell>& cells) {
    ShadowCell merged = cells.front();
    merged.energy = 0.0;
    merged.center_m = merged.median_m = glm::dvec2(0.0);
    for (const ShadowCell& cell : cells) {
        merged.energy += cell.energy;
        merged.center_m += cell.energy * cell.center_m;
        merged.median_m += cell.energy * cell.median_m;
        merged.u_min_m = glm::min(merged.u_min_m, cell.u_min_m);
        merged.u_max_m = glm::max(merged.u_max_m, cell.u_max_m);
        merged.s_min_m = glm::min(merged.s_min_m, cell.s_min_m);
        merged.s_max_m = glm::max(merged.s_max_m, cell.s_max_m);
    }
    merged.center_m /= merged.energy;
    merged.median_m /= merged.energy;
    return merged;
}

/// Cells by the kept one that is nearest to them; groups that lost all are left out.
std::vector<std::vector<ShadowCell>> group(const std::vector<ShadowCell>& cells,
                                           const std::vector<ShadowCell>& kept) {
    std::vector<std::vector<ShadowCell>> groups(kept.size());
    for (const ShadowCell& cell : cells)
        groups[nearest(kept, cell)].push_back(cell);
    groups.erase(std::remove_if(groups.begin(), groups.end(),
                                [](const auto& members) { return members.empty(); }),
                 groups.end());
    return groups;
}

/// Weighted k-means (Lloyd 1982).
std::vector<std::vector<ShadowCell>> cluster(const std::vector<ShadowCell>& cells,
                                             std::size_t most) {
    // What more rounds change is small against a cell.
    constexpr int kRounds = 10;
    std::vector<std::vector<ShadowCell>> groups = group(cells, choose(cells, most));
    for (int round = 0; round < kRounds; ++round) {
        std::vector<ShadowCell> kept;
        kept.reserve(groups.size());
        for (const std::vector<ShadowCell>& members : groups)
            kept.push_back(merge(members));
        groups = group(cells, kept);
    }
    return groups;
}

ShadowView view_of(const ShadowCell& cell, double delta_m, ShadowEye eye) {
    ShadowView view;
    view.slab = cell.slab;
    view.tangent_min = (cell.s_min_m - cell.u_max_m) / delta_m;
    view.tangent_max = (cell.s_max_m - cell.u_min_m) / delta_m;
    view.eye_m = glm::dvec3(cell.center_m, -delta_m);
    if (eye == ShadowEye::Paper) {
        view.eye_m = glm::dvec3(cell.median_m, 0.0);
        // From S a line through another of its points is seen under tangents without bound; those
        // are shown that are met delta and farther beyond it.
        view.tangent_min += (cell.s_min_m - cell.median_m) / delta_m;
        view.tangent_max += (cell.s_max_m - cell.median_m) / delta_m;
    }
    return view;
}

}  // namespace

ShadowViews find_shadow_views(std::span<const PlacedSlab> slabs,
                              const ShadowMapOptions& options,
                              int most) {
    ShadowViews result;
    std::vector<ShadowCell> cells;
    std::size_t lit_slabs = 0;
    for (std::size_t s = 0; s < slabs.size(); ++s) {
        const Slab& slab = slabs[s].prepared->slab;
        const glm::ivec2 count = slab.grid + static_cast<int>(slab.profile.cells.size()) - 1;
        result.of_cell.emplace_back(static_cast<std::size_t>(count.x * count.y), -1);
        result.cells_dark += count.x * count.y;
        const std::vector<ShadowCell> lit = lit_cells(slabs[s], s);
        lit_slabs += lit.empty() ? 0 : 1;
        cells.insert(cells.end(), lit.begin(), lit.end());
    }
    result.cells_lit = static_cast<int>(cells.size());
    result.cells_dark -= result.cells_lit;

    const auto wanted =
        static_cast<std::size_t>(options.maps == 0 ? most : std::min(options.maps, most));
    std::vector<std::vector<ShadowCell>> groups;
    if (cells.size() <= wanted)
        for (const ShadowCell& cell : cells)
            groups.push_back({cell});
    else
        groups = cluster(cells, std::max(wanted, lit_slabs));
    for (const std::vector<ShadowCell>& members : groups) {
        for (const ShadowCell& cell : members)
            result.of_cell[cell.slab][cell.index] = static_cast<int>(result.views.size());
        const ShadowCell merged = merge(members);
        result.views.push_back(
            view_of(merged, slabs[merged.slab].prepared->slab.delta_m, options.eye));
    }
    return result;
}

}  // namespace nearfield::render::gpu
