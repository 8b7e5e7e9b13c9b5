// SPDX-License-Identifier: Apache-2.0
/// One image restricted to a box, as samplers draw from it; and the light of a point that was
/// drawn. Energies here are int C_m dt times the area of a texel, as summed-area tables give them.
#pragma once

#include "formats/model/sampler.h"
#include "formats/shared/light_kernel.glsl.h"

#include <glm/glm.hpp>

#include <optional>

namespace nearfield::model {

/// A texel and a place in the part of it that a box holds, in [0, 1)^2 along i and j.
struct TexelPoint {
    glm::ivec2 texel{0};
    glm::vec2 fraction{0.0F};
};

/// An image's box, with the energies of its blocks. Tables resolve boxes that hold 1e-9 of their
/// image's light; of darker ones the texels are summed (columns in SamplingView::columns).
struct Window {
    int image = 0;
    shared::AxisBox x{}, y{};
    shared::AreaTable table{};
    shared::BoxCorners corners{};
    shared::BoxBlocks blocks{};
    bool is_by_texels = false;
    float energy = 0.0F;
};

/// Whether an image is lit anywhere in texels lo ... hi (inclusive, along x and y) or near them.
bool meets_light(const SamplingSlab& slab, int image, glm::ivec2 lo, glm::ivec2 hi);

shared::AreaTable area_table(const SamplingSlab& slab, TablePrecision precision, int image);
/// Floats that a number of corners takes.
std::uint64_t corner_reads(const shared::AreaTable& table, int corners);

/// The energy alone. 0 where no lit texel of the image is in the box.
float window_energy(const SamplingSlab& slab,
                    SamplingView& view,
                    TablePrecision precision,
                    int image,
                    const shared::AxisBox& x,
                    const shared::AxisBox& y);

/// An energy that was found by tables, or where those cannot resolve it the sum of texels. Fills
/// view.columns in that case.
float resolved_energy(const SamplingSlab& slab,
                      SamplingView& view,
                      TablePrecision precision,
                      int image,
                      const shared::AxisBox& x,
                      const shared::AxisBox& y,
                      float found);

/// Fills view.energy for Cells: every image's cells, each by its mean of Phi. view.x and y hold U's
/// cells.
void weigh_cells(const SamplingSlab& slab, TablePrecision precision, SamplingView& view);

Window open_window(const SamplingSlab& slab,
                   SamplingView& view,
                   TablePrecision precision,
                   int image,
                   const shared::AxisBox& x,
                   const shared::AxisBox& y);

/// The point at which the restricted distribution takes the values `coordinates`, both in [0, 1)
/// (restricted.glsl.h; by texels: columns first, then rows within the column). Nothing where
/// rounding found light in a dark column.
std::optional<TexelPoint> pick_point(const SamplingSlab& slab,
                                     SamplingView& view,
                                     const Window& window,
                                     glm::vec2 coordinates);

/// The coordinates at which pick_point gives a point.
glm::vec2 invert_point(const SamplingSlab& slab,
                       const SamplingView& view,
                       const Window& window,
                       const TexelPoint& point);

/// A point on U, by the ray through a point of a texel.
using shared::AperturePoint;
AperturePoint aperture_point(const SamplingView& view,
                             const shared::AxisBox& x,
                             const shared::AxisBox& y,
                             const TexelPoint& point);

/// Phi_m(u) max(0, n.(t, -1)), with radiance weighting over (1 + |t|^2)^2: what multiplies C_m in
/// the integral over t, delta^2 apart.
float light_kernel(const Slab& slab,
                   const SamplingView& view,
                   int image,
                   const AperturePoint& point);

/// Phi_m(u).
float basis_at(const Slab& slab, int image, glm::vec2 u_m);

/// C_m of a texel, R G B, and its luminance.
glm::vec3 texel_color(const Slab& slab, int image, glm::ivec2 texel);
float luminance_of(const Slab& slab, glm::vec3 color);
/// The same divided by its luminance, for points drawn by that. 0 where it is dark, which rounding
/// of tables may choose; of one channel 1 without a look.
glm::vec3 chroma(const Slab& slab, SamplingView& view, int image, glm::ivec2 texel);

/// From energies here to illuminance: delta^2 (or 1) over a texel's area.
float energy_scale(const Slab& slab);

}  // namespace nearfield::model
