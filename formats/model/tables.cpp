// SPDX-License-Identifier: Apache-2.0
#include "formats/model/tables.h"

#include "formats/model/profile.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::model {
namespace {

std::size_t to_size(int n) {
    return static_cast<std::size_t>(n);
}

// Luminance of image m in double, [j][i].
void load_luminance(const Slab& slab, int m, std::vector<double>& values) {
    values.assign(slab.texel_count(), 0.0);
    for (int c = 0; c < slab.channels; ++c) {
        const double weight = slab.channels == 1 ? 1.0 : kLuminanceRgb[to_size(c)];
        const float* texel = slab.coeffs.data() + slab.image_offset(c, m);
        for (std::size_t k = 0; k < values.size(); ++k)
            values[k] += weight * static_cast<double>(texel[k]);
    }
}

// Where a CDF sampled at edges passes one half, linear in between, in units of texels.
double half_way(const float* cdf, int texels) {
    int i = 0;
    while (i + 1 < texels && cdf[i + 1] < 0.5F)
        ++i;
    const double step = static_cast<double>(cdf[i + 1]) - static_cast<double>(cdf[i]);
    return i + (step > 0.0 ? (0.5 - static_cast<double>(cdf[i])) / step : 0.5);
}

// Divides running sums by their last; all zero where nothing is lit.
void normalize(const double* running, int texels, float* cdf) {
    const double total = running[texels];
    for (int k = 0; k <= texels; ++k)
        cdf[k] = total > 0.0 ? static_cast<float>(running[k] / total) : 0.0F;
}

// All of one image's tables.
void build_image(const Slab& slab, int m, SlabTables& tables) {
    const int w = slab.texels.x, h = slab.texels.y;
    const glm::dvec2 texel = slab.texel_m();
    const double area = texel.x * texel.y;
    std::vector<double> value;
    load_luminance(slab, m, value);

    // The summed-area table, in double, kept as a float and what the float leaves.
    const std::size_t table_at = to_size(m) * to_size(w + 1) * to_size(h + 1);
    std::vector<double> above(to_size(w + 1), 0.0), row(to_size(w + 1), 0.0);
    for (int j = 0; j <= h; ++j) {
        if (j > 0) {
            double sum = 0.0;
            for (int i = 0; i < w; ++i) {
                sum += value[to_size(j - 1) * to_size(w) + to_size(i)] * area;
                row[to_size(i + 1)] = above[to_size(i + 1)] + sum;
            }
        }
        float* hi = tables.sat_hi.data() + table_at + to_size(j) * to_size(w + 1);
        float* lo = tables.sat_lo.data() + table_at + to_size(j) * to_size(w + 1);
        for (int i = 0; i <= w; ++i) {
            hi[i] = static_cast<float>(row[to_size(i)]);
            lo[i] = static_cast<float>(row[to_size(i)] - static_cast<double>(hi[i]));
        }
        above = row;
    }
    tables.total[to_size(m)] = static_cast<float>(row[to_size(w)]);

    // The marginal CDF over x is the table's last row; the conditional CDFs are columns' own
    // running sums.
    float* marginal = tables.marginal_cdf.data() + to_size(m) * to_size(w + 1);
    normalize(row.data(), w, marginal);
    std::vector<double> column(to_size(h + 1), 0.0);
    for (int i = 0; i < w; ++i) {
        for (int j = 0; j < h; ++j)
            column[to_size(j + 1)] =
                column[to_size(j)] + value[to_size(j) * to_size(w) + to_size(i)];
        normalize(column.data(), h,
                  tables.conditional_cdf.data() +
                      (to_size(m) * to_size(w) + to_size(i)) * to_size(h + 1));
    }
    if (tables.total[to_size(m)] > 0.0F) {
        const double x = half_way(marginal, w);
        const int i = std::min(static_cast<int>(x), w - 1);
        const double y = half_way(
            tables.conditional_cdf.data() + (to_size(m) * to_size(w) + to_size(i)) * to_size(h + 1),
            h);
        tables.median_s_m[to_size(m)] = glm::vec2(slab.s_min_m + glm::dvec2(x, y) * texel);
    }
}

// One mip level from the one before: [channel][m] images of `from` texels.
MipLevel halve(const float* coeffs, glm::ivec2 from, std::size_t images) {
    MipLevel level;
    level.texels = (from + 1) / 2;
    const std::size_t count = to_size(level.texels.x) * to_size(level.texels.y);
    level.coeffs.assign(images * count, 0.0F);
    tbb::parallel_for(std::size_t{0}, images, [&](std::size_t image) {
        const float* fine = coeffs + image * to_size(from.x) * to_size(from.y);
        float* coarse = level.coeffs.data() + image * count;
        for (int j = 0; j < level.texels.y; ++j)
            for (int i = 0; i < level.texels.x; ++i) {
                float sum = 0.0F;
                for (int dj = 0; dj < 2 && 2 * j + dj < from.y; ++dj)
                    for (int di = 0; di < 2 && 2 * i + di < from.x; ++di)
                        sum += fine[to_size(2 * j + dj) * to_size(from.x) + to_size(2 * i + di)];
                *coarse++ = 0.25F * sum;
            }
    });
    return level;
}

void build_mips(const Slab& slab, SlabTables& tables) {
    const std::size_t images = to_size(slab.channels) * to_size(slab.image_count());
    const float* coeffs = slab.coeffs.data();
    glm::ivec2 texels = slab.texels;
    while (texels.x > 1 || texels.y > 1) {
        tables.mips.push_back(halve(coeffs, texels, images));
        coeffs = tables.mips.back().coeffs.data();
        texels = tables.mips.back().texels;
    }
}

void build_cells(const Slab& slab, SlabTables& tables) {
    const auto n = static_cast<int>(slab.profile.cells.size());
    const double whole = integral(slab.profile);
    tables.cells = slab.grid + n - 1;
    const std::size_t count = to_size(tables.cells.x) * to_size(tables.cells.y);
    tables.cell_reference_s_m.assign(count, glm::vec2(0.0F));
    tables.cell_total.assign(count, 0.0F);
    for (int y = 0; y < tables.cells.y; ++y)
        for (int x = 0; x < tables.cells.x; ++x) {
            glm::dvec2 sum(0.0);
            double total = 0.0;
            int lit = 0;
            for (int row = std::max(0, y - n + 1); row <= std::min(y, slab.grid.y - 1); ++row)
                for (int column = std::max(0, x - n + 1); column <= std::min(x, slab.grid.x - 1);
                     ++column) {
                    const std::size_t m = to_size(row * slab.grid.x + column);
                    if (!(tables.total[m] > 0.0F))
                        continue;
                    ++lit;
                    sum += glm::dvec2(tables.median_s_m[m]);
                    total += static_cast<double>(tables.total[m]) *
                             integral(slab.profile, to_size(x - column)) *
                             integral(slab.profile, to_size(y - row)) / (whole * whole);
                }
            const std::size_t cell = to_size(y) * to_size(tables.cells.x) + to_size(x);
            if (lit > 0)
                tables.cell_reference_s_m[cell] = glm::vec2(sum / static_cast<double>(lit));
            tables.cell_total[cell] = static_cast<float>(total);
        }
}

// Counts values that differ by more than float rounding of the table's largest magnitude.
template <typename Values>
void compare(const Values& stored, const Values& built, TableCheck& check) {
    if (stored.size() != built.size()) {
        check.values += std::max(stored.size(), built.size());
        check.different += std::max(stored.size(), built.size());
        check.worst_relative = 1.0;
        return;
    }
    double largest = 0.0;
    for (const float value : built)
        largest = std::max(largest, std::abs(static_cast<double>(value)));
    for (std::size_t k = 0; k < stored.size(); ++k) {
        const double difference =
            std::abs(static_cast<double>(stored[k]) - static_cast<double>(built[k]));
        const double relative = largest > 0.0 ? difference / largest : difference;
        check.worst_relative = std::max(check.worst_relative, relative);
        ++check.values;
        if (!(relative <= 1e-6))
            ++check.different;
    }
}

std::vector<float> flatten(const std::vector<glm::vec2>& points) {
    std::vector<float> values;
    for (const glm::vec2 point : points) {
        values.push_back(point.x);
        values.push_back(point.y);
    }
    return values;
}

}  // namespace

SlabTables build_tables(const Slab& slab) {
    const std::size_t images = to_size(slab.image_count());
    const std::size_t w = to_size(slab.texels.x), h = to_size(slab.texels.y);
    SlabTables tables;
    tables.total.assign(images, 0.0F);
    tables.median_s_m.assign(images, glm::vec2(0.0F));
    tables.sat_hi.resize(images * (w + 1) * (h + 1));
    tables.sat_lo.resize(images * (w + 1) * (h + 1));
    tables.marginal_cdf.resize(images * (w + 1));
    tables.conditional_cdf.resize(images * w * (h + 1));
    tbb::parallel_for(0, slab.image_count(), [&](int m) { build_image(slab, m, tables); });
    build_mips(slab, tables);
    build_cells(slab, tables);
    return tables;
}

Luminaire pack(LightField lightfield, bool lean) {
    check(lightfield, "light field");
    Luminaire luminaire;
    luminaire.lightfield = std::move(lightfield);
    if (!lean)
        for (const Slab& slab : luminaire.lightfield.slabs)
            luminaire.tables.push_back(build_tables(slab));
    return luminaire;
}

TableCheck verify_tables(const Luminaire& luminaire) {
    TableCheck check;
    for (std::size_t k = 0; k < luminaire.tables.size(); ++k) {
        const SlabTables& stored = luminaire.tables[k];
        const SlabTables built = build_tables(luminaire.lightfield.slabs[k]);
        compare(stored.total, built.total, check);
        compare(flatten(stored.median_s_m), flatten(built.median_s_m), check);
        compare(stored.sat_hi, built.sat_hi, check);
        compare(stored.sat_lo, built.sat_lo, check);
        compare(stored.marginal_cdf, built.marginal_cdf, check);
        compare(stored.conditional_cdf, built.conditional_cdf, check);
        compare(flatten(stored.cell_reference_s_m), flatten(built.cell_reference_s_m), check);
        compare(stored.cell_total, built.cell_total, check);
        for (std::size_t level = 0; level < built.mips.size(); ++level)
            compare(level < stored.mips.size() ? stored.mips[level].coeffs : std::vector<float>{},
                    built.mips[level].coeffs, check);
    }
    return check;
}

}  // namespace nearfield::model
