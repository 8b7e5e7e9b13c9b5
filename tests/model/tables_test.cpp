// SPDX-License-Identifier: Apache-2.0
// Proves that the tables hold what docs/formats.md says, by sums over texels in double that share
// no code with them.
#include "formats/model/tables.h"

#include "formats/model/profile.h"
#include "tests/model/texel_sums.h"
#include "tests/support/lamps.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace nearfield::model {
namespace {

using support::Random;
using test::dark_slab;
using test::sum_box;
using test::table_box;
using test::texel;
using test::to_size;

// Positions, totals and CDFs are stored as floats: 2^-24, with room for sums in another order.
constexpr double kFloat = 2e-7;

// Proves that a dark box cut from a bright image is as right as any, and that a table of one float
// would fail this test. 4096^2 is tables_slow_test.cpp's.
TEST(SummedAreaTable, HoldsDarkBoxesOfABrightImage) {
    test::expect_precise_boxes(512, 400);
    test::expect_precise_boxes(1024, 200);
}

/// Checks every table of image 0 against sums over its texels.
void expect_tables_of_image(const Slab& slab) {
    const SlabTables tables = build_tables(slab);
    const int w = slab.texels.x, h = slab.texels.y;
    const double total = sum_box(slab, {0, 0, w, h});
    EXPECT_NEAR(tables.total[0], total, kFloat * total);
    for (int j = 0; j <= h; ++j)
        for (int i = 0; i <= w; ++i) {
            const double corner = sum_box(slab, {0, 0, i, j});
            // 2^-48 of two floats, and double's rounding.
            ASSERT_NEAR(table_box(tables, w, {0, 0, i, j}, true), corner, 1e-13 * corner)
                << i << " " << j;
        }
    for (int i = 0; i <= w; ++i) {
        const double part = total > 0.0 ? sum_box(slab, {0, 0, i, h}) / total : 0.0;
        ASSERT_NEAR(tables.marginal_cdf[to_size(i)], part, kFloat * part) << i;
    }
    for (int i = 0; i < w; ++i) {
        const double column = sum_box(slab, {i, 0, i + 1, h});
        for (int j = 0; j <= h; ++j) {
            const double part = column > 0.0 ? sum_box(slab, {i, 0, i + 1, j}) / column : 0.0;
            ASSERT_NEAR(tables.conditional_cdf[to_size(i * (h + 1) + j)], part, kFloat * part)
                << i << " " << j;
        }
    }
}

/// CDFs of all images: 0 first, 1 last, never falling, or all zero.
void expect_cdfs(const std::vector<float>& cdfs, int texels) {
    const std::size_t size = to_size(texels) + 1;
    ASSERT_EQ(cdfs.size() % size, 0U);
    for (std::size_t at = 0; at < cdfs.size(); at += size) {
        const float last = cdfs[at + size - 1];
        EXPECT_TRUE(last == 1.0F || last == 0.0F) << last;
        EXPECT_EQ(cdfs[at], 0.0F);
        for (std::size_t k = 1; k < size; ++k)
            ASSERT_LE(cdfs[at + k - 1], cdfs[at + k]);
    }
}

struct Image {
    const char* name;
    glm::ivec2 texels;
    std::function<float(int i, int j)> value;
};

std::vector<Image> images() {
    const auto random = [](int i, int j) {
        Random numbers{static_cast<std::uint64_t>(i * 4099 + j)};
        return static_cast<float>(std::pow(10.0, numbers.uniform(-5.0, 5.0)));
    };
    return {
        {"dark", {7, 5}, [](int, int) { return 0.0F; }},
        {"one texel of one", {1, 1}, [](int, int) { return 3.0F; }},
        {"one lit texel", {7, 5}, [](int i, int j) { return i == 2 && j == 3 ? 2.0F : 0.0F; }},
        {"first texel", {7, 5}, [](int i, int j) { return i + j == 0 ? 1e-20F : 0.0F; }},
        {"one row", {9, 4}, [](int, int j) { return j == 1 ? 1.0F : 0.0F; }},
        {"one column", {9, 4}, [](int i, int) { return i == 4 ? 1.0F : 0.0F; }},
        {"last column", {9, 4}, [](int i, int) { return i == 8 ? 1.0F : 0.0F; }},
        {"last row", {9, 4}, [](int, int j) { return j == 3 ? 1.0F : 0.0F; }},
        {"one wide", {1, 12}, random},
        {"one high", {12, 1}, random},
        {"odd", {33, 17}, random},
        {"300 wide", {300, 5}, random},
        {"600 wide", {600, 3}, random},
        {"1080 wide", {1080, 2}, random},
    };
}

Slab slab_of(const Image& image) {
    Slab slab = dark_slab(image.texels);
    for (int j = 0; j < image.texels.y; ++j)
        for (int i = 0; i < image.texels.x; ++i)
            texel(slab, 0, i, j) = image.value(i, j);
    return slab;
}

// Proves totals, summed-area tables and CDFs on images that break careless code.
TEST(Tables, AreSumsOverTexels) {
    for (const Image& image : images()) {
        SCOPED_TRACE(image.name);
        const Slab slab = slab_of(image);
        expect_tables_of_image(slab);
        const SlabTables tables = build_tables(slab);
        expect_cdfs(tables.marginal_cdf, slab.texels.x);
        expect_cdfs(tables.conditional_cdf, slab.texels.y);
    }
}

// Proves that color images' tables are made of luminance, image by image.
TEST(Tables, AreMadeOfLuminance) {
    support::LampShape shape;
    shape.channels = 3;
    const Slab color =
        support::random_lamp(make_profile("bspline"), Weighting::Irradiance, 5, shape);
    const SlabTables tables = build_tables(color);
    for (int m = 0; m < color.image_count(); ++m) {
        double sum = 0.0;
        for (int c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < color.texel_count(); ++k)
                sum += kLuminanceRgb[to_size(c)] *
                       static_cast<double>(color.coeffs[color.image_offset(c, m) + k]);
        sum *= color.texel_m().x * color.texel_m().y;
        EXPECT_NEAR(tables.total[to_size(m)], sum, kFloat * sum) << m;
    }
    expect_cdfs(tables.marginal_cdf, color.texels.x);
    expect_cdfs(tables.conditional_cdf, color.texels.y);
}

void expect_median(const Slab& slab, glm::dvec2 in_texels, const char* name) {
    const glm::dvec2 expected = slab.s_min_m + in_texels * slab.texel_m();
    const glm::dvec2 median(build_tables(slab).median_s_m[0]);
    EXPECT_NEAR(median.x, expected.x, 1e-3 * slab.texel_m().x) << name;
    EXPECT_NEAR(median.y, expected.y, 1e-3 * slab.texel_m().y) << name;
}

// Proves where medians lie, on images drawn by hand: expected positions in texels from s_min.
TEST(Tables, MediansHalveTheLight) {
    Slab slab = dark_slab({8, 6});
    texel(slab, 0, 3, 4) = 2.0F;
    expect_median(slab, {3.5, 4.5}, "one texel: its center");
    texel(slab, 0, 7, 1) = 6.0F;  // marginal 0.25 up to column 7, then 1
    expect_median(slab, {7.0 + 1.0 / 3.0, 1.5}, "the brighter column");
    texel(slab, 0, 7, 5) = 6.0F;  // column 7: half of its light up to row 1's upper edge
    texel(slab, 0, 3, 4) = 4.0F;  // marginal 0.25 again
    expect_median(slab, {7.0 + 1.0 / 3.0, 2.0}, "first row where the column's CDF is 1/2");
    // Half the light in column 3, half in column 7: the median lies at column 3's edge, and its row
    // is column 3's, not that of the dark column beyond.
    texel(slab, 0, 3, 4) = 12.0F;
    expect_median(slab, {4.0, 4.5}, "the lit column before a dark gap");
    expect_median(slab_of({"even", {5, 3}, [](int, int) { return 1.0F; }}), {2.5, 1.5}, "even");
}

/// Phi's share of its integral in the cell centered `at` pitches from it, by Simpson's rule (exact
/// for its degree).
double share_of_cell(const Profile& profile, double at) {
    const auto simpson = [&](double x) {
        constexpr double kInside = 0.5 - 1e-12;  // a cell's ends belong to its neighbors as well
        return (eval(profile, x - kInside) + 4.0 * eval(profile, x) + eval(profile, x + kInside)) /
               6.0;
    };
    const auto n = static_cast<double>(profile.cells.size());
    double whole = 0.0;
    for (double x = 0.5 - 0.5 * n; x < 0.5 * n; x += 1.0)
        whole += simpson(x);
    return simpson(at) / whole;
}

struct CellLight {
    glm::dvec2 reference_s_m{0.0};
    double total = 0;
};

/// A cell by the definition, of a slab whose image m has one lit texel at (m % 3, m % 2), or none.
CellLight expected_cell(const Slab& slab, glm::ivec2 cell) {
    const auto n = static_cast<double>(slab.profile.cells.size());
    CellLight expected;
    double lit = 0.0;
    for (int m = 0; m < slab.image_count(); ++m) {
        const glm::ivec2 at(m % 3, m % 2);
        const auto value = static_cast<double>(
            slab.coeffs[slab.image_offset(0, m) + to_size(at.y * slab.texels.x + at.x)]);
        // From the basis function's center to the cell's, in pitches.
        const glm::dvec2 d =
            glm::dvec2(cell) + 0.5 - 0.5 * n - glm::dvec2(m % slab.grid.x, m / slab.grid.x);
        if (value == 0.0 || std::abs(d.x) > 0.5 * n || std::abs(d.y) > 0.5 * n)
            continue;
        lit += 1.0;
        expected.reference_s_m += slab.s_min_m + (glm::dvec2(at) + 0.5) * slab.texel_m();
        expected.total += value * slab.texel_m().x * slab.texel_m().y *
                          share_of_cell(slab.profile, d.x) * share_of_cell(slab.profile, d.y);
    }
    expected.reference_s_m /= std::max(lit, 1.0);
    return expected;
}

// Proves reference positions and light of cells: a mean over the lit images whose support covers
// the cell, and each one's light times Phi's share there; together, all light.
TEST(Tables, CellsFollowTheirImages) {
    for (const char* name : {"box", "bilinear", "quadratic", "bspline"}) {
        Slab slab = dark_slab({3, 2}, {4, 3}, name);
        Random random{11};
        for (int m = 0; m < slab.image_count(); ++m)
            if (m != 5 && m != 0)  // dark images have no median
                texel(slab, m, m % 3, m % 2) = static_cast<float>(random.uniform(1.0, 100.0));
        const SlabTables tables = build_tables(slab);
        ASSERT_EQ(tables.cells, slab.grid + static_cast<int>(slab.profile.cells.size()) - 1);
        double light = 0.0, all = 0.0;
        for (std::size_t k = 0; k < tables.cell_total.size(); ++k) {
            const glm::ivec2 cell(static_cast<int>(k) % tables.cells.x,
                                  static_cast<int>(k) / tables.cells.x);
            const CellLight expected = expected_cell(slab, cell);
            EXPECT_NEAR(tables.cell_reference_s_m[k].x, expected.reference_s_m.x, kFloat) << name;
            EXPECT_NEAR(tables.cell_reference_s_m[k].y, expected.reference_s_m.y, kFloat) << name;
            EXPECT_NEAR(tables.cell_total[k], expected.total, kFloat * expected.total) << name;
            light += static_cast<double>(tables.cell_total[k]);
        }
        for (const float total : tables.total)
            all += static_cast<double>(total);
        EXPECT_NEAR(light, all, 1e-6 * all) << name;  // some 30 floats' rounding
    }
}

// Proves that every mip level holds the same light in each image and channel, down to 1 x 1, and
// that a texel is the mean of the four below it, at odd sizes as well.
TEST(Tables, MipsHoldTheSameLight) {
    for (const glm::ivec2 texels : {glm::ivec2(33, 17), {1, 7}, {8, 8}, {300, 5}, {1, 1}}) {
        support::LampShape shape;
        shape.grid = {2, 2};
        shape.texels = texels;
        shape.channels = 3;
        const Slab slab =
            support::random_lamp(make_profile("bilinear"), Weighting::Radiance, 3, shape);
        const SlabTables tables = build_tables(slab);
        std::vector<float> fine = slab.coeffs;
        glm::ivec2 size = texels;
        for (const MipLevel& level : tables.mips) {
            ASSERT_EQ(level.texels, (size + 1) / 2);
            const std::size_t count = to_size(level.texels.x * level.texels.y);
            ASSERT_EQ(level.coeffs.size(), 12 * count);
            for (std::size_t k = 0; k < level.coeffs.size(); ++k) {
                const std::size_t image = k / count;
                const int i = static_cast<int>(k % count) % level.texels.x;
                const int j = static_cast<int>(k % count) / level.texels.x;
                double sum = 0.0;
                for (int y = 2 * j; y < std::min(2 * j + 2, size.y); ++y)
                    for (int x = 2 * i; x < std::min(2 * i + 2, size.x); ++x)
                        sum += static_cast<double>(
                            fine[image * to_size(size.x * size.y) + to_size(y * size.x + x)]);
                ASSERT_NEAR(level.coeffs[k], sum / 4, kFloat * sum);
            }
            fine = level.coeffs;
            size = level.texels;
        }
        EXPECT_EQ(size, glm::ivec2(1));
    }
}

Luminaire small_luminaire() {
    LightField lightfield;
    support::LampShape shape;
    shape.grid = {3, 2};
    shape.texels = {9, 6};
    lightfield.slabs.push_back(
        support::random_lamp(make_profile("bspline"), Weighting::Irradiance, 9, shape));
    return pack(std::move(lightfield), false);
}

// Proves that verification finds one changed value in any table, also one that is small beside the
// table's others, and nothing in tables as they were built.
TEST(VerifyTables, FindsASingleChangedValueInEachTable) {
    const Luminaire good = small_luminaire();
    EXPECT_EQ(verify_tables(good).different, 0U);
    EXPECT_EQ(verify_tables(good).worst_relative, 0.0);
    EXPECT_GT(verify_tables(good).values, 1000U);
    const auto finds = [&](const char* name, auto array_of) {
        const std::size_t size = array_of(good.tables[0]).size();
        for (const std::size_t at : {std::size_t{0}, size / 2, size - 1}) {
            Luminaire bad = good;
            auto& value = array_of(bad.tables[0])[at];
            // 4e-6 of the value, 1e-9 of nothing: more than rounding, less than anybody would see.
            value += 4e-6F * value + (value == decltype(+value){} ? 1e-9F : 0.0F);
            EXPECT_EQ(verify_tables(bad).different, 1U) << name << " " << at;
        }
    };
    finds(
        "total", [](auto& t) -> auto& { return t.total; });
    finds(
        "marginal_cdf", [](auto& t) -> auto& { return t.marginal_cdf; });
    finds(
        "conditional_cdf", [](auto& t) -> auto& { return t.conditional_cdf; });
    finds(
        "sat_hi", [](auto& t) -> auto& { return t.sat_hi; });
    finds(
        "cell_total", [](auto& t) -> auto& { return t.cell_total; });
    for (std::size_t level = 0; level < good.tables[0].mips.size(); ++level)
        finds(
            "mip", [level](auto& t) -> auto& { return t.mips[level].coeffs; });
    for (const int axis : {0, 1}) {
        Luminaire bad = good;
        bad.tables[0].median_s_m[3][axis] += 1e-6F;  // a micrometre
        EXPECT_EQ(verify_tables(bad).different, 1U);
        bad = good;
        bad.tables[0].cell_reference_s_m[3][axis] -= 1e-6F;
        EXPECT_EQ(verify_tables(bad).different, 1U);
    }
    Luminaire bad = good;
    std::fill(bad.tables[0].sat_lo.begin(), bad.tables[0].sat_lo.end(), 0.0F);
    EXPECT_GT(verify_tables(bad).different, bad.tables[0].sat_lo.size() / 4) << "one float alone";
    bad = good;
    bad.tables[0].mips.pop_back();
    EXPECT_GT(verify_tables(bad).different, 0U) << "a level less";
}

}  // namespace
}  // namespace nearfield::model
