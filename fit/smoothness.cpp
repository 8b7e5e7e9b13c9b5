// SPDX-License-Identifier: Apache-2.0
#include "fit/smoothness.h"

#include "formats/files/error.h"
#include "formats/shared/rng.glsl.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace nearfield::fit {
namespace {

struct FoldScratch {
    TexelDesign texel;
    Workspace work;
    TexelFit fit;
    TexelData data;
    std::vector<double> held_weight;
};

struct Question {
    const Design& design;
    const FitOptions& options;
    const SmoothnessOptions& smoothness;
    const Penalty& penalty;
    const std::vector<int>& fold;
    TileRange rows;
    TileLayout layout;
    const TileInput& input;
};

// Sums over texels and channels of a row; by lambda.
struct RowSums {
    std::vector<double> chi_square;
    /// Sum over texels of products of two lambdas' chi-squares: [lambda][lambda].
    std::vector<double> product;
    std::int64_t held_out = 0, texels = 0;
};

// Chi-square of the measurements of all folds, each foretold by the others.
double foretold_chi_square(const Question& q, double lambda, FoldScratch& s) {
    SolveOptions solve = q.options.solve;
    solve.lambda = lambda;
    solve.wants_sigma = false;
    double sum = 0.0;
    for (int fold = 0; fold < q.smoothness.folds; ++fold) {
        s.held_weight = s.data.weight;
        for (std::size_t k = 0; k < s.data.weight.size(); ++k)
            if (q.fold[k] == fold)
                s.held_weight[k] = 0.0;
        solve_texel(s.texel, q.penalty, s.data.b, s.held_weight, solve, s.work, s.fit);
        for (std::size_t k = 0; k < s.data.weight.size(); ++k)
            if (q.fold[k] == fold && s.data.weight[k] > 0.0) {
                const double off =
                    predicted(s.texel, static_cast<int>(k), s.fit.coeffs) - s.data.b[k];
                sum += s.data.weight[k] * off * off;
            }
    }
    return sum;
}

RowSums ask_row(const Question& q, std::size_t row, FoldScratch& s) {
    const std::size_t count = q.smoothness.lambdas.size();
    RowSums sums{std::vector<double>(count, 0.0), std::vector<double>(count * count, 0.0), 0, 0};
    std::vector<double> chi_square(count);
    s.fit.is_free.clear();
    for (int i = 0; i < q.design.texels.x; i += q.smoothness.texel_step) {
        fill_texel_design(q.design, i, q.rows.first_row + static_cast<int>(row), s.texel);
        for (int channel = 0; channel < q.options.channels; ++channel) {
            if (!read_texel(q.input, q.layout, static_cast<std::size_t>(channel), row,
                            static_cast<std::size_t>(i), q.options.model_error_rel, s.data))
                continue;
            for (std::size_t l = 0; l < count; ++l)
                chi_square[l] = foretold_chi_square(q, q.smoothness.lambdas[l], s);
            for (std::size_t a = 0; a < count; ++a) {
                sums.chi_square[a] += chi_square[a];
                for (std::size_t b = 0; b < count; ++b)
                    sums.product[a * count + b] += chi_square[a] * chi_square[b];
            }
            sums.held_out += std::count_if(s.data.weight.begin(), s.data.weight.end(),
                                           [](double w) { return w > 0.0; });
            ++sums.texels;
        }
    }
    return sums;
}

RowSums added(RowSums a, const RowSums& b) {
    for (std::size_t l = 0; l < a.chi_square.size(); ++l)
        a.chi_square[l] += b.chi_square[l];
    for (std::size_t l = 0; l < a.product.size(); ++l)
        a.product[l] += b.product[l];
    a.held_out += b.held_out;
    a.texels += b.texels;
    return a;
}

SmoothnessCurve curve_of(const SmoothnessOptions& smoothness, const RowSums& sums) {
    const std::size_t count = smoothness.lambdas.size();
    SmoothnessCurve curve;
    curve.lambda = smoothness.lambdas;
    curve.held_out_count = sums.held_out;
    const auto held_out = static_cast<double>(sums.held_out);
    const auto texels = static_cast<double>(sums.texels);
    for (const double chi_square : sums.chi_square)
        curve.chi_square.push_back(chi_square / held_out);
    curve.best = static_cast<std::size_t>(
        std::min_element(curve.chi_square.begin(), curve.chi_square.end()) -
        curve.chi_square.begin());
    const auto product = [&](std::size_t a, std::size_t b) { return sums.product[a * count + b]; };
    for (std::size_t l = 0; l < count; ++l) {
        const double mean = (sums.chi_square[l] - sums.chi_square[curve.best]) / texels;
        const double square =
            (product(l, l) - 2.0 * product(l, curve.best) + product(curve.best, curve.best)) /
            texels;
        curve.sigma.push_back(std::sqrt(std::max(0.0, square - mean * mean) * texels) / held_out);
    }
    return curve;
}

void check_question(const Design& design,
                    const FitOptions& options,
                    const SmoothnessOptions& smoothness,
                    TileRange rows,
                    const TileInput& input) {
    check(options);
    if (smoothness.lambdas.empty())
        throw Error{"cannot cross-validate", "lambdas", "at least one", "none"};
    if (smoothness.texel_step < 1)
        throw Error{"cannot cross-validate", "texel_step", ">= 1",
                    fmt::format("{}", smoothness.texel_step)};
    if (smoothness.folds < 2 || smoothness.folds > design.measurement_count)
        throw Error{"cannot cross-validate", "folds",
                    fmt::format("2 ... {} (measurements)", design.measurement_count),
                    fmt::format("{}", smoothness.folds)};
    const std::size_t wanted = static_cast<std::size_t>(options.channels) *
                               static_cast<std::size_t>(design.measurement_count) *
                               static_cast<std::size_t>(rows.row_count) *
                               static_cast<std::size_t>(design.texels.x);
    if (input.value.size() != wanted || input.variance.size() != wanted)
        throw Error{"bad tile", "cross-validation", fmt::format("{} values", wanted),
                    fmt::format("{}", input.value.size())};
}

}  // namespace

std::vector<int> folds_of(int measurement_count, int folds, std::uint64_t seed) {
    std::vector<std::pair<std::uint32_t, int>> order;
    order.reserve(static_cast<std::size_t>(std::max(measurement_count, 0)));
    for (int k = 0; k < measurement_count; ++k)
        order.emplace_back(shared::hash4(glm::uvec4(static_cast<std::uint32_t>(seed),
                                                    static_cast<std::uint32_t>(seed >> 32U),
                                                    static_cast<std::uint32_t>(k), 0x666f6c64U))
                               .x,
                           k);
    std::sort(order.begin(), order.end());
    std::vector<int> fold(order.size());
    for (std::size_t rank = 0; rank < order.size(); ++rank)
        fold[static_cast<std::size_t>(order[rank].second)] = static_cast<int>(rank) % folds;
    return fold;
}

SmoothnessCurve cross_validate(const Design& design,
                               const FitOptions& options,
                               const SmoothnessOptions& smoothness,
                               TileRange rows,
                               const TileInput& input) {
    check_question(design, options, smoothness, rows, input);
    const Penalty penalty = difference_penalty(design.grid, options.solve.difference_order);
    const std::vector<int> fold =
        folds_of(design.measurement_count, smoothness.folds, smoothness.seed);
    const Question question{design,
                            options,
                            smoothness,
                            penalty,
                            fold,
                            rows,
                            tile_layout(design, options.channels, rows),
                            input};
    std::vector<RowSums> row_sums(static_cast<std::size_t>(rows.row_count));
    tbb::enumerable_thread_specific<FoldScratch> scratch;
    tbb::parallel_for(std::size_t{0}, row_sums.size(), [&](std::size_t row) {
        row_sums[row] = ask_row(question, row, scratch.local());
    });
    const RowSums sums =
        std::accumulate(row_sums.begin() + 1, row_sums.end(), row_sums.front(), added);
    if (sums.held_out == 0)
        throw Error{"cannot cross-validate", "measurements", "at least one valid", "none"};
    return curve_of(smoothness, sums);
}

}  // namespace nearfield::fit
