// SPDX-License-Identifier: Apache-2.0
#include "tests/model/texel_sums.h"

#include "formats/model/profile.h"
#include "formats/model/tables.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::test {
namespace {

using support::Random;

struct SatErrors {
    double two_floats = 0, one_float = 0;
    int boxes = 0, dark_boxes = 0;
};

/// Largest relative errors over random boxes, many of them in the dark quarter, that hold at least
/// 1e-9 of the image's light.
SatErrors sat_errors(int size, int tries) {
    const Slab slab = wide_range_slab(size);
    const SlabTables tables = model::build_tables(slab);
    const double least = 1e-9 * sum_box(slab, {0, 0, size, size});
    Random random{7};
    SatErrors errors;
    for (int k = 0; k < tries; ++k) {
        const bool is_dark = k % 2 == 0;
        const int low = is_dark ? size / 2 + 1 : 0;
        const auto edge = [&] {
            return low + static_cast<int>(random.uniform() * (size - low + 1));
        };
        const auto [x0, x1] = std::minmax({edge(), edge()});
        const auto [y0, y1] = std::minmax({edge(), edge()});
        const Box box{x0, y0, x1, y1};
        const double exact = sum_box(slab, box);
        if (!(exact >= least))
            continue;
        ++errors.boxes;
        errors.dark_boxes += is_dark ? 1 : 0;
        const auto error = [&](bool has_lo) {
            return std::abs(table_box(tables, size, box, has_lo) / exact - 1.0);
        };
        errors.two_floats = std::max(errors.two_floats, error(true));
        errors.one_float = std::max(errors.one_float, error(false));
    }
    return errors;
}

// What a sampler is promised; the error found is about a tenth of it.
constexpr double kSatTolerance = 1e-4;

}  // namespace

Slab dark_slab(glm::ivec2 texels, glm::ivec2 grid, const char* profile) {
    Slab slab;
    slab.delta_m = 0.2;
    slab.grid = grid;
    slab.pitch_m = {0.02, 0.03};
    slab.texels = texels;
    slab.s_min_m = {-0.1, 0.3};
    slab.s_max_m = slab.s_min_m + glm::dvec2(texels) * glm::dvec2(1e-3, 2e-3);
    slab.profile = model::make_profile(profile);
    slab.coeffs.assign(slab.image_offset(1, 0), 0.0F);
    return slab;
}

Slab wide_range_slab(int size) {
    Slab slab = dark_slab({size, size});
    Random random{static_cast<std::uint64_t>(size)};
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
            const bool is_dark = i > size / 2 && j > size / 2;
            texel(slab, 0, i, j) =
                static_cast<float>(std::pow(10.0, random.uniform(-5.0, is_dark ? -3.0 : 5.0)));
        }
    return slab;
}

float& texel(Slab& slab, int m, int i, int j) {
    return slab.coeffs[slab.image_offset(0, m) + to_size(j) * to_size(slab.texels.x) + to_size(i)];
}

double sum_box(const Slab& slab, const Box& box) {
    double sum = 0.0;
    for (int j = box.y0; j < box.y1; ++j) {
        const float* row = slab.coeffs.data() + to_size(j) * to_size(slab.texels.x);
        for (int i = box.x0; i < box.x1; ++i)
            sum += static_cast<double>(row[i]);
    }
    return sum * slab.texel_m().x * slab.texel_m().y;
}

double table_box(const SlabTables& tables, int width, const Box& box, bool has_lo) {
    const auto at = [&](const std::vector<float>& table, int i, int j) {
        return static_cast<double>(table[to_size(j) * to_size(width + 1) + to_size(i)]);
    };
    double sum = 0.0;
    for (const std::vector<float>* table : {&tables.sat_hi, &tables.sat_lo})
        if (table == &tables.sat_hi || has_lo)
            sum += (at(*table, box.x1, box.y1) - at(*table, box.x0, box.y1)) -
                   (at(*table, box.x1, box.y0) - at(*table, box.x0, box.y0));
    return sum;
}

void expect_precise_boxes(int size, int tries) {
    const SatErrors errors = sat_errors(size, tries);
    testing::Test::RecordProperty("two_floats", std::to_string(errors.two_floats));
    EXPECT_GT(errors.dark_boxes, tries / 8);
    EXPECT_LE(errors.two_floats, kSatTolerance);
    // The test's power: these boxes are beyond what a float holds, by far.
    EXPECT_GT(errors.one_float, 100 * kSatTolerance);
}

}  // namespace nearfield::test
