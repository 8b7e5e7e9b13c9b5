// SPDX-License-Identifier: Apache-2.0
/// From where a lamp's shadow maps are rendered, and what they show.
///
/// Source  Lu, Pacanowski, Granier, "Position-dependent importance sampling of light field
///         luminaires", 2015, section 6.2: one map a cell of U, (W + n - 1) x (H + n - 1) of them.
#pragma once

#include "render/lamps.h"
#include "render/options.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace nearfield::render::gpu {

/// A map's pyramid, in the slab's frame: from `eye_m` along tangents (x, y) / z. It holds all
/// receivers beyond S that the cells light through texels with light: a line from u through s is
/// seen from the eye under tangents between (s - eye) / delta, on S, and (s - u) / delta, far away.
struct ShadowView {
    std::size_t slab = 0;
    glm::dvec3 eye_m{0.0};
    glm::dvec2 tangent_min{0.0}, tangent_max{0.0};
};

struct ShadowViews {
    std::vector<ShadowView> views;
    /// [slab][row * (W + n - 1) + column] index of the view; -1: the cell sends no light, and has
    /// none.
    std::vector<std::vector<int>> of_cell;
    int cells_lit = 0, cells_dark = 0;
};

/// Views of all slabs together. With fewer views than cells with light: those where energy times
/// squared distance to the nearest kept is largest, moved to the middle of the energy that is
/// nearest to them. most: of the device. Cost: every coefficient is read once, some ms.
ShadowViews find_shadow_views(std::span<const PlacedSlab> slabs,
                              const ShadowMapOptions& options,
                              int most);

/// A cell of U: n x n of the basis functions cover it.
struct ShadowCell {
    std::size_t slab = 0, index = 0;  // row * (W + n - 1) + column
    double energy = 0;                // of all images over it, a common factor of the slab left out
    glm::dvec2 center_m{0.0};         // of that energy
    glm::dvec2 median_m{0.0};         // on S: mean of its images' medians
    glm::dvec2 u_min_m{0.0}, u_max_m{0.0};
    glm::dvec2 s_min_m{0.0}, s_max_m{0.0};  // of its images' texels with light
};

/// Those of a slab that send light.
std::vector<ShadowCell> lit_cells(const PlacedSlab& slab, std::size_t index);

}  // namespace nearfield::render::gpu
