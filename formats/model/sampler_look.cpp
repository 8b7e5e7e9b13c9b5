// SPDX-License-Identifier: Apache-2.0
// What a receiver sees of a slab: boxes along both axes, and the energy of every image in them.
#include "formats/model/sampler.h"
#include "formats/model/sampler_window.h"
#include "formats/model/tables.h"

#include <algorithm>
#include <utility>

namespace nearfield::model {
namespace {

// The boxes along one axis of whole supports (Cells: of U's cells).
void find_boxes(const Slab& slab,
                int axis,
                const shared::AxisView& view,
                const shared::AxisTexels& texels,
                bool by_cells,
                std::vector<shared::AxisBox>& boxes) {
    const auto cells = static_cast<int>(slab.profile.cells.size());
    const int span = by_cells ? 1 : cells;
    const double first_m =
        slab.basis_center_m(0, 0)[axis] - 0.5 * static_cast<double>(cells) * slab.pitch_m[axis];
    boxes.resize(static_cast<std::size_t>(slab.grid[axis] + cells - span));
    for (std::size_t k = 0; k < boxes.size(); ++k) {
        const double u_lo = first_m + static_cast<double>(k) * slab.pitch_m[axis];
        const double u_hi =
            first_m + static_cast<double>(k + static_cast<std::size_t>(span)) * slab.pitch_m[axis];
        boxes[k] = axis_box(view, texels, static_cast<float>(u_lo), static_cast<float>(u_hi));
    }
}

// Least and largest tangent of all that is seen along one axis; nothing: lo > hi.
shared::Interval bounds(const shared::AxisView& view, const std::vector<shared::AxisBox>& boxes) {
    shared::Interval range{1.0F, -1.0F};
    for (const shared::AxisBox& box : boxes) {
        if (box.last < box.first)
            continue;
        const float lo = t_of_e(view, box.e_lo), hi = t_of_e(view, box.e_hi);
        range = range.lo > range.hi
                    ? shared::Interval{lo, hi}
                    : shared::Interval{std::min(range.lo, lo), std::max(range.hi, hi)};
    }
    return range;
}

bool faces_light(const SamplingView& view) {
    const shared::Interval x = bounds(view.x_view, view.x), y = bounds(view.y_view, view.y);
    const glm::vec3 n = view.receiver.normal;
    return x.lo < x.hi && y.lo < y.hi &&
           std::max(n.x * x.lo, n.x * x.hi) + std::max(n.y * y.lo, n.y * y.hi) > n.z;
}

shared::AxisTexels axis_texels(const Slab& slab, int axis, float height_m) {
    return {static_cast<float>(slab.s_min_m[axis]), static_cast<float>(slab.texel_m()[axis]),
            static_cast<float>(slab.delta_m), height_m, slab.texels[axis]};
}

void weigh_images(const SamplingSlab& slab, const SamplerOptions& options, SamplingView& view) {
    const Slab& lamp = slab.prepared.slab;
    const float scale = energy_scale(lamp);
    view.energy.resize(static_cast<std::size_t>(lamp.image_count()));
    for (int m = 0; m < lamp.image_count(); ++m) {
        float& energy = view.energy[static_cast<std::size_t>(m)];
        if (options.sampler == Sampler::Precomputed) {
            energy = slab.tables.total[static_cast<std::size_t>(m)] * scale *
                     static_cast<float>(lamp.texel_m().x * lamp.texel_m().y);
            continue;
        }
        energy = scale * window_energy(slab, view, options.precision, m,
                                       view.x[static_cast<std::size_t>(m % lamp.grid.x)],
                                       view.y[static_cast<std::size_t>(m / lamp.grid.x)]);
        if (options.sampler == Sampler::Uniform)
            energy = energy > 0.0F ? 1.0F : 0.0F;
    }
}

}  // namespace

SamplingSlab prepare_sampling(Slab slab) {
    SlabTables tables = build_tables(slab);
    return prepare_sampling(std::move(slab), std::move(tables));
}

SamplingSlab prepare_sampling(Slab slab, SlabTables tables) {
    return {prepare(std::move(slab)), std::move(tables)};
}

void look(const SamplingSlab& slab,
          const ReceiverF& receiver,
          const SamplerOptions& options,
          SamplingView& view) {
    const Slab& lamp = slab.prepared.slab;
    const auto delta_m = static_cast<float>(lamp.delta_m);
    const glm::vec3 p = receiver.position_m;
    view.receiver = receiver;
    view.energy.clear();
    view.total = 0.0F;
    view.drawn = 0.0F;
    if (!(p.z > -delta_m))
        return;
    view.x_view = shared::axis_view(p.x, delta_m, p.z);
    view.y_view = shared::axis_view(p.y, delta_m, p.z);
    view.x_texels = axis_texels(lamp, 0, p.z);
    view.y_texels = axis_texels(lamp, 1, p.z);
    const bool by_cells = options.sampler == Sampler::Cells;
    find_boxes(lamp, 0, view.x_view, view.x_texels, by_cells, view.x);
    find_boxes(lamp, 1, view.y_view, view.y_texels, by_cells, view.y);
    if (!faces_light(view))
        return;
    if (by_cells)
        weigh_cells(slab, options.precision, view);
    else
        weigh_images(slab, options, view);
    double total = 0.0;
    for (const float energy : view.energy)
        total += static_cast<double>(energy);
    view.total = static_cast<float>(total);
}

}  // namespace nearfield::model
