// SPDX-License-Identifier: Apache-2.0
#include "formats/model/axis_window.h"
#include "formats/model/prepared.h"

#include <algorithm>
#include <cmath>

namespace nearfield::model {
namespace {

// A cell of Phi's support and a position in it, both from one uniform number.
struct CellPoint {
    int cell;
    float fraction;
};

CellPoint pick_cell(std::span<const float> share, float xi) {
    int cell = 0;
    const int last = static_cast<int>(share.size()) - 1;
    while (cell < last && xi >= share[static_cast<std::size_t>(cell)])
        xi -= share[static_cast<std::size_t>(cell++)];
    const float width = share[static_cast<std::size_t>(cell)];
    // Rounding may leave xi a little above the last share.
    return {cell, width > 0.0F ? std::min(xi / width, 0x1.fffffep-1F) : 0.5F};
}

// phi on each cell at the fraction of a cell's width; the cells of one column of U, seen from the n
// basis functions that cover it.
float phi(const Slab& slab, int cell, float fraction) {
    const auto& [a0, a1, a2] = slab.profile.cells[static_cast<std::size_t>(cell)];
    const float x =
        static_cast<float>(cell) + fraction - 0.5F * static_cast<float>(slab.profile.cells.size());
    return static_cast<float>(a0) + x * (static_cast<float>(a1) + x * static_cast<float>(a2));
}

int pick_image(std::span<const float> image_y, float target) {
    float sum = 0.0F;
    int lit = 0;
    for (std::size_t m = 0; m < image_y.size(); ++m) {
        if (!(image_y[m] > 0.0F))
            continue;
        lit = static_cast<int>(m);
        sum += image_y[m];
        if (target < sum)
            break;
    }
    return lit;
}

}  // namespace

ApertureSample sample_aperture(const PreparedSlab& prepared,
                               const ReceiverF& receiver,
                               std::span<const float> image_y,
                               float image_y_sum,
                               float select,
                               glm::vec2 xi) {
    const Slab& slab = prepared.slab;
    const auto n = static_cast<int>(slab.profile.cells.size());
    const int chosen = pick_image(image_y, select * image_y_sum);
    const CellPoint x = pick_cell(prepared.cell_share, xi.x);
    const CellPoint y = pick_cell(prepared.cell_share, xi.y);
    const glm::ivec2 first(chosen % slab.grid.x + x.cell, chosen / slab.grid.x + y.cell);

    const glm::vec2 pitch(slab.pitch_m);
    const glm::vec2 center(slab.basis_center_m(chosen % slab.grid.x, chosen / slab.grid.x));
    ApertureSample sample;
    sample.u_m = center + (glm::vec2(static_cast<float>(x.cell) + x.fraction,
                                     static_cast<float>(y.cell) + y.fraction) -
                           0.5F * static_cast<float>(n)) *
                              pitch;

    const glm::vec3 p = receiver.position_m;
    const auto delta = static_cast<float>(slab.delta_m);
    const glm::vec2 s(shared::s_of_u(sample.u_m.x, p.x, delta, p.z),
                      shared::s_of_u(sample.u_m.y, p.y, delta, p.z));
    const glm::vec2 texel = glm::floor((s - glm::vec2(slab.s_min_m)) / glm::vec2(slab.texel_m()));
    if (!(texel.x >= 0.0F && texel.x < static_cast<float>(slab.texels.x) && texel.y >= 0.0F &&
          texel.y < static_cast<float>(slab.texels.y)))
        return sample;
    const float distance = delta + p.z;
    const glm::vec2 t = (sample.u_m - glm::vec2(p)) / distance;
    const float cosine = receiver.normal.x * t.x + receiver.normal.y * t.y - receiver.normal.z;
    if (!(cosine > 0.0F))
        return sample;

    // All images whose support covers the cell send light through u, and could have been chosen to
    // draw it.
    const std::size_t offset =
        static_cast<std::size_t>(texel.y) * static_cast<std::size_t>(slab.texels.x) +
        static_cast<std::size_t>(texel.x);
    glm::vec3 light(0.0F);
    float density = 0.0F;
    for (int cy = 0; cy < n; ++cy)
        for (int cx = 0; cx < n; ++cx) {
            const glm::ivec2 grid = first - glm::ivec2(cx, cy);
            if (grid.x < 0 || grid.y < 0 || grid.x >= slab.grid.x || grid.y >= slab.grid.y)
                continue;
            const int m = grid.y * slab.grid.x + grid.x;
            density += image_y[static_cast<std::size_t>(m)] *
                       prepared.cell_share[static_cast<std::size_t>(cx)] *
                       prepared.cell_share[static_cast<std::size_t>(cy)];
            const float basis = phi(slab, cx, x.fraction) * phi(slab, cy, y.fraction);
            for (int c = 0; c < 3; ++c)
                light[c] +=
                    basis *
                    slab.coeffs[slab.image_offset(std::min(c, slab.channels - 1), m) + offset];
        }
    if (!(density > 0.0F))
        return sample;
    const float r2 = 1.0F + t.x * t.x + t.y * t.y;
    const float kernel = slab.weighting == Weighting::Irradiance ? delta * delta : 1.0F / (r2 * r2);
    // dt = du / (delta + Delta)^2; density per du is (sum / image_y_sum) / pitch^2.
    sample.weight = light * (cosine * kernel * image_y_sum * pitch.x * pitch.y /
                             (density * distance * distance));
    return sample;
}

}  // namespace nearfield::model
