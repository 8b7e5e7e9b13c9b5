// SPDX-License-Identifier: Apache-2.0
// The solver against a dense one, and its own proof of the minimum.
#include "fit/solve.h"

#include "fit/lawson_hanson.h"
#include "formats/files/error.h"
#include "tests/fit/bench_planes.h"
#

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nearfield::fit {
namespace {

// Left by the ridge of 1e-12 that keeps the normal matrix definite.
constexpr double kKktLimit = 1e-11;

struct Data {
    std::vector<double> b, weight;
};

// Light of a round lens with a bright spot, dark outside, and noise as a camera has it.
Data lamp_data(const TexelDesign& texel, std::uint64_t seed, double missing_share) {
    support::Random random{seed};
    std::vector<double> truth;
    for (int m = 0; m < texel.grid.x * texel.grid.y; ++m) {
        const int row = m / texel.grid.x;
        const glm::dvec2 x(m % texel.grid.x - 4.6, row - 4.2);
        truth.push_back(glm::length(x) < 4.0 ? 1.0 + 50.0 * std::exp(-glm::dot(x, x)) : 0.0);
    }
    Data data;
    for (int k = 0; k < texel.measurement_count; ++k) {
        const double light = predicted(texel, k, truth);
        const double variance = 1e-12 + 1e-6 * light;
        data.b.push_back(light + std::sqrt(variance) * normal_number(random));
        data.weight.push_back(random.uniform() < missing_share ? 0.0 : 1.0 / variance);
    }
    return data;
}

// The same problem as a dense matrix: weighted rows of G, then rows of D.
std::vector<double> dense_solution(const TexelDesign& texel,
                                   const Data& data,
                                   double lambda,
                                   int order,
                                   LeastSquares kept = LeastSquares::Updated) {
    const int columns = texel.grid.x, n = columns * texel.grid.y;
    std::vector<double> a = dense(texel), b = data.b;
    std::vector<double> inverse(static_cast<std::size_t>(n), 0.0);
    for (std::size_t k = 0; k < b.size(); ++k) {
        const double root = std::sqrt(data.weight[k]);
        b[k] *= root;
        for (int m = 0; m < n; ++m) {
            double& entry = a[k * static_cast<std::size_t>(n) + static_cast<std::size_t>(m)];
            entry *= root;
            inverse[static_cast<std::size_t>(m)] += entry * entry;
        }
    }
    for (double& d : inverse)
        d = 1.0 / d;
    const std::vector<double> stencil =
        order == 1 ? std::vector<double>{-1, 1} : std::vector<double>{1, -2, 1};
    for (int m = 0; m < n; ++m)
        for (const int step : {1, columns}) {
            const int place = step == 1 ? m % columns : m / columns;
            const int length = step == 1 ? columns : texel.grid.y;
            if (place + order >= length)
                continue;
            std::vector<double> row(static_cast<std::size_t>(n), 0.0);
            double sum = 0.0;
            for (int p = 0; p <= order; ++p)
                sum += inverse[static_cast<std::size_t>(m + p * step)];
            const double root = std::sqrt(lambda * (order + 1) / sum);
            for (int p = 0; p <= order; ++p)
                row[static_cast<std::size_t>(m + p * step)] =
                    root * stencil[static_cast<std::size_t>(p)];
            a.insert(a.end(), row.begin(), row.end());
            b.push_back(0.0);
        }
    return lawson_hanson(a, b, n, kept);
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0.0, most = 0.0;
    for (std::size_t m = 0; m < a.size(); ++m) {
        worst = std::max(worst, std::abs(a[m] - b[m]));
        most = std::max(most, std::abs(b[m]));
    }
    return worst / most;
}

TexelDesign texel_of(const Slab& planes, double error_m) {
    TexelDesign texel;
    fill_texel_design(make_design(planes, test_filter(planes, error_m)), 3, 2, texel);
    return texel;
}

TEST(SolveTexel, EqualsDenseNonNegativeLeastSquares) {
    // Of every kind: smooth or not, measurements missing or not, profiles narrow and wide.
    for (const char* basis : {"box", "bilinear", "quadratic", "bspline"})
        for (const double lambda : {1e-6, 1e-3, 1.0})
            for (const int order : {1, 2}) {
                const TexelDesign texel = texel_of(test_planes({11, 9}, basis), 0.001);
                const Penalty penalty = difference_penalty({11, 9}, order);
                Workspace work;
                TexelFit fit;
                for (std::uint64_t seed = 1; seed < 7; ++seed) {
                    const Data data = lamp_data(texel, seed, 0.05 * static_cast<double>(seed - 1));
                    solve_texel(texel, penalty, data.b, data.weight, {lambda, order, false}, work,
                                fit);
                    EXPECT_TRUE(fit.has_converged);
                    EXPECT_LT(fit.kkt_rel, kKktLimit);
                    const LeastSquares kept =
                        seed == 2 ? LeastSquares::Fresh : LeastSquares::Updated;
                    EXPECT_LT(largest_difference(fit.coeffs,
                                                 dense_solution(texel, data, lambda, order, kept)),
                              1e-6)
                        << basis << " lambda " << lambda << " order " << order << " seed " << seed;
                    EXPECT_GE(*std::min_element(fit.coeffs.begin(), fit.coeffs.end()), 0.0);
                }
            }
}

TEST(SolveTexel, EqualsDenseSolutionWithoutSmoothing) {
    const TexelDesign texel = texel_of(test_planes(), 0.001);
    const Penalty penalty = difference_penalty({11, 9}, 2);
    Workspace work;
    TexelFit fit;
    int at_bound = 0;
    for (std::uint64_t seed = 1; seed < 9; ++seed) {
        const Data data = lamp_data(texel, seed, 0.0);
        solve_texel(texel, penalty, data.b, data.weight, {}, work, fit);
        at_bound += 99 - fit.free_count;
        EXPECT_LT(fit.kkt_rel, kKktLimit);
        EXPECT_LT(largest_difference(fit.coeffs, dense_solution(texel, data, 0.0, 2)), 1e-6);
    }
    EXPECT_GT(at_bound, 100);  // else the bound is not tested
}

TEST(SolveTexel, GivesBackNoiseFreeCoefficients) {
    const TexelDesign texel = texel_of(test_planes(), 0.002);
    support::Random random{5};
    std::vector<double> truth(99);
    for (double& c : truth)
        c = random.uniform() < 0.3 ? 0.0 : std::exp(random.uniform(-4.0, 4.0));
    std::vector<double> b, weight(99, 1e8);
    for (int k = 0; k < 99; ++k)
        b.push_back(predicted(texel, k, truth));
    Workspace work;
    TexelFit fit;
    solve_texel(texel, difference_penalty({11, 9}, 2), b, weight, {}, work, fit);
    EXPECT_LT(largest_difference(fit.coeffs, truth), 1e-8);
}

TEST(SolveTexel, DoesNotDependOnWhereItStarts) {
    const TexelDesign texel = texel_of(test_planes(), 0.001);
    const Penalty penalty = difference_penalty({11, 9}, 2);
    const Data data = lamp_data(texel, 3, 0.1);
    Workspace work;
    TexelFit cold;
    solve_texel(texel, penalty, data.b, data.weight, {1e-4, 2, false}, work, cold);
    support::Random random{1};
    for (int start = 0; start < 20; ++start) {
        TexelFit warm;
        for (int m = 0; m < 99; ++m)
            warm.is_free.push_back(random.uniform() < 0.05 * start ? 1 : 0);
        solve_texel(texel, penalty, data.b, data.weight, {1e-4, 2, false}, work, warm);
        EXPECT_EQ(warm.is_free, cold.is_free) << start;
        // Coefficients have other places in the factor, so that rounding differs.
        for (std::size_t m = 0; m < 99; ++m)
            ASSERT_NEAR(warm.coeffs[m], cold.coeffs[m], 1e-11) << start;
    }
}

TEST(SolveTexel, LeavesMissingMeasurementsOut) {
    // Whatever stands where the weight is 0.
    const TexelDesign texel = texel_of(test_planes(), 0.001);
    const Penalty penalty = difference_penalty({11, 9}, 2);
    Data data = lamp_data(texel, 2, 0.2);
    Workspace work;
    TexelFit a, b;
    solve_texel(texel, penalty, data.b, data.weight, {1e-4, 2, false}, work, a);
    for (std::size_t k = 0; k < data.b.size(); ++k)
        if (data.weight[k] == 0.0)
            data.b[k] = 1e30;
    solve_texel(texel, penalty, data.b, data.weight, {1e-4, 2, false}, work, b);
    EXPECT_EQ(a.coeffs, b.coeffs);
    EXPECT_EQ(a.valid_count, b.valid_count);
    EXPECT_LT(a.valid_count, 99);
}

TEST(SolveTexel, IsTheSameInOtherUnitsOfLight) {
    const TexelDesign texel = texel_of(test_planes(), 0.001);
    const Penalty penalty = difference_penalty({11, 9}, 2);
    const Data data = lamp_data(texel, 4, 0.1);
    Data scaled = data;
    for (std::size_t k = 0; k < data.b.size(); ++k) {
        scaled.b[k] *= 1e7;
        scaled.weight[k] *= 1e-9;
    }
    Workspace work;
    TexelFit a, b;
    solve_texel(texel, penalty, data.b, data.weight, {1e-2, 2, false}, work, a);
    solve_texel(texel, penalty, scaled.b, scaled.weight, {1e-2, 2, false}, work, b);
    for (std::size_t m = 0; m < 99; ++m)
        EXPECT_NEAR(b.coeffs[m] * 1e-7, a.coeffs[m], 1e-9 * (1.0 + a.coeffs[m]));
}

// Proves that sigma is of the noise alone: where a quarter of every variance is noise, sigmas of
// free coefficients are half as large, and the estimate is the same.
TEST(SolveTexel, SigmaIsOfTheNoiseAlone) {
    const TexelDesign texel = texel_of(test_planes(), 0.001);
    const Penalty penalty = difference_penalty({11, 9}, 2);
    const Data data = lamp_data(texel, 3, 0.1);
    const std::vector<double> quarter(data.b.size(), 0.25);
    Workspace work;
    TexelFit all, part;
    solve_texel(texel, penalty, data.b, data.weight, {1e-3, 2, true}, work, all);
    solve_texel(texel, penalty, data.b, data.weight, {1e-3, 2, true}, work, part, quarter);
    EXPECT_EQ(all.coeffs, part.coeffs);
    for (std::size_t m = 0; m < all.coeffs.size(); ++m)
        if (all.is_free[m] != 0) {
            EXPECT_NEAR(part.sigma[m] / all.sigma[m], 0.5, 1e-9) << m;
        }
}

TEST(SolveTexel, AnswersTexelsThatNothingSees) {
    const TexelDesign texel = texel_of(test_planes(), 0.001);
    const std::vector<double> none(99, 0.0);
    Workspace work;
    TexelFit fit;
    solve_texel(texel, difference_penalty({11, 9}, 2), none, none, {1e-2, 2, true}, work, fit);
    EXPECT_EQ(fit.coeffs, none);
    EXPECT_EQ(fit.valid_count, 0);
    EXPECT_EQ(fit.sigma[50], std::numeric_limits<double>::infinity());
    // And dark ones.
    const std::vector<double> one(99, 1.0);
    solve_texel(texel, difference_penalty({11, 9}, 2), none, one, {1e-2, 2, true}, work, fit);
    EXPECT_EQ(fit.coeffs, none);
    EXPECT_TRUE(std::isfinite(fit.sigma[50]));
}

TEST(SolveTexel, RefusesWhatIsNoNumber) {
    const TexelDesign texel = texel_of(test_planes(), 0.001);
    const Penalty penalty = difference_penalty({11, 9}, 2);
    Workspace work;
    TexelFit fit;
    std::vector<double> b(99, 1.0), weight(99, 1.0);
    b[4] = std::nan("");
    EXPECT_THROW(solve_texel(texel, penalty, b, weight, {}, work, fit), Error);
    b[4] = 1.0;
    weight[98] = -1.0;
    EXPECT_THROW(solve_texel(texel, penalty, b, weight, {}, work, fit), Error);
    weight[98] = std::numeric_limits<double>::infinity();
    EXPECT_THROW(solve_texel(texel, penalty, b, weight, {}, work, fit), Error);
    weight.pop_back();
    EXPECT_THROW(solve_texel(texel, penalty, b, weight, {}, work, fit), Error);
}

}  // namespace
}  // namespace nearfield::fit
