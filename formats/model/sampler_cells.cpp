// SPDX-License-Identifier: Apache-2.0
// Energies of all (image, cell) pairs. Neighboring cells share the texel between them: with its
// edges an image of n x n cells takes (2n + 2)^2 corners, where n^2 boxes on their own take 16
// each.
#include "formats/model/profile.h"
#include "formats/model/sampler_window.h"

#include <algorithm>
#include <array>

namespace nearfield::model {
namespace {

using shared::AxisBox;
using shared::Pair;

// The edges along one axis of the cells that one basis function covers, ascending and each once,
// and which of the intervals between them each cell holds, with their widths.
struct CellEdges {
    std::vector<int> edge;
    struct Parts {
        std::array<std::size_t, 3> interval;
        std::array<float, 3> width;
    };
    std::vector<Parts> of_cell;
};

void find_edges(std::span<const AxisBox> boxes, CellEdges& edges) {
    edges.edge.clear();
    for (const AxisBox& box : boxes)
        if (box.first <= box.last)
            for (const int i :
                 {box.first, box.first + 1, std::max(box.last, box.first + 1), box.last + 1})
                edges.edge.push_back(i);
    std::sort(edges.edge.begin(), edges.edge.end());
    edges.edge.erase(std::unique(edges.edge.begin(), edges.edge.end()), edges.edge.end());
    edges.of_cell.clear();
    for (const AxisBox& box : boxes) {
        CellEdges::Parts parts{{0, 0, 0}, {0.0F, 0.0F, 0.0F}};
        const auto interval = [&](int first_edge) {
            const auto at = std::lower_bound(edges.edge.begin(), edges.edge.end(), first_edge);
            return static_cast<std::size_t>(at - edges.edge.begin());
        };
        if (box.first <= box.last) {
            parts.interval[0] = interval(box.first);
            parts.width[0] = box.first_width;
        }
        if (box.last - box.first > 1) {
            parts.interval[1] = interval(box.first + 1);
            parts.width[1] = box.texel_width;
        }
        if (box.last > box.first) {
            parts.interval[2] = interval(box.last);
            parts.width[2] = box.last_width;
        }
        edges.of_cell.push_back(parts);
    }
}

// Kept from image to image for their memory.
struct Blocks {
    std::vector<CellEdges> x, y;     // [column], [row]
    std::vector<Pair> before, edge;  // corners along two neighboring edges
    std::vector<float> energy;       // [interval along x][interval along y]
    std::vector<float> mean;         // of phi over each of its cells
};

// int C_m over every block between edges.
void sum_blocks(const shared::AreaTable& table,
                const CellEdges& x,
                const CellEdges& y,
                Blocks& blocks) {
    const std::size_t columns = x.edge.size(), rows = y.edge.size();
    blocks.before.resize(rows);
    blocks.edge.resize(rows);
    blocks.energy.resize((columns - 1) * (rows - 1));
    for (std::size_t i = 0; i < columns; ++i) {
        for (std::size_t j = 0; j < rows; ++j)
            blocks.edge[j] = corner(table, x.edge[i], y.edge[j]);
        if (i > 0) {
            Pair below = pair_difference(blocks.edge[0], blocks.before[0]);
            for (std::size_t j = 1; j < rows; ++j) {
                const Pair above = pair_difference(blocks.edge[j], blocks.before[j]);
                blocks.energy[(i - 1) * (rows - 1) + j - 1] =
                    std::max(float_difference(above, below), 0.0F);
                below = above;
            }
        }
        blocks.before.swap(blocks.edge);
    }
}

float cell_energy(const Blocks& blocks,
                  std::size_t row_intervals,
                  const CellEdges::Parts& x,
                  const CellEdges::Parts& y) {
    float sum = 0.0F;
    for (std::size_t a = 0; a < 3; ++a) {
        if (!(x.width[a] > 0.0F))
            continue;
        float column = 0.0F;
        for (std::size_t b = 0; b < 3; ++b)
            if (y.width[b] > 0.0F)
                column += y.width[b] * blocks.energy[x.interval[a] * row_intervals + y.interval[b]];
        sum += x.width[a] * column;
    }
    return sum;
}

void find_all_edges(const std::vector<AxisBox>& boxes,
                    std::size_t cells,
                    std::vector<CellEdges>& edges) {
    edges.resize(boxes.size() - cells + 1);
    for (std::size_t k = 0; k < edges.size(); ++k)
        find_edges({boxes.data() + k, cells}, edges[k]);
}

}  // namespace

void weigh_cells(const SamplingSlab& slab, TablePrecision precision, SamplingView& view) {
    const Slab& lamp = slab.prepared.slab;
    const std::size_t n = lamp.profile.cells.size();
    thread_local Blocks blocks;
    find_all_edges(view.x, n, blocks.x);
    find_all_edges(view.y, n, blocks.y);
    blocks.mean.resize(n);
    for (std::size_t c = 0; c < n; ++c)
        blocks.mean[c] = static_cast<float>(integral(lamp.profile, c));
    const float scale = energy_scale(lamp);
    view.energy.assign(static_cast<std::size_t>(lamp.image_count()) * n * n, 0.0F);
    for (int m = 0; m < lamp.image_count(); ++m) {
        const auto column = static_cast<std::size_t>(m % lamp.grid.x);
        const auto row = static_cast<std::size_t>(m / lamp.grid.x);
        const CellEdges &x = blocks.x[column], &y = blocks.y[row];
        if (x.edge.empty() || y.edge.empty() ||
            !meets_light(slab, m, {x.edge.front(), y.edge.front()},
                         {x.edge.back() - 1, y.edge.back() - 1}))
            continue;
        const shared::AreaTable table = area_table(slab, precision, m);
        sum_blocks(table, x, y, blocks);
        view.reads += corner_reads(table, static_cast<int>(x.edge.size() * y.edge.size()));
        float* energy = view.energy.data() + static_cast<std::size_t>(m) * n * n;
        for (std::size_t cy = 0; cy < n; ++cy)
            for (std::size_t cx = 0; cx < n; ++cx) {
                const AxisBox &box_x = view.x[column + cx], &box_y = view.y[row + cy];
                const float found =
                    cell_energy(blocks, y.edge.size() - 1, x.of_cell[cx], y.of_cell[cy]);
                *energy++ = scale * blocks.mean[cx] * blocks.mean[cy] *
                            resolved_energy(slab, view, precision, m, box_x, box_y, found);
            }
    }
}

}  // namespace nearfield::model
