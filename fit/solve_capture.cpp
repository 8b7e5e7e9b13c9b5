// SPDX-License-Identifier: Apache-2.0
#include "fit/solve_capture.h"

#include "fit/replicates.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nearfield::fit {
namespace {

constexpr int kFewTexels = 20;  // of a row, where a question is asked many times

// Rows about the brightest one, in which smoothness is chosen.
TileRange bright_rows(const MeasuredTexels& texels) {
    constexpr int kRows = 12;
    int brightest = 0;
    double most = -1;
    for (int row = 0; row < texels.texels().y; ++row) {
        const TileInput tile = texels.read({row, 1});
        const auto count = static_cast<std::ptrdiff_t>(texels.positions()) * texels.texels().x;
        const double sum = std::accumulate(tile.value.begin(), tile.value.begin() + count, 0.0);
        if (sum > most) {
            most = sum;
            brightest = row;
        }
    }
    const int rows = std::min(kRows, texels.texels().y);
    return {std::clamp(brightest - rows / 2, 0, texels.texels().y - rows), rows};
}

SmoothnessCurve cross_validate_some(const MeasuredTexels& texels,
                                    const Design& design,
                                    const FitOptions& solve,
                                    int texels_asked,  // of a row
                                    SmoothnessOptions smoothness) {
    smoothness.texel_step = std::max(1, texels.texels().x / texels_asked);
    smoothness.folds = std::min(smoothness.folds, texels.positions());
    const TileRange rows = bright_rows(texels);
    return cross_validate(design, solve, smoothness, rows, texels.read(rows));
}

// One fit of a half, of two thirds, ... of the positions foretells the rest.
PositionShares position_shares(const MeasuredTexels& texels,
                               const Design& design,
                               const FitOptions& solve,
                               int texels_asked,
                               std::uint64_t seed) {
    PositionShares shares;
    for (const int folds : {2, 3, 5, 10}) {
        if (folds > texels.positions())
            break;
        SmoothnessOptions smoothness;
        smoothness.lambdas = {solve.solve.lambda};
        smoothness.folds = folds;
        smoothness.seed = seed;
        shares.share.push_back(1.0 - 1.0 / folds);
        shares.chi_square.push_back(
            cross_validate_some(texels, design, solve, texels_asked, smoothness).chi_square[0]);
    }
    return shares;
}

// The error that makes chi-square of foretold measurements one by measurement, at the smoothness
// that foretells best with it: each depends on the other, from least error upwards.
void choose_model_error(const MeasuredTexels& texels,
                        const Design& design,
                        const std::optional<double>& lambda,
                        std::uint64_t seed,
                        FitOptions& solve) {
    constexpr double kLeast = 1e-3, kMost = 1;
    constexpr double kNear = 1.1;
    constexpr int kRounds = 8;
    SmoothnessOptions smoothness;
    smoothness.seed = seed;
    smoothness.lambdas =
        lambda ? std::vector<double>{*lambda} : std::vector<double>{1e-4, 1e-3, 1e-2, 1e-1};
    solve.model_error_rel = kLeast;
    for (int round = 0; round < kRounds; ++round) {
        const SmoothnessCurve curve =
            cross_validate_some(texels, design, solve, kFewTexels, smoothness);
        const double wanted = std::clamp(
            solve.model_error_rel * std::sqrt(curve.chi_square[curve.best]), kLeast, kMost);
        const double step = wanted / solve.model_error_rel;
        if (step < kNear && step > 1 / kNear)
            break;
        solve.model_error_rel = wanted;
    }
}

// Where nothing was seen a coefficient could be as bright as any.
void bound_sigma(Slab& slab) {
    const float brightest = *std::max_element(slab.coeffs.begin(), slab.coeffs.end());
    for (float& sigma : slab.sigma)
        if (!std::isfinite(sigma))
            sigma = brightest;
}

// A tile's rows of all images to where they are in the slab's.
void copy_rows(const Slab& slab,
               TileRange rows,
               const std::vector<float>& from,
               std::vector<float>& to) {
    const auto width = static_cast<std::size_t>(slab.texels.x);
    const std::size_t first = static_cast<std::size_t>(rows.first_row) * width;
    const std::size_t count = static_cast<std::size_t>(rows.row_count) * width;
    for (std::size_t image = 0; image * count < from.size(); ++image)
        std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(image * count), count,
                    to.begin() + static_cast<std::ptrdiff_t>(image * slab.texel_count() + first));
}

void keep_chi_square(const TileResult& tile, CaptureFit& fit) {
    const Slab& planes = fit.lightfield.slabs.front();
    const auto width = static_cast<std::size_t>(planes.texels.x);
    const std::size_t first = static_cast<std::size_t>(tile.rows.first_row) * width;
    const std::size_t count = static_cast<std::size_t>(tile.rows.row_count) * width;
    for (std::size_t t = 0; t < count; ++t) {
        const int freedom = tile.valid_count[t] - tile.free_count[t];
        fit.chi_square[first + t] =
            freedom > 0 ? tile.chi_square[t] / static_cast<float>(freedom) : 0;
    }
}

// The whole fit again, of other noise and behind another calibration.
void solve_replicate(const RectifiedCapture& capture,
                     const FitOptions& solve,
                     Draw draw,
                     const FitSink& sink) {
    const Design design = make_design(capture.planes, capture.drawn_optics[draw.replicate]);
    FitOptions same = solve;
    same.solve.wants_sigma = false;
    solve_lightfield(
        design, same,
        [&](TileRange rows) {
            TileInput tile = capture.texels.read(rows);
            add_noise(tile_layout(design, solve.channels, rows), rows, draw, tile);
            return tile;
        },
        [&](const TileResult& tile) {
            sink.put_replicate(static_cast<int>(draw.replicate), tile.rows, tile.coeffs);
        });
}

}  // namespace

CaptureFit solve_capture(const RectifiedCapture& capture,
                         const Optics& optics,
                         const CaptureFitOptions& options,
                         const FitSink& sink) {
    const double start_s = now_s();
    const MeasuredTexels& texels = capture.texels;
    const Design design = make_design(capture.planes, optics);
    CaptureFit fit = capture.seen;
    fit.lightfield.scale_sigma_rel = capture.scale_sigma_rel;
    fit.lightfield.slabs = {capture.planes};
    fit.replicates = options.replicates;
    FitOptions solve;
    solve.channels = texels.channels();
    solve.solve.wants_sigma = true;
    solve.keeps_light = true;
    solve.tile_bytes = options.tile_bytes;
    constexpr int kManyTexels = 50;
    solve.model_error_rel = options.model_error_rel.value_or(0.0);
    if (!options.model_error_rel)
        choose_model_error(texels, design, options.lambda, options.seed, solve);
    SmoothnessOptions smoothness;
    smoothness.seed = options.seed;
    if (!options.lambda)
        fit.smoothness = cross_validate_some(texels, design, solve, kManyTexels, smoothness);
    fit.model_error_rel = solve.model_error_rel;
    fit.lambda = options.lambda ? *options.lambda : fit.smoothness.lambda[fit.smoothness.best];
    solve.solve.lambda = fit.lambda;
    fit.shares = position_shares(texels, design, solve, kFewTexels, options.seed);
    const double chosen_s = now_s();
    fit.smoothness_s = chosen_s - start_s;
    fit.chi_square.resize(capture.planes.texel_count());
    // A replicate takes no sigmas and about half the time.
    const double parts = 1 + 0.5 * options.replicates;
    const auto progress = [&](double part, const std::string& what) {
        if (options.progress)
            options.progress(kMergeShare + (1 - kMergeShare) * part / parts, what);
    };
    fit.report = solve_lightfield(
        design, solve, [&](TileRange rows) { return texels.read(rows); },
        [&](const TileResult& tile) {
            keep_chi_square(tile, fit);
            sink.put(tile);
        },
        [&](double fraction) { progress(fraction, "solve"); });
    for (int r = 0; r < options.replicates; ++r) {
        solve_replicate(capture, solve, {options.seed, static_cast<std::uint32_t>(r)}, sink);
        progress(1 + 0.5 * (r + 1), fmt::format("replicate {} of {}", r + 1, options.replicates));
    }
    fit.solve_s = now_s() - chosen_s;
    return fit;
}

CaptureFit solve_capture(const RectifiedCapture& capture,
                         const Optics& optics,
                         const CaptureFitOptions& options) {
    Slab slab = capture.planes;
    slab.coeffs.resize(static_cast<std::size_t>(slab.channels) *
                       static_cast<std::size_t>(slab.image_count()) * slab.texel_count());
    slab.sigma.resize(slab.coeffs.size());
    slab.replicates.assign(static_cast<std::size_t>(options.replicates),
                           std::vector<float>(slab.coeffs.size()));
    FitSink sink;
    sink.put = [&slab](const TileResult& tile) {
        copy_rows(slab, tile.rows, tile.coeffs, slab.coeffs);
        copy_rows(slab, tile.rows, tile.sigma, slab.sigma);
    };
    sink.put_replicate = [&slab](int r, TileRange rows, const std::vector<float>& coeffs) {
        copy_rows(slab, rows, coeffs, slab.replicates[static_cast<std::size_t>(r)]);
    };
    CaptureFit fit = solve_capture(capture, optics, options, sink);
    bound_sigma(slab);
    fit.lightfield.slabs = {std::move(slab)};
    return fit;
}

}  // namespace nearfield::fit
