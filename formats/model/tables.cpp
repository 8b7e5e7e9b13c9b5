// SPDX-License-Identifier: Apache-2.0
#include "formats/model/tables.h"

#include "formats/files/large_array.h"
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

// Where a CDF passes one half: texel, and the part of it, linear in between. The CDF rises in that
// texel, so that it is a lit one; of several such places the first.
struct Median {
    int texel = 0;
    double part = 0.0;
    double position() const { return texel + part; }
};

Median median(const float* cdf, int texels) {
    int i = 0;
    while (i + 1 < texels && cdf[i + 1] < 0.5F)
        ++i;
    const double step = static_cast<double>(cdf[i + 1]) - static_cast<double>(cdf[i]);
    return {i, (0.5 - static_cast<double>(cdf[i])) / step};
}

// The summed-area table, in double, kept as a float and what the float leaves. Returns its last
// row: integrals over columns 0 ... i.
std::vector<double> sum_areas(const std::vector<double>& value,
                              glm::ivec2 texels,
                              double texel_area_m2,
                              float* hi,
                              float* lo) {
    const std::size_t w = to_size(texels.x), h = to_size(texels.y);
    std::vector<double> row(w + 1, 0.0);
    for (std::size_t j = 0; j <= h; ++j) {
        double sum = 0.0;
        for (std::size_t i = 0; j > 0 && i < w; ++i) {
            sum += value[(j - 1) * w + i] * texel_area_m2;
            row[i + 1] += sum;
        }
        for (const double corner : row) {
            *hi = static_cast<float>(corner);
            *lo++ = static_cast<float>(corner - static_cast<double>(*hi++));
        }
    }
    return row;
}

// Running sums over y within each column, [i][j], divided by the column's; all zero where it is
// dark.
void accumulate_columns(const std::vector<double>& value, glm::ivec2 texels, float* cdf) {
    const std::size_t w = to_size(texels.x), h = to_size(texels.y);
    std::vector<double> whole(w, 0.0);
    for (std::size_t k = 0; k < value.size(); k += w)
        for (std::size_t i = 0; i < w; ++i)
            whole[i] += value[k + i];
    // Few columns at once: each row's piece is one or two cache lines, of which all is used.
    constexpr std::size_t kColumns = 8;
    for (std::size_t first = 0; first < w; first += kColumns) {
        const std::size_t count = std::min(kColumns, w - first);
        double running[kColumns] = {};
        for (std::size_t i = 0; i < count; ++i)
            cdf[(first + i) * (h + 1)] = 0.0F;
        for (std::size_t j = 0; j < h; ++j)
            for (std::size_t i = 0; i < count; ++i) {
                running[i] += value[j * w + first + i];
                const double total = whole[first + i];
                cdf[(first + i) * (h + 1) + j + 1] =
                    total > 0.0 ? static_cast<float>(running[i] / total) : 0.0F;
            }
    }
}

// All of one image's tables.
void build_image(const Slab& slab, int m, SlabTables& tables) {
    const std::size_t w = to_size(slab.texels.x), h = to_size(slab.texels.y), image = to_size(m);
    const glm::dvec2 texel = slab.texel_m();
    std::vector<double> value;
    load_luminance(slab, m, value);

    const std::size_t corner = image * (w + 1) * (h + 1);
    const std::vector<double> of_columns =
        sum_areas(value, slab.texels, texel.x * texel.y, tables.sat_hi.data() + corner,
                  tables.sat_lo.data() + corner);
    const double total = of_columns.back();
    tables.total[image] = static_cast<float>(total);
    float* marginal = tables.marginal_cdf.data() + image * (w + 1);
    for (std::size_t i = 0; i <= w; ++i)
        marginal[i] = total > 0.0 ? static_cast<float>(of_columns[i] / total) : 0.0F;
    float* conditional = tables.conditional_cdf.data() + image * w * (h + 1);
    accumulate_columns(value, slab.texels, conditional);
    if (total > 0.0) {
        const Median x = median(marginal, slab.texels.x);
        const Median y = median(conditional + to_size(x.texel) * (h + 1), slab.texels.y);
        tables.median_s_m[image] =
            glm::vec2(slab.s_min_m + glm::dvec2(x.position(), y.position()) * texel);
    }
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

// Rounding of a float and of sums in another order.
constexpr double kFloatRounding = 1e-6;
// A box of 1e-9 of an image's light is the difference of four corners: with this it is good to
// 1e-4, twice what a table promises (docs/formats.md).
constexpr double kCornerRounding = 2e-14;

// Counts a value that differs from the one expected by more than `rounding` of `scale`.
void compare(double stored, double built, double scale, double rounding, TableCheck& check) {
    const double difference = std::abs(stored - built);
    const double relative = difference == 0.0 ? 0.0 : scale > 0.0 ? difference / scale : 1.0;
    check.worst_relative = std::max(check.worst_relative, relative);
    ++check.values;
    if (!(relative <= rounding))
        ++check.different;
}

// Whether arrays can be compared; if not, all of the larger differs.
template <typename Value>
bool have_one_size(const std::vector<Value>& stored,
                   const std::vector<Value>& built,
                   TableCheck& check) {
    if (stored.size() == built.size())
        return true;
    check.values += std::max(stored.size(), built.size());
    check.different += std::max(stored.size(), built.size());
    check.worst_relative = 1.0;
    return false;
}

// Light and CDFs: sums of numbers >= 0, as exact relative to themselves as their terms.
void compare(const std::vector<float>& stored, const std::vector<float>& built, TableCheck& check) {
    if (have_one_size(stored, built, check))
        for (std::size_t k = 0; k < stored.size(); ++k)
            compare(stored[k], built[k], built[k], kFloatRounding, check);
}

// Positions on S, as exact as S is large.
void compare(const std::vector<glm::vec2>& stored,
             const std::vector<glm::vec2>& built,
             const Slab& slab,
             TableCheck& check) {
    const glm::dvec2 scale = glm::max(glm::abs(slab.s_min_m), glm::abs(slab.s_max_m));
    if (have_one_size(stored, built, check))
        for (std::size_t k = 0; k < stored.size(); ++k)
            for (int axis = 0; axis < 2; ++axis)
                compare(stored[k][axis], built[k][axis], scale[axis], kFloatRounding, check);
}

// Corners of summed-area tables: hi + lo counts, however it is divided.
void compare_corners(const SlabTables& stored, const SlabTables& built, TableCheck& check) {
    if (!have_one_size(stored.sat_hi, built.sat_hi, check) ||
        !have_one_size(stored.sat_lo, built.sat_lo, check))
        return;
    const auto corner = [](const SlabTables& tables, std::size_t k) {
        return static_cast<double>(tables.sat_hi[k]) + static_cast<double>(tables.sat_lo[k]);
    };
    for (std::size_t k = 0; k < built.sat_hi.size(); ++k)
        compare(corner(stored, k), corner(built, k), corner(built, k), kCornerRounding, check);
}

}  // namespace

MipLevel halve(const float* coeffs, glm::ivec2 from, std::size_t planes) {
    MipLevel level;
    level.texels = (from + 1) / 2;
    const std::size_t count = to_size(level.texels.x) * to_size(level.texels.y);
    resize_large(level.coeffs, planes * count);
    tbb::parallel_for(std::size_t{0}, planes, [&](std::size_t plane) {
        const float* fine = coeffs + plane * to_size(from.x) * to_size(from.y);
        float* coarse = level.coeffs.data() + plane * count;
        for (int j = 0; j < from.y; ++j) {
            const float* row = fine + to_size(j) * to_size(from.x);
            float* sums = coarse + to_size(j / 2) * to_size(level.texels.x);
            for (std::size_t i = 0; i < to_size(from.x / 2); ++i)
                sums[i] += 0.25F * (row[2 * i] + row[2 * i + 1]);
            if (from.x % 2 == 1)
                sums[from.x / 2] += 0.25F * row[from.x - 1];
        }
    });
    return level;
}

SlabTables build_tables(const Slab& slab) {
    const std::size_t images = to_size(slab.image_count());
    const std::size_t w = to_size(slab.texels.x), h = to_size(slab.texels.y);
    SlabTables tables;
    tables.total.assign(images, 0.0F);
    tables.median_s_m.assign(images, glm::vec2(0.0F));
    resize_large(tables.sat_hi, images * (w + 1) * (h + 1));
    resize_large(tables.sat_lo, images * (w + 1) * (h + 1));
    tables.marginal_cdf.resize(images * (w + 1));
    resize_large(tables.conditional_cdf, images * w * (h + 1));
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
        const Slab& slab = luminaire.lightfield.slabs[k];
        const SlabTables& stored = luminaire.tables[k];
        const SlabTables built = build_tables(slab);
        compare(stored.total, built.total, check);
        compare(stored.median_s_m, built.median_s_m, slab, check);
        compare_corners(stored, built, check);
        compare(stored.marginal_cdf, built.marginal_cdf, check);
        compare(stored.conditional_cdf, built.conditional_cdf, check);
        compare(stored.cell_reference_s_m, built.cell_reference_s_m, slab, check);
        compare(stored.cell_total, built.cell_total, check);
        for (std::size_t level = 0; level < built.mips.size(); ++level)
            compare(level < stored.mips.size() ? stored.mips[level].coeffs : std::vector<float>{},
                    built.mips[level].coeffs, check);
    }
    return check;
}

}  // namespace nearfield::model
