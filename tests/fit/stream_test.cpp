// SPDX-License-Identifier: Apache-2.0
// Tiles, threads, sigma, smoothness: what a whole light field's fit promises.
#include "fit/stream.h"

#include "fit/quality.h"
#include "fit/replicates.h"
#include "fit/sigma.h"
#include "fit/smoothness.h"
#include "formats/files/error.h"
#include "tests/fit/bench_planes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A smooth beam through a round lens: coefficient m of texel s.
double beam(glm::dvec2 u_m, glm::dvec2 s_m) {
    const glm::dvec2 off = (s_m - 0.8 * u_m) / 0.06;
    return glm::length(u_m) < 0.07 ? std::exp(-0.5 * glm::dot(off, off)) + 0.01 : 0.0;
}

std::vector<double> truth_of(const Slab& planes, int i, int j) {
    const glm::dvec2 s_m = planes.s_min_m + (glm::dvec2(i, j) + 0.5) * planes.texel_m();
    std::vector<double> coeffs;
    coeffs.reserve(static_cast<std::size_t>(planes.image_count()));
    for (int m = 0; m < planes.image_count(); ++m)
        coeffs.push_back(beam(planes.basis_center_m(m % planes.grid.x, m / planes.grid.x), s_m));
    return coeffs;
}

// Measurements of the whole slab, [channel][k][j][i], with noise of `noise_rel` of the brightest
// and as many photons; 0: none, but weighted as if.
TileInput measured(const Slab& planes, const Design& design, int channels, double noise_rel) {
    const auto texels = planes.texel_count();
    const auto count = static_cast<std::size_t>(design.measurement_count);
    TileInput input;
    input.value.resize(static_cast<std::size_t>(channels) * count * texels);
    input.variance.resize(input.value.size());
    TexelDesign texel;
    support::Random random{11};
    const double brightest = planes.pitch_m.x * planes.pitch_m.y;
    for (int j = 0; j < planes.texels.y; ++j)
        for (int i = 0; i < planes.texels.x; ++i) {
            fill_texel_design(design, i, j, texel);
            const std::vector<double> truth = truth_of(planes, i, j);
            for (std::size_t k = 0; k < count; ++k)
                for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
                    const double light = predicted(texel, static_cast<int>(k), truth) /
                                         (1.0 + static_cast<double>(c));
                    const double used = noise_rel > 0.0 ? noise_rel : 1e-3;
                    const double sigma = used * brightest * std::sqrt(0.01 + light / brightest);
                    const std::size_t at = (c * count + k) * texels +
                                           static_cast<std::size_t>(j * planes.texels.x + i);
                    input.value[at] = static_cast<float>(
                        light + (noise_rel > 0.0 ? sigma * normal_number(random) : 0.0));
                    input.variance[at] = static_cast<float>(sigma * sigma);
                }
        }
    return input;
}

// A reader of tiles out of the whole.
ReadTile reader_of(const TileInput& whole, const Design& design) {
    return [&whole, &design](TileRange rows) {
        const auto width = static_cast<std::size_t>(design.texels.x);
        const auto texels = width * static_cast<std::size_t>(design.texels.y);
        TileInput tile;
        for (std::size_t image = 0; image < whole.value.size() / texels; ++image) {
            const auto begin = static_cast<std::ptrdiff_t>(
                image * texels + static_cast<std::size_t>(rows.first_row) * width);
            const auto end = begin + static_cast<std::ptrdiff_t>(
                                         static_cast<std::size_t>(rows.row_count) * width);
            tile.value.insert(tile.value.end(), whole.value.begin() + begin,
                              whole.value.begin() + end);
            tile.variance.insert(tile.variance.end(), whole.variance.begin() + begin,
                                 whole.variance.begin() + end);
        }
        return tile;
    };
}

// All tiles put together, [channel or image][j][i] as a single tile would be.
struct Whole {
    std::vector<float> coeffs, sigma, chi_square;
    FitReport report;
};

void place(const std::vector<float>& tile,
           TileRange rows,
           glm::ivec2 texels,
           std::vector<float>& to) {
    const auto part = static_cast<std::size_t>(rows.row_count * texels.x);
    const auto all = static_cast<std::size_t>(texels.x * texels.y);
    to.resize(tile.size() / part * all);
    for (std::size_t image = 0; image < tile.size() / part; ++image)
        std::copy_n(&tile[image * part], part,
                    &to[image * all + static_cast<std::size_t>(rows.first_row * texels.x)]);
}

Whole solve_whole(const Design& design, const FitOptions& options, const TileInput& input) {
    Whole whole;
    whole.report =
        solve_lightfield(design, options, reader_of(input, design), [&](const TileResult& tile) {
            place(tile.coeffs, tile.rows, design.texels, whole.coeffs);
            place(tile.sigma, tile.rows, design.texels, whole.sigma);
            place(tile.chi_square, tile.rows, design.texels, whole.chi_square);
        });
    return whole;
}

TEST(SolveLightfield, DoesNotDependOnTilesOrThreads) {
    const Slab planes = test_planes({6, 5});
    const Design design = make_design(planes, test_filter(planes, 0.001));
    const TileInput input = measured(planes, design, 3, 1e-3);
    FitOptions options;
    options.channels = 3;
    options.solve.lambda = 1e-4;
    options.solve.wants_sigma = true;
    const Whole one = solve_whole(design, options, input);
    EXPECT_EQ(one.report.texel_count, 3 * 48);
    EXPECT_EQ(one.report.unconverged_count, 0);
    EXPECT_LT(one.report.kkt_worst, 1e-10);
    EXPECT_LE(one.report.kkt_quantile(1.0), 1e-10);
    options.tile_bytes = 1.0;
    EXPECT_EQ(tile_rows(design, options), 1);
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    const Whole rows = solve_whole(design, options, input);
    EXPECT_EQ(one.coeffs, rows.coeffs);
    EXPECT_EQ(one.sigma, rows.sigma);
    EXPECT_EQ(one.chi_square, rows.chi_square);
    EXPECT_EQ(one.report.kkt_decades, rows.report.kkt_decades);
    EXPECT_EQ(one.report.chi_square, rows.report.chi_square);
}

TEST(SolveLightfield, FindsTheBeamWithinItsNoise) {
    const Slab planes = test_planes();
    const Design design = make_design(planes, test_filter(planes, 0.001));
    FitOptions options;
    options.channels = 2;
    options.solve.wants_sigma = true;
    const Whole exact = solve_whole(design, options, measured(planes, design, 2, 0.0));
    const Whole noisy = solve_whole(design, options, measured(planes, design, 2, 1e-3));
    double square = 0.0, count = 0.0;
    for (int j = 0; j < planes.texels.y; ++j)
        for (int i = 0; i < planes.texels.x; ++i) {
            const std::vector<double> truth = truth_of(planes, i, j);
            for (std::size_t m = 0; m < truth.size(); ++m)
                for (std::size_t c = 0; c < 2; ++c) {
                    const double wanted = truth[m] / (1.0 + static_cast<double>(c));
                    const std::size_t at =
                        (c * 99 + m) * 48 + static_cast<std::size_t>(j * planes.texels.x + i);
                    EXPECT_NEAR(exact.coeffs[at], wanted, 1e-4);  // data are floats
                    if (truth[m] > 0.1) {
                        square += std::pow((noisy.coeffs[at] - wanted) / noisy.sigma[at], 2.0);
                        count += 1.0;
                    }
                }
        }
    EXPECT_GT(count, 200.0);
    EXPECT_NEAR(std::sqrt(square / count), 1.0, 0.15);
    // Where a coefficient is 0 in truth, half of its noise goes to the bound and is not a degree of
    // freedom that was spent.
    EXPECT_NEAR(noisy.report.reduced_chi_square(), 1.0, 0.3);
}

TEST(SolveLightfield, RefusesBadTiles) {
    const Slab planes = test_planes({4, 3});
    const Design design = make_design(planes, test_filter(planes, 0.0));
    FitOptions options;
    FitReport report;
    const TileInput good = measured(planes, design, 1, 1e-3);
    for (const float bad : {0.0F, -1.0F, std::nanf("")}) {
        TileInput input = good;
        input.variance[17] = bad;
        EXPECT_THROW((void)solve_tile(design, options, {0, 6}, input, report), Error);
    }
    TileInput input = good;
    input.value[17] = std::nanf("");
    EXPECT_THROW((void)solve_tile(design, options, {0, 6}, input, report), Error);
    input.variance[17] = kInfinity;
    EXPECT_NO_THROW((void)solve_tile(design, options, {0, 6}, input, report));
    EXPECT_THROW((void)solve_tile(design, options, {0, 5}, good, report), Error);
    options.solve.lambda = -1.0;
    EXPECT_THROW((void)solve_tile(design, options, {0, 6}, good, report), Error);
    options.solve.lambda = 0.0;
    options.solve.difference_order = 3;
    EXPECT_THROW((void)solve_tile(design, options, {0, 6}, good, report), Error);
}

// Fits of one texel's truth under many draws of noise.
struct MonteCarlo {
    std::vector<double> mean, sigma;      // of each coefficient
    double sum_sigma = 0;                 // of the sum of all coefficients
    std::vector<double> predicted_sigma;  // by the noise-free fit
    double bootstrap_sum_sigma = 0;
};

MonteCarlo monte_carlo(double lambda, int draws) {
    Slab planes = test_planes({6, 5});
    planes.texels = {1, 1};
    planes.s_min_m = {-0.02, -0.02};
    planes.s_max_m = {0.02, 0.02};
    const Design design = make_design(planes, test_filter(planes, 0.001));
    const TileInput exact = measured(planes, design, 1, 0.0);
    FitOptions options;
    options.solve.lambda = lambda;
    options.solve.wants_sigma = true;
    FitReport report;
    const TileResult center = solve_tile(design, options, {0, 1}, exact, report);
    MonteCarlo result;
    result.predicted_sigma.assign(center.sigma.begin(), center.sigma.end());
    const auto sum_of = [](const std::vector<float>& c) {
        double sum = 0.0;
        for (const float value : c)
            sum += static_cast<double>(value);
        return sum;
    };
    options.solve.wants_sigma = false;
    double sum = 0, square = 0;
    for (std::uint32_t r = 0; r < 400; ++r) {
        TileInput drawn = exact;
        add_noise(tile_layout(design, 1, {0, 1}), {0, 1}, {1, r}, drawn);
        const double replicate = sum_of(solve_tile(design, options, {0, 1}, drawn, report).coeffs);
        sum += replicate;
        square += replicate * replicate;
    }
    result.bootstrap_sum_sigma = std::sqrt(square / 400.0 - std::pow(sum / 400.0, 2.0));
    support::Random random{21};
    result.mean.assign(30, 0.0);
    result.sigma.assign(30, 0.0);
    sum = square = 0;
    for (int n = 0; n < draws; ++n) {
        TileInput noisy = exact;
        for (std::size_t k = 0; k < noisy.value.size(); ++k)
            noisy.value[k] += static_cast<float>(std::sqrt(static_cast<double>(exact.variance[k])) *
                                                 normal_number(random));
        const TileResult fitted = solve_tile(design, options, {0, 1}, noisy, report);
        for (std::size_t m = 0; m < 30; ++m) {
            result.mean[m] += static_cast<double>(fitted.coeffs[m]) / draws;
            result.sigma[m] += std::pow(static_cast<double>(fitted.coeffs[m]), 2.0) / draws;
        }
        sum += sum_of(fitted.coeffs) / draws;
        square += std::pow(sum_of(fitted.coeffs), 2.0) / draws;
    }
    for (std::size_t m = 0; m < 30; ++m)
        result.sigma[m] = std::sqrt(result.sigma[m] - result.mean[m] * result.mean[m]);
    result.sum_sigma = std::sqrt(square - sum * sum);
    return result;
}

TEST(Sigma, IsTheSpreadUnderNoise) {
    // 4000 draws know a spread to 1.1 %. Coefficients far from the bound; there the formula is
    // exact but for the bound's effect on their neighbors.
    for (const double lambda : {0.0, 1e-3, 0.1}) {
        const MonteCarlo result = monte_carlo(lambda, 4000);
        int count = 0;
        for (std::size_t m = 0; m < 30; ++m)
            if (result.mean[m] > 6.0 * result.predicted_sigma[m]) {
                EXPECT_NEAR(result.predicted_sigma[m] / result.sigma[m], 1.0, 0.05)
                    << "lambda " << lambda << ", coefficient " << m;
                ++count;
            }
        EXPECT_GT(count, 10);
    }
}

TEST(Replicates, GiveTheSigmaOfASum) {
    // The sum of a texel's coefficients, as irradiance is one; 400 replicates know it to 3.5 %.
    for (const double lambda : {0.0, 1e-3}) {
        const MonteCarlo result = monte_carlo(lambda, 2000);
        EXPECT_NEAR(result.bootstrap_sum_sigma / result.sum_sigma, 1.0, 0.1) << lambda;
    }
}

TEST(Sigma, OneSidedIsTheCutOffNormalDistribution) {
    // By a sum over a fine grid.
    for (const double ratio : {0.0, 0.5, 2.0, 8.0, 24.9, 25.1, 60.0}) {
        double square = 0.0, mass = 0.0;
        const double step = 1e-4 / (1.0 + ratio);
        for (double x = 0.5 * step; x < 12.0 / (1.0 + 0.3 * ratio); x += step) {
            const double density = std::exp(-0.5 * x * x - ratio * x);
            mass += density;
            square += density * x * x;
        }
        EXPECT_NEAR(one_sided_rms(ratio) / std::sqrt(square / mass), 1.0, 2e-5) << ratio;
    }
}

TEST(CrossValidation, FindsTheSmoothnessThatForetellsBest) {
    const Slab planes = test_planes({8, 7});
    const Design design = make_design(planes, test_filter(planes, 0.001));
    const TileInput input = measured(planes, design, 1, 0.05);
    FitOptions options;
    SmoothnessOptions smoothness;
    smoothness.lambdas = {1e-7, 1e-4, 1e-2, 1e-1, 1.0, 1e2, 1e4};
    const SmoothnessCurve curve = cross_validate(design, options, smoothness, {0, 6}, input);
    EXPECT_GT(curve.best, 0U);
    EXPECT_LT(curve.best, 6U);
    EXPECT_EQ(curve.held_out_count, 56 * 48);
    EXPECT_GT(curve.chi_square.front(), curve.chi_square[curve.best] + curve.sigma.front());
    EXPECT_GT(curve.chi_square.back(), 1.5 * curve.chi_square[curve.best]);
    EXPECT_EQ(curve.sigma[curve.best], 0.0);
    // What foretells unseen measurements best also comes nearest to the truth, within a step.
    std::vector<double> error;
    for (const double lambda : smoothness.lambdas) {
        options.solve.lambda = lambda;
        FitReport report;
        const TileResult fitted = solve_tile(design, options, {0, 6}, input, report);
        double square = 0.0;
        for (int t = 0; t < 48; ++t) {
            const std::vector<double> truth = truth_of(planes, t % 8, t / 8);
            for (std::size_t m = 0; m < truth.size(); ++m)
                square += std::pow(
                    static_cast<double>(fitted.coeffs[m * 48 + static_cast<std::size_t>(t)]) -
                        truth[m],
                    2.0);
        }
        error.push_back(square);
    }
    const auto nearest = std::min_element(error.begin(), error.end()) - error.begin();
    EXPECT_LE(std::abs(nearest - static_cast<std::ptrdiff_t>(curve.best)), 1);
}

TEST(CrossValidation, DealsPositionsOutEvenly) {
    const std::vector<int> fold = folds_of(99, 5, 1);
    for (int f = 0; f < 5; ++f)
        EXPECT_NEAR(static_cast<double>(std::count(fold.begin(), fold.end(), f)), 19.8, 1.0);
    EXPECT_NE(fold, folds_of(99, 5, 2));
}

TEST(CrossValidation, RefusesWhatCannotBeAsked) {
    const Slab planes = test_planes({4, 3});
    const Design design = make_design(planes, test_filter(planes, 0.0));
    TileInput input = measured(planes, design, 1, 1e-3);
    SmoothnessOptions smoothness;
    smoothness.folds = 1;
    EXPECT_THROW((void)cross_validate(design, {}, smoothness, {0, 6}, input), Error);
    smoothness.folds = 13;
    EXPECT_THROW((void)cross_validate(design, {}, smoothness, {0, 6}, input), Error);
    smoothness.folds = 3;
    smoothness.lambdas.clear();
    EXPECT_THROW((void)cross_validate(design, {}, smoothness, {0, 6}, input), Error);
    smoothness.lambdas = {1e-3};
    std::fill(input.variance.begin(), input.variance.end(), kInfinity);
    EXPECT_THROW((void)cross_validate(design, {}, smoothness, {0, 6}, input), Error);
}

TEST(Conditioning, IsThatOfBSplineConvolutions) {
    // On an endless grid the symbol of the quintic B-spline runs from 1 to 16/120 (at the Nyquist
    // frequency), in two dimensions squared, in the normal matrix squared again: 3164 after
    // scaling. A finite grid stays below.
    const Slab planes = test_planes({15, 15});
    TexelDesign texel;
    fill_texel_design(make_design(planes, test_filter(planes, 0.0)), 0, 0, texel);
    const Conditioning all = conditioning(texel, std::vector<double>(225, 2.0));
    EXPECT_LT(all.condition, 3164.0);
    EXPECT_GT(all.condition, 1800.0);
    EXPECT_EQ(all.unseen_count, 0);
    std::vector<double> one(225, 0.0);
    one[0] = 1.0;
    const Conditioning alone = conditioning(texel, one);
    EXPECT_EQ(alone.condition, std::numeric_limits<double>::infinity());
    EXPECT_EQ(alone.unseen_count, 225 - 9);
}

TEST(RepresentationError, IsNoneInTheBasisAndSomeBesideIt) {
    const Slab planes = test_planes({8, 7});
    const Design design = make_design(planes, test_filter(planes, 0.001));
    Optics between = test_filter(planes, 0.0);
    between.sensor = Sensor::Camera;
    for (glm::dvec3& p : between.position_m)
        p += glm::dvec3(0.25 * planes.pitch_m, 0.0);
    const Design check_design = make_design(planes, between);
    const FitOptions options;
    const RepresentationError in_basis =
        representation_error(design, options, {0, 6}, measured(planes, design, 1, 0.0),
                             check_design, measured(planes, check_design, 1, 0.0));
    EXPECT_LT(in_basis.data_rms_rel, 1e-6);
    EXPECT_LT(in_basis.check_rms_rel, 1e-4);
    // The same light of a lamp whose functions are narrower than the basis: the basis misses some.
    Slab finer = planes;
    finer.profile = model::make_profile("box");
    const Design finer_design = make_design(finer, test_filter(finer, 0.001));
    const Design finer_check = make_design(finer, between);
    const RepresentationError beside =
        representation_error(design, options, {0, 6}, measured(finer, finer_design, 1, 0.0),
                             check_design, measured(finer, finer_check, 1, 0.0));
    EXPECT_GT(beside.data_rms_rel, 1e-4);
    EXPECT_GT(beside.check_rms_rel, 0.05);
    EXPECT_GT(beside.check_rms_rel, 5.0 * beside.data_rms_rel);
}

}  // namespace
}  // namespace nearfield::fit
