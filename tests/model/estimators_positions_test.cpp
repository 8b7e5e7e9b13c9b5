// SPDX-License-Identifier: Apache-2.0
// Where Systematic and Cells put their samples: chi-square tests against the exact density, which
// sums over texels in double give.
#include "formats/model/profile.h"
#include "formats/model/sampler.h"
#include "formats/shared/rng.glsl.h"
#include "tests/support/chi_square.h"
#include "tests/support/lamps.h"
#include "tests/support/window_energy.h"
#include "tests/support/z_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace nearfield::model {
namespace {

using support::AxisPart;

constexpr int kBinsX = 32, kBinsY = 16;
constexpr int kRuns = 100000;

/// The exact distribution of (image, u) in double, and its cumulative along three coordinates:
/// image, x within the image, y within the column.
struct ExactDistribution {
    std::vector<AxisPart> x, y;
    std::vector<double> before_image;           // [image + 1]
    std::vector<std::vector<double>> before_x;  // [image][part of x + 1]
    std::vector<std::vector<double>> before_y;  // [image * parts of x + part][part of y + 1]
};

double texel(const Slab& slab, int m, const AxisPart& x, const AxisPart& y) {
    return slab.coeffs[slab.image_offset(0, m) +
                       static_cast<std::size_t>(y.texel * slab.texels.x + x.texel)];
}

/// Weight of a part of U in an image, by what the sampler is meant to weigh: 1, or Phi's mean over
/// the part's cell. 0 outside the support.
double weight(const Slab& slab, Sampler sampler, int first, const AxisPart& part) {
    const int cell = part.cell - first;
    if (cell < 0 || cell >= static_cast<int>(slab.profile.cells.size()))
        return 0.0;
    return sampler == Sampler::Cells ? integral(slab.profile, static_cast<std::size_t>(cell)) : 1.0;
}

ExactDistribution exact(const Slab& slab, const ReceiverF& receiver, Sampler sampler) {
    ExactDistribution d;
    d.x = support::axis_parts(slab, receiver, 0);
    d.y = support::axis_parts(slab, receiver, 1);
    d.before_image.push_back(0.0);
    for (int m = 0; m < slab.image_count(); ++m) {
        d.before_x.push_back({0.0});
        for (const AxisPart& px : d.x) {
            d.before_y.push_back({0.0});
            for (const AxisPart& py : d.y)
                d.before_y.back().push_back(d.before_y.back().back() +
                                            texel(slab, m, px, py) * px.width_u_m() *
                                                py.width_u_m() *
                                                weight(slab, sampler, m % slab.grid.x, px) *
                                                weight(slab, sampler, m / slab.grid.x, py));
            d.before_x.back().push_back(d.before_x.back().back() + d.before_y.back().back());
        }
        d.before_image.push_back(d.before_image.back() + d.before_x.back().back());
    }
    return d;
}

std::size_t part_at(const std::vector<AxisPart>& parts, double u_m) {
    const auto after = std::upper_bound(parts.begin(), parts.end(), u_m,
                                        [](double u, const AxisPart& p) { return u < p.u_lo_m; });
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - parts.begin() - 1, 0));
}

/// The share of all samples that lie before (image, u): two numbers uniform in [0, 1) if samples
/// follow the distribution.
glm::dvec2 uniform_coordinates(const ExactDistribution& d, int image, glm::dvec2 u_m) {
    const auto m = static_cast<std::size_t>(image);
    const std::size_t i = part_at(d.x, u_m.x), j = part_at(d.y, u_m.y);
    const auto along = [](const std::vector<double>& before, const AxisPart& part, std::size_t k,
                          double u) {
        const double f = std::clamp((u - part.u_lo_m) / part.width_u_m(), 0.0, 1.0);
        return before[k] + f * (before[k + 1] - before[k]);
    };
    const std::vector<double>& column = d.before_y[m * d.x.size() + i];
    const double x = d.before_image[m] + along(d.before_x[m], d.x[i], i, u_m.x);
    const double y = column.back() > 0.0 ? along(column, d.y[j], j, u_m.y) / column.back() : 0.5;
    return {x / d.before_image.back(), y};
}

/// Chance of positions as uneven as found, in bins of equal mass. One random sample of each run:
/// the samples of one run depend on each other.
double positions_chance(const Slab& truth,
                        const Slab& sampled,
                        const ReceiverF& receiver,
                        SamplerOptions options,
                        std::uint32_t seed,
                        int count = kRuns) {
    const ExactDistribution distribution = exact(truth, receiver, options.sampler);
    std::vector<SamplingSlab> slabs;
    slabs.push_back(prepare_sampling(sampled));
    std::vector<SamplingView> views(1);
    std::vector<LightSample> samples;
    look(slabs[0], receiver, options, views[0]);
    std::array<int, std::size_t{kBinsX} * kBinsY> bins{};
    int missing = 0;
    for (int run = 0; run < count; ++run) {
        const auto r = static_cast<std::uint32_t>(run);
        draw(slabs, views, options, shift_of(Shift::Random, {r, 0U}, 0U, seed), samples);
        missing += options.samples - static_cast<int>(samples.size());
        const std::uint32_t pick = shared::hash4({r, seed, 0U, 9U}).x;
        const LightSample& sample = samples[pick % samples.size()];
        const glm::dvec2 at = uniform_coordinates(distribution, sample.image, sample.u_m);
        const int x = std::clamp(static_cast<int>(at.x * kBinsX), 0, kBinsX - 1);
        const int y = std::clamp(static_cast<int>(at.y * kBinsY), 0, kBinsY - 1);
        ++bins[static_cast<std::size_t>(y * kBinsX + x)];
    }
    EXPECT_LT(missing, count / 1000) << "samples without light have no position";
    return support::even_counts_chance(bins);
}

/// Coefficients evenly spread over ten powers of ten.
Slab wide_range(const std::string& profile, support::LampShape shape = {}) {
    shape.decades = 10;
    shape.dark_fraction = 0.0;
    return support::random_lamp(make_profile(profile), Weighting::Irradiance, 41, shape);
}

/// One image: a dark window in its middle, 1e-10 of what surrounds it, with a pattern of its own;
/// the receiver sees the window alone.
Slab dark_window() {
    support::LampShape shape;
    shape.grid = {1, 1};
    shape.texels = {96, 80};
    shape.decades = 1.5;
    shape.dark_fraction = 0.0;
    Slab slab = support::random_lamp(make_profile("box"), Weighting::Irradiance, 42, shape);
    for (int j = 0; j < shape.texels.y; ++j)
        for (int i = 0; i < shape.texels.x; ++i)
            if (i > 30 && i < 66 && j > 25 && j < 55)
                slab.coeffs[static_cast<std::size_t>(j * shape.texels.x + i)] *= 1e-10F;
    return slab;
}

constexpr ReceiverF kFacing{{0.02F, 0.01F, 0.15F}, {0.0F, 0.0F, -1.0F}};

SamplerOptions options_of(Sampler sampler, int samples) {
    SamplerOptions options;
    options.sampler = sampler;
    options.samples = samples;
    return options;
}

// Positions follow C_m (Cells: times Phi's mean) over all images, over a single one, and between
// the planes, with a range of 1e10. 512 bins, 100,000 runs each: a density wrong by 5 % in half of
// the bins would be seen. Significance 0.0027 for all together.
TEST(EstimatorsPositions, FollowTheExactDensity) {
    support::LampShape single;
    single.grid = {1, 1};
    single.pitch_m = {0.2, 0.15};
    const Slab images = wide_range("bspline"), image = wide_range("bilinear", single);
    ReceiverF between = kFacing;
    between.position_m = {0.005F, -0.01F, -0.13F};
    struct Case {
        const Slab& slab;
        ReceiverF receiver;
    };
    const Case cases[] = {{images, kFacing}, {image, kFacing}, {image, between}};
    const double least = -std::expm1(std::log1p(-support::kThreeSigmaAlpha) / 12.0);
    std::uint32_t seed = 200;
    for (const Case& one : cases)
        for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells})
            for (const int k : {1, 16})
                EXPECT_GT(positions_chance(one.slab, one.slab, one.receiver, options_of(sampler, k),
                                           ++seed),
                          least)
                    << name_of(sampler) << ", K = " << k << ", delta + "
                    << one.receiver.position_m.z;
}

// A window that holds 1e-11 of its image's light. Float tables cannot tell it from nothing, and the
// test says so.
TEST(EstimatorsPositions, FollowTheDensityInADarkWindowAlone) {
    const Slab slab = dark_window();
    for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells})
        EXPECT_GT(positions_chance(slab, slab, kFacing, options_of(sampler, 16), 301),
                  support::kThreeSigmaAlpha / 2.0)
            << name_of(sampler);
    SamplerOptions in_float = options_of(Sampler::Systematic, 16);
    in_float.precision = TablePrecision::Float;
    std::vector<SamplingSlab> slabs;
    slabs.push_back(prepare_sampling(slab));
    SamplingView view;
    look(slabs[0], kFacing, in_float, view);
    const double expected = support::support_energy(slab, kFacing, 0);
    RecordProperty("window_share_1e-15",
                   std::to_string(1e15 * expected /
                                  (static_cast<double>(slabs[0].tables.total[0]) * slab.delta_m *
                                   slab.delta_m)));
    RecordProperty("float_energy_over_exact",
                   std::to_string(static_cast<double>(view.total) / expected));
    EXPECT_GT(std::abs(static_cast<double>(view.total) / expected - 1.0), 0.5);
}

// The test finds a planted error: a tenth of one image's light moved from its left to its right
// half. At 100,000 runs its power is near 1: counts of 195 a bin, half of them off by up to 20 %.
TEST(EstimatorsPositions, TheTestRejectsMovedLight) {
    support::LampShape single;
    single.grid = {1, 1};
    single.pitch_m = {0.2, 0.15};
    const Slab slab = wide_range("bilinear", single);
    Slab moved = slab;
    for (std::size_t k = 0; k < moved.coeffs.size(); ++k)
        moved.coeffs[k] *= k % 24 < 12 ? 0.9F : 1.1F;
    for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells})
        EXPECT_LT(positions_chance(slab, moved, kFacing, options_of(sampler, 16), 401), 1e-6)
            << name_of(sampler);
}

// The tail function against values from tables (Abramowitz and Stegun, 26.8).
TEST(ChiSquare, TailIsThatOfTheTables) {
    EXPECT_NEAR(support::chi_square_tail(3.84146, 1), 0.05, 1e-6);
    EXPECT_NEAR(support::chi_square_tail(18.307, 10), 0.05, 1e-5);
    EXPECT_NEAR(support::chi_square_tail(124.342, 100), 0.05, 1e-5);
    EXPECT_NEAR(support::chi_square_tail(2.0, 2), std::exp(-1.0), 1e-12);
    EXPECT_NEAR(support::chi_square_tail(70.065, 100), 0.99, 1e-5);
}

}  // namespace
}  // namespace nearfield::model
