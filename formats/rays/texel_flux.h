// SPDX-License-Identifier: Apache-2.0
/// How much flux crosses each texel of S: histogram, smoothing kernel, and the choice of both by
/// cross-validation.
#pragma once

#include "formats/rays/planes.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace nearfield::rays {

/// Cross-validation shares rays out to this many folds; each is predicted from the others.
constexpr int kFolds = 4;

/// The fold of a ray: a hash of its index and the seed, so that it depends neither on order nor on
/// threads.
int fold_of(std::uint32_t ray, std::uint64_t seed);

/// A resolution that loses less held-out likelihood than this against the best one is as good, and
/// the coarsest such is taken: half a standard error, since log likelihoods of single rays spread
/// by about 1 nat (one-standard-error rule: Breiman et al., "Classification and regression trees",
/// 1984).
double negligible_nats(std::size_t ray_count);

/// A part of the held-out density is spread evenly, so that a ray where no other has been costs a
/// finite amount.
constexpr double kFloor = 1e-3;

/// The texels of a rectangle.
struct TexelGrid {
    Rectangle rectangle;
    glm::ivec2 texels{1};

    glm::dvec2 size_m() const { return (rectangle.max_m - rectangle.min_m) / glm::dvec2(texels); }
    std::size_t count() const {
        return static_cast<std::size_t>(texels.x) * static_cast<std::size_t>(texels.y);
    }
    /// The texel that holds s, clamped to the rectangle.
    std::size_t index(glm::dvec2 s_m) const;
};

/// Resolution and Gaussian kernel (standard deviation in texels, 0: none) with their held-out
/// likelihood per ray.
struct TexelChoice {
    glm::ivec2 texels{1};
    double kernel_texels = 0;
    double held_out_nats = 0;
};

/// Chooses kernel and, unless given, texels (nearly square ones) by the likelihood of held-out
/// rays' positions on S. Cost: one pass over the rays a resolution tried.
TexelChoice choose_texels(const std::vector<Crossing>& crossings,
                          const Rectangle& rectangle,
                          std::optional<glm::ivec2> texels,
                          std::uint64_t seed);

/// Flux of each texel after the kernel, and two variances of it, in flux^2.
struct TexelFlux {
    std::vector<double> flux;
    /// The rays' Poisson variance spread by the kernel: sums over many texels are right as if
    /// texels were independent.
    std::vector<double> variance_as_independent;
    /// The variance of the smoothed value itself, smaller: the kernel averages.
    std::vector<double> variance;
};
TexelFlux smooth_flux(const std::vector<Crossing>& crossings,
                      const TexelGrid& grid,
                      double kernel_texels);

}  // namespace nearfield::rays
