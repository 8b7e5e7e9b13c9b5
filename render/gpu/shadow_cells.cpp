// SPDX-License-Identifier: Apache-2.0
#include "formats/model/profile.h"
#include "render/gpu/shadow_views.h"

#include <algorithm>
#include <numeric>

namespace nearfield::render::gpu {
namespace {

/// An image's light on S.
struct ImageLight {
    double total = 0;  // integral of C_m
    glm::dvec2 median_m{0.0};
};

/// Where the running sum of `values` passes half of it, in entries.
double median(const std::vector<double>& values) {
    const double half = 0.5 * std::accumulate(values.begin(), values.end(), 0.0);
    double before = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (before + values[k] >= half)
            return static_cast<double>(k) + (half - before) / values[k];
        before += values[k];
    }
    return static_cast<double>(values.size());
}

double texel_y(const Slab& slab, int m, std::size_t texel) {
    if (slab.channels == 1)
        return static_cast<double>(slab.coeffs[slab.image_offset(0, m) + texel]);
    double y = 0.0;
    for (int c = 0; c < 3; ++c)
        y += kLuminanceRgb[static_cast<std::size_t>(c)] *
             static_cast<double>(slab.coeffs[slab.image_offset(c, m) + texel]);
    return y;
}

ImageLight light_of(const model::PreparedSlab& prepared, int m) {
    const Slab& slab = prepared.slab;
    const glm::ivec4 lit = prepared.lit[static_cast<std::size_t>(m)];
    ImageLight light;
    const auto texel = [&](int i, int j) {
        return texel_y(slab, m, static_cast<std::size_t>(j * slab.texels.x + i));
    };
    std::vector<double> columns(static_cast<std::size_t>(slab.texels.x), 0.0);
    for (int j = lit.y; j < lit.w; ++j)
        for (int i = lit.x; i < lit.z; ++i)
            columns[static_cast<std::size_t>(i)] += texel(i, j);
    const glm::dvec2 texel_m = slab.texel_m();
    light.total = std::accumulate(columns.begin(), columns.end(), 0.0) * texel_m.x * texel_m.y;
    if (!(light.total > 0.0))
        return light;
    const double x = median(columns);
    std::vector<double> rows(static_cast<std::size_t>(slab.texels.y), 0.0);
    for (int j = lit.y; j < lit.w; ++j)
        rows[static_cast<std::size_t>(j)] =
            texel(std::min(static_cast<int>(x), slab.texels.x - 1), j);
    light.median_m = slab.s_min_m + glm::dvec2(x, median(rows)) * texel_m;
    return light;
}

/// int x phi dx over cell c, x in pitches from the function's center.
double first_moment(const Profile& profile, std::size_t c) {
    const double low = static_cast<double>(c) - 0.5 * static_cast<double>(profile.cells.size());
    const double high = low + 1.0;
    const auto& [a0, a1, a2] = profile.cells[c];
    const auto antiderivative = [&, a0 = a0, a1 = a1, a2 = a2](double x) {
        return x * x * (a0 / 2.0 + x * (a1 / 3.0 + x * a2 / 4.0));
    };
    return antiderivative(high) - antiderivative(low);
}

/// What images add to a cell; divided by the energy at the end.
struct CellSums {
    ShadowCell cell;
    int images = 0;

    void add(const Slab& slab,
             glm::ivec4 lit,
             const ImageLight& light,
             double energy,
             glm::dvec2 center_m) {
        const glm::dvec2 low = slab.s_min_m + glm::dvec2(lit.x, lit.y) * slab.texel_m();
        const glm::dvec2 high = slab.s_min_m + glm::dvec2(lit.z, lit.w) * slab.texel_m();
        cell.s_min_m = images == 0 ? low : glm::min(cell.s_min_m, low);
        cell.s_max_m = images == 0 ? high : glm::max(cell.s_max_m, high);
        cell.energy += energy;
        cell.center_m += energy * center_m;
        cell.median_m += light.median_m;
        ++images;
    }
};

void add_image(const model::PreparedSlab& prepared, int m, std::vector<CellSums>& sums) {
    const Slab& slab = prepared.slab;
    const ImageLight light = light_of(prepared, m);
    if (!(light.total > 0.0))
        return;
    const std::size_t n = slab.profile.cells.size();
    const auto columns = static_cast<std::size_t>(slab.grid.x) + n - 1;
    const auto column = static_cast<std::size_t>(m % slab.grid.x);
    const auto row = static_cast<std::size_t>(m / slab.grid.x);
    const glm::dvec2 center_m = slab.basis_center_m(m % slab.grid.x, m / slab.grid.x);
    for (std::size_t cy = 0; cy < n; ++cy)
        for (std::size_t cx = 0; cx < n; ++cx) {
            const glm::dvec2 share(model::integral(slab.profile, cx),
                                   model::integral(slab.profile, cy));
            const double energy = light.total * share.x * share.y * slab.pitch_m.x * slab.pitch_m.y;
            if (!(energy > 0.0))
                continue;
            const glm::dvec2 middle(first_moment(slab.profile, cx) / share.x,
                                    first_moment(slab.profile, cy) / share.y);
            sums[(row + cy) * columns + column + cx].add(
                slab, prepared.lit[static_cast<std::size_t>(m)], light, energy,
                center_m + middle * slab.pitch_m);
        }
}

}  // namespace

std::vector<ShadowCell> lit_cells(const PlacedSlab& placed, std::size_t index) {
    const Slab& slab = placed.prepared->slab;
    const auto n = static_cast<int>(slab.profile.cells.size());
    const glm::ivec2 cells = slab.grid + n - 1;
    std::vector<CellSums> sums(static_cast<std::size_t>(cells.x * cells.y));
    for (int m = 0; m < slab.image_count(); ++m)
        add_image(*placed.prepared, m, sums);

    const glm::dvec2 first_m = slab.basis_center_m(0, 0) - 0.5 * n * slab.pitch_m;
    std::vector<ShadowCell> lit;
    for (std::size_t k = 0; k < sums.size(); ++k) {
        if (sums[k].images == 0)
            continue;
        ShadowCell cell = sums[k].cell;
        const int column = static_cast<int>(k) % cells.x, row = static_cast<int>(k) / cells.x;
        cell.slab = index;
        cell.index = k;
        cell.center_m /= cell.energy;
        cell.median_m /= static_cast<double>(sums[k].images);
        cell.u_min_m = first_m + glm::dvec2(column, row) * slab.pitch_m;
        cell.u_max_m = cell.u_min_m + slab.pitch_m;
        lit.push_back(cell);
    }
    return lit;
}

}  // namespace nearfield::render::gpu
