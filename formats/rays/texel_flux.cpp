// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/texel_flux.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nearfield::rays {
namespace {

// Texels across the rectangle's larger side that are tried, and kernel widths in texels.
constexpr std::array kTexelsAcross = {8,  12,  16,  20,  24,  28,  32,  40,  48,  56,  64, 80,
                                      96, 112, 128, 160, 192, 224, 256, 320, 384, 448, 512};
constexpr std::array kKernels = {0.0, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0};
// Fewer rays than this a texel, averaged over the rectangle, are not worth their coefficients: the
// kernel would only merge the texels again, and some measured files carry a raster of start
// positions that finer texels would show.
constexpr double kLeastRaysPerTexel = 8.0;

// Gaussian weights at 0, 1, ... texels; each source spreads a total of one.
std::vector<double> gaussian(double sigma) {
    std::vector<double> weights = {1.0};
    for (int i = 1; i <= static_cast<int>(std::ceil(4.0 * sigma)); ++i)
        weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    return weights;
}

// Spreads `values` along x or y; what would leave the rectangle stays inside, so that every source
// gives all it has. With `squared`, each source's weights are squared: propagates variances.
std::vector<double> spread(const std::vector<double>& values,
                           glm::ivec2 texels,
                           bool along_x,
                           const std::vector<double>& kernel,
                           bool squared) {
    const int length = along_x ? texels.x : texels.y;
    const int lines = along_x ? texels.y : texels.x;
    const int radius = static_cast<int>(kernel.size()) - 1;
    const auto at = [&](int line, int i) {
        return static_cast<std::size_t>(along_x ? line : i) * static_cast<std::size_t>(texels.x) +
               static_cast<std::size_t>(along_x ? i : line);
    };
    std::vector<double> norm(static_cast<std::size_t>(length));
    for (int i = 0; i < length; ++i)
        for (int k = std::max(0, i - radius); k <= std::min(length - 1, i + radius); ++k)
            norm[static_cast<std::size_t>(i)] += kernel[static_cast<std::size_t>(std::abs(k - i))];
    std::vector<double> out(values.size());
    for (int line = 0; line < lines; ++line)
        for (int i = 0; i < length; ++i) {
            const double value = values[at(line, i)];
            if (value == 0.0)
                continue;
            for (int k = std::max(0, i - radius); k <= std::min(length - 1, i + radius); ++k) {
                const double w = kernel[static_cast<std::size_t>(std::abs(k - i))] /
                                 norm[static_cast<std::size_t>(i)];
                out[at(line, k)] += value * (squared ? w * w : w);
            }
        }
    return out;
}

std::vector<double> smooth(const std::vector<double>& values,
                           glm::ivec2 texels,
                           double kernel_texels,
                           bool squared = false) {
    if (kernel_texels == 0.0)
        return values;
    const std::vector<double> kernel = gaussian(kernel_texels);
    return spread(spread(values, texels, true, kernel, squared), texels, false, kernel, squared);
}

// Square texels, `across` of them along the larger side.
glm::ivec2 square_texels(const Rectangle& rectangle, int across) {
    const glm::dvec2 size = rectangle.max_m - rectangle.min_m;
    const double texel = std::max(size.x, size.y) / across;
    return glm::max(glm::ivec2(1), glm::ivec2(glm::round(size / texel)));
}

// Flux of each texel by fold: [fold][texel].
std::vector<std::vector<double>> fold_histograms(const std::vector<Crossing>& crossings,
                                                 const TexelGrid& grid,
                                                 std::uint64_t seed) {
    std::vector<std::vector<double>> folds(kFolds, std::vector<double>(grid.count()));
    for (const Crossing& c : crossings)
        folds[static_cast<std::size_t>(fold_of(c.ray, seed))][grid.index(c.s_m)] += c.flux;
    return folds;
}

// Mean log density (per texel of an even grid, relative to even light) that the other folds give to
// a fold's rays.
double held_out_nats(const std::vector<std::vector<double>>& folds,
                     glm::ivec2 texels,
                     double kernel_texels) {
    std::vector<double> total(folds.front().size());
    for (const auto& fold : folds)
        for (std::size_t t = 0; t < total.size(); ++t)
            total[t] += fold[t];
    std::vector<double> scores(folds.size()), weights(folds.size());
    tbb::parallel_for(std::size_t{0}, folds.size(), [&](std::size_t f) {
        std::vector<double> train(total.size());
        double train_flux = 0.0;
        for (std::size_t t = 0; t < total.size(); ++t)
            train_flux += train[t] = std::max(0.0, total[t] - folds[f][t]);
        if (!(train_flux > 0.0))
            return;
        train = smooth(train, texels, kernel_texels);
        const double scale = static_cast<double>(total.size()) / train_flux;
        for (std::size_t t = 0; t < total.size(); ++t)
            if (folds[f][t] > 0.0) {
                scores[f] += folds[f][t] * std::log((1.0 - kFloor) * train[t] * scale + kFloor);
                weights[f] += folds[f][t];
            }
    });
    double score = 0.0, weight = 0.0;
    for (std::size_t f = 0; f < folds.size(); ++f) {
        score += scores[f];
        weight += weights[f];
    }
    return weight > 0.0 ? score / weight : 0.0;
}

TexelChoice choose_kernel(const std::vector<Crossing>& crossings,
                          const Rectangle& rectangle,
                          glm::ivec2 texels,
                          std::uint64_t seed) {
    const auto folds = fold_histograms(crossings, TexelGrid{rectangle, texels}, seed);
    TexelChoice best{texels, 0.0, -std::numeric_limits<double>::infinity()};
    for (const double kernel : kKernels) {
        const double nats = held_out_nats(folds, texels, kernel);
        if (nats > best.held_out_nats)
            best = {texels, kernel, nats};
    }
    return best;
}

}  // namespace

double negligible_nats(std::size_t ray_count) {
    return 0.5 / std::sqrt(static_cast<double>(std::max<std::size_t>(ray_count, 1)));
}

int fold_of(std::uint32_t ray, std::uint64_t seed) {
    // splitmix64 (Steele, Lea, Flood 2014): every bit of the result depends on every bit of the
    // input.
    std::uint64_t z = seed + 0x9E3779B97F4A7C15ULL * (static_cast<std::uint64_t>(ray) + 1);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return static_cast<int>((z ^ (z >> 31U)) % kFolds);
}

std::size_t TexelGrid::index(glm::dvec2 s_m) const {
    const glm::dvec2 t = glm::floor((s_m - rectangle.min_m) / size_m());
    const glm::ivec2 i(glm::clamp(t, glm::dvec2(0.0), glm::dvec2(texels - 1)));
    return static_cast<std::size_t>(i.y) * static_cast<std::size_t>(texels.x) +
           static_cast<std::size_t>(i.x);
}

TexelChoice choose_texels(const std::vector<Crossing>& crossings,
                          const Rectangle& rectangle,
                          std::optional<glm::ivec2> texels,
                          std::uint64_t seed) {
    if (texels)
        return choose_kernel(crossings, rectangle, *texels, seed);
    std::vector<TexelChoice> tried;
    double best = -std::numeric_limits<double>::infinity();
    for (const int across : kTexelsAcross) {
        const glm::ivec2 size = square_texels(rectangle, across);
        const auto count = static_cast<double>(size.x) * static_cast<double>(size.y);
        if (!tried.empty() && count * kLeastRaysPerTexel > static_cast<double>(crossings.size()))
            break;
        tried.push_back(choose_kernel(crossings, rectangle, size, seed));
        best = std::max(best, tried.back().held_out_nats);
    }
    return *std::find_if(tried.begin(), tried.end(), [&](const TexelChoice& choice) {
        return choice.held_out_nats >= best - negligible_nats(crossings.size());
    });
}

TexelFlux smooth_flux(const std::vector<Crossing>& crossings,
                      const TexelGrid& grid,
                      double kernel_texels) {
    std::vector<double> flux(grid.count()), variance(grid.count());
    for (const Crossing& c : crossings) {
        const std::size_t t = grid.index(c.s_m);
        flux[t] += c.flux;
        // Poisson: the sum of squared weights. A ray's parts in several slabs rise and fall
        // together: its square is shared out as its flux, so that added up as if parts were
        // independent it is the ray's.
        variance[t] += static_cast<double>(c.flux) * c.flux / c.share;
    }
    return {smooth(flux, grid.texels, kernel_texels), smooth(variance, grid.texels, kernel_texels),
            smooth(variance, grid.texels, kernel_texels, true)};
}

}  // namespace nearfield::rays
