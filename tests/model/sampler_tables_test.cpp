// SPDX-License-Identifier: Apache-2.0
// Summed-area tables at full size: one image of 4096 x 4096 texels, a range of 1e9 in blocks.
#include "formats/model/profile.h"
#include "formats/model/sampler.h"
#include "formats/model/sampler_window.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace nearfield::model {
namespace {

constexpr int kSize = 4096;
constexpr int kBlock = 64;

/// Blocks of 64 x 64 texels, each as bright as 10^-x, x in [0, 9]; texels within a block differ by
/// up to 3.
Slab blocks() {
    Slab slab;
    slab.delta_m = 1.0;
    slab.grid = {1, 1};
    slab.pitch_m = glm::dvec2(0.02);  // from one delta away: 41 texels of S
    slab.texels = glm::ivec2(kSize);
    slab.s_min_m = glm::dvec2(-0.5);
    slab.s_max_m = glm::dvec2(0.5);
    slab.profile = make_profile("box");
    support::Random random{1};
    std::vector<double> level(static_cast<std::size_t>(kSize / kBlock * kSize / kBlock));
    for (double& value : level)
        value = std::pow(10.0, -random.uniform(0.0, 9.0));
    slab.coeffs.resize(slab.texel_count());
    for (std::size_t k = 0; k < slab.coeffs.size(); ++k) {
        const std::size_t block = k / kSize / kBlock * (kSize / kBlock) + k % kSize / kBlock;
        slab.coeffs[k] = static_cast<float>(level[block] * random.uniform(0.5, 1.5));
    }
    return slab;
}

/// The energy of the very box that the view has, by texels in double.
double exact_energy(const Slab& slab, const SamplingView& view) {
    const shared::AxisBox &x = view.x[0], &y = view.y[0];
    double sum = 0.0;
    for (int j = y.first; j <= y.last; ++j)
        for (int i = x.first; i <= x.last; ++i)
            sum +=
                static_cast<double>(texel_width(x, i)) * static_cast<double>(texel_width(y, j)) *
                static_cast<double>(
                    slab.coeffs[static_cast<std::size_t>(j) * kSize + static_cast<std::size_t>(i)]);
    return sum;
}

struct Worst {
    double above = 0, below = 0;  // boxes with at least 1e-9 of the image's light, and with less
    int above_count = 0, below_count = 0;
};

Worst worst_error(const SamplingSlab& slab, TablePrecision precision) {
    const Slab& lamp = slab.prepared.slab;
    const double area = lamp.texel_m().x * lamp.texel_m().y;
    SamplerOptions options;
    options.precision = precision;
    SamplingView view;
    support::Random random{2};
    Worst worst;
    for (int trial = 0; trial < 4000; ++trial) {
        const double size = std::pow(10.0, random.uniform(-3.0, 0.0));  // of Delta: the box' size
        const ReceiverF receiver{
            glm::vec3(glm::dvec3(random.uniform(-0.45, 0.45), random.uniform(-0.45, 0.45), size)),
            {0.0F, 0.0F, -1.0F}};
        look(slab, receiver, options, view);
        const double exact = exact_energy(lamp, view);
        if (!(exact > 0.0))
            continue;
        const double error = std::abs(static_cast<double>(view.total) / exact - 1.0);
        const auto widest = [](const shared::AxisBox& box) {
            return static_cast<double>(
                std::max({box.first_width, box.last_width,
                          box.last - box.first > 1 ? box.texel_width : 0.0F}));
        };
        const double share =
            exact * area /
            (static_cast<double>(slab.tables.total[0]) * widest(view.x[0]) * widest(view.y[0]));
        if (share >= 1e-9) {
            worst.above = std::max(worst.above, error);
            ++worst.above_count;
        } else {
            worst.below = std::max(worst.below, error);
            ++worst.below_count;
        }
    }
    return worst;
}

// The light in a box is right to 1e-4 wherever it lies, however dark: by pairs of floats where it
// is 1e-9 of the image's or more, by its texels below that. Floats alone are wrong by more than the
// whole, which the test shows.
TEST(SamplerTables, ResolveDarkBoxesOfLargeImages) {
    const SamplingSlab slab = prepare_sampling(blocks());
    const Worst pair = worst_error(slab, TablePrecision::Pair);
    EXPECT_GT(pair.above_count, 500);
    EXPECT_GT(pair.below_count, 500);
    EXPECT_LE(pair.above, 1e-4);
    EXPECT_LE(pair.below, 1e-4);
    const Worst in_float = worst_error(slab, TablePrecision::Float);
    EXPECT_GT(in_float.above, 1.0);
    RecordProperty("pair_above_1e-9", std::to_string(1e9 * pair.above));
    RecordProperty("pair_below_1e-9", std::to_string(1e9 * pair.below));
    RecordProperty("float_above", std::to_string(in_float.above));
    RecordProperty("float_below", std::to_string(in_float.below));
    RecordProperty("boxes_above", pair.above_count);
    RecordProperty("boxes_below", pair.below_count);
}

}  // namespace
}  // namespace nearfield::model
