// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/shadow_views.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace nearfield::render::gpu {
namespace {

/// A slab of 5 x 4 images of 6 x 5 texels, of which some are dark, and a lamp that has it.
struct Placed {
    model::PreparedSlab prepared;
    PlacedSlab slab;

    explicit Placed(const std::string& basis, float brightness = 1.0F) {
        Slab made = test::one_window_lamp(0.05, 1.0F).slabs[0];
        made.grid = {5, 4};
        made.texels = {6, 5};
        made.u_center_m = {0.02, -0.01};
        made.profile = model::make_profile(basis);
        made.coeffs.assign(std::size_t{20} * 30, 0.0F);
        // Columns 2 to 4 alone, each image with a lit rectangle of its own.
        for (int m = 0; m < 20; ++m)
            for (int j = m % 3; m % 5 >= 2 && j < 4; ++j)
                for (int i = 1; i < 3 + m % 2; ++i)
                    made.coeffs[made.image_offset(0, m) + static_cast<std::size_t>(6 * j + i)] =
                        brightness * static_cast<float>(1 + (7 * m + i) % 5);
        prepared = model::prepare(std::move(made));
        slab.prepared = &prepared;
    }
    Placed(const Placed&) = delete;
    Placed& operator=(const Placed&) = delete;
};

TEST(ShadowCells, HoldTheLampsFlux) {
    for (const std::string& basis : model::profile_names()) {
        const Placed placed(basis);
        double energy = 0.0;
        for (const ShadowCell& cell : lit_cells(placed.slab, 0))
            energy += cell.energy;
        EXPECT_NEAR(energy / model::flux(placed.prepared.slab).y, 1.0, 1e-6) << basis;
    }
}

TEST(ShadowCells, AreThoseThatSendLight) {
    const Placed placed("bspline");
    const Slab& slab = placed.prepared.slab;
    std::set<std::size_t> lit;
    for (const ShadowCell& cell : lit_cells(placed.slab, 0)) {
        lit.insert(cell.index);
        for (const int axis : {0, 1}) {
            EXPECT_GT(cell.center_m[axis], cell.u_min_m[axis]);
            EXPECT_LT(cell.center_m[axis], cell.u_max_m[axis]);
            EXPECT_GT(cell.median_m[axis], cell.s_min_m[axis]);
            EXPECT_LT(cell.median_m[axis], cell.s_max_m[axis]);
        }
    }
    // Images of columns 0 and 1 are dark: cells 0 and 1 of 7 columns are theirs alone.
    for (std::size_t k = 0; k < std::size_t{7} * 6; ++k)
        EXPECT_EQ(lit.count(k), k % 7 >= 2 ? 1U : 0U) << k;
    EXPECT_EQ(slab.image_count(), 20);
}

TEST(ShadowViews, OneALitCellAndNoneForDarkOnes) {
    const Placed placed("bspline");
    const ShadowViews views = find_shadow_views({&placed.slab, 1}, {}, 2048);
    EXPECT_EQ(views.cells_lit, 30);
    EXPECT_EQ(views.cells_dark, 12);
    EXPECT_EQ(views.views.size(), 30U);
    for (std::size_t k = 0; k < views.of_cell[0].size(); ++k)
        EXPECT_EQ(views.of_cell[0][k] >= 0, k % 7 >= 2) << k;
}

// Every line from a cell through a texel with light, met at S or anywhere beyond it, is in the
// view that stands for the cell; by lines drawn at random.
TEST(ShadowViews, ShowAllThatTheirCellsLight) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const int maps : {0, 5, 1}) {
        const Placed placed("bilinear");
        ShadowMapOptions options;
        options.maps = maps;
        const ShadowViews views = find_shadow_views({&placed.slab, 1}, options, 2048);
        const double delta_m = placed.prepared.slab.delta_m;
        for (const ShadowCell& cell : lit_cells(placed.slab, 0))
            for (int k = 0; k < 200; ++k) {
                const auto between = [&](glm::dvec2 low, glm::dvec2 high) {
                    return low + (high - low) * glm::dvec2(unit(random), unit(random));
                };
                const glm::dvec2 u = between(cell.u_min_m, cell.u_max_m);
                const glm::dvec2 s = between(cell.s_min_m, cell.s_max_m);
                const double beyond =
                    k % 4 == 0 ? 0.0 : delta_m * std::pow(10.0, 6.0 * unit(random) - 2.0);
                const glm::dvec2 p = u + (s - u) * (delta_m + beyond) / delta_m;
                const ShadowView& view =
                    views.views[static_cast<std::size_t>(views.of_cell[0][cell.index])];
                const glm::dvec2 tangent = (p - glm::dvec2(view.eye_m)) / (beyond - view.eye_m.z);
                for (const int axis : {0, 1}) {
                    EXPECT_GE(tangent[axis], view.tangent_min[axis] - 1e-9);
                    EXPECT_LE(tangent[axis], view.tangent_max[axis] + 1e-9);
                }
            }
    }
}

TEST(ShadowViews, BudgetIsKeptAndEveryLitCellHasAView) {
    const Placed placed("bspline");
    double before_m2 = 1e9;
    for (const int maps : {1, 3, 8, 29}) {
        ShadowMapOptions options;
        options.maps = maps;
        const ShadowViews views = find_shadow_views({&placed.slab, 1}, options, 2048);
        EXPECT_LE(views.views.size(), static_cast<std::size_t>(maps));
        double spread_m2 = 0.0, energy = 0.0;
        for (const ShadowCell& cell : lit_cells(placed.slab, 0)) {
            ASSERT_GE(views.of_cell[0][cell.index], 0);
            const glm::dvec2 off =
                glm::dvec2(
                    views.views[static_cast<std::size_t>(views.of_cell[0][cell.index])].eye_m) -
                cell.center_m;
            spread_m2 += cell.energy * glm::dot(off, off);
            energy += cell.energy;
        }
        EXPECT_LT(spread_m2 / energy, before_m2);
        before_m2 = spread_m2 / energy;
    }
}

// A device of few layers is a budget too; slabs with light keep one map each.
TEST(ShadowViews, EverySlabWithLightHasAView) {
    const Placed bright("bspline", 1000.0F), faint("bspline"), dark("bspline", 0.0F);
    const std::vector<PlacedSlab> slabs = {bright.slab, faint.slab, dark.slab};
    ShadowMapOptions options;
    options.maps = 1;
    const ShadowViews few = find_shadow_views(slabs, options, 2048);
    EXPECT_EQ(few.views.size(), 2U);
    for (std::size_t k = 0; k < few.of_cell[0].size(); ++k) {
        EXPECT_EQ(few.of_cell[0][k], k % 7 >= 2 ? 0 : -1);
        EXPECT_EQ(few.of_cell[1][k], k % 7 >= 2 ? 1 : -1);
        EXPECT_EQ(few.of_cell[2][k], -1);
    }
    EXPECT_EQ(find_shadow_views(slabs, {}, 16).views.size(), 16U);
}

TEST(ShadowMapOptions, OutOfRangeAreRefusedByName) {
    for (const auto& [options, name] : std::vector<std::pair<ShadowMapOptions, std::string>>{
             {{ShadowEye::Cell, -1, 192, 4}, "shadow maps"},
             {{ShadowEye::Cell, 0, 0, 4}, "shadow map's side"},
             {{ShadowEye::Cell, 0, 192, 5}, "shadow taps"}}) {
        try {
            check(options);
            FAIL() << name;
        } catch (const Error& error) {
            EXPECT_EQ(error.where, name);
        }
    }
    EXPECT_NO_THROW(check(ShadowMapOptions{}));
}

}  // namespace
}  // namespace nearfield::render::gpu
