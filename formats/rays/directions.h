// SPDX-License-Identifier: Apache-2.0
/// How the light of a place on S is shared out to the basis functions on U.
///
/// S is divided into blocks, far fewer than texels: directions change more slowly over a lamp than
/// its brightness, and rays are few. In each block the shares maximize the Poisson likelihood of
/// its rays by expectation maximization (Richardson 1972, Lucy 1974; Shepp and Vardi 1982), drawn
/// to the shares of the larger block around it as if that were `prior_rays` more rays. Every step
/// keeps the flux. Between blocks' centers, shares times flux are interpolated.
#pragma once

#include "formats/rays/planes.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace nearfield::rays {

/// The basis functions on U.
struct Aperture {
    Profile profile;
    glm::ivec2 grid{0};
    glm::dvec2 pitch_m{0}, center_m{0};

    int image_count() const { return grid.x * grid.y; }
    /// Integral of one basis function over U, m^2.
    double integral_m2() const;
};

/// The aperture whose area where the basis sums to one (the grid less its outer n - 1 cells) is
/// `rectangle`.
Aperture cover(const Profile& profile, const Rectangle& rectangle, glm::ivec2 grid);

/// A grid with about square pitch, `cells` of them across the larger side of the rectangle.
glm::ivec2 square_grid(const Profile& profile, const Rectangle& rectangle, int cells);

/// One subdivision of S, and how the shares of its blocks are found.
struct Level {
    glm::ivec2 blocks{1};
    double prior_rays = 0;
    int iterations = 0;
};

/// What cross-validation chose: basis functions, then levels from one block to the finest.
struct DirectionChoice {
    glm::ivec2 grid{0};
    std::vector<Level> levels;
    double held_out_nats = 0;  // per ray, relative to light spread evenly over U's rectangle
};

/// Chooses levels and, unless given, the grid (nearly square pitch) by the likelihood of held-out
/// rays.
DirectionChoice choose_directions(const std::vector<Crossing>& crossings,
                                  const Rectangle& s,
                                  const Rectangle& u,
                                  const Profile& profile,
                                  std::optional<glm::ivec2> grid,
                                  std::uint64_t seed);

/// Flux by block and basis function.
struct BlockShares {
    glm::ivec2 blocks{1};
    int images = 0, channels = 1;
    std::vector<float>
        flux;  // [block][channel][m]; channel 0 is Y, then R, G, B if colors were given
    std::vector<double> block_flux;  // [block] sum over m of channel 0
    Rectangle s;

    std::size_t offset(std::size_t block, int channel) const {
        return (block * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel)) *
               static_cast<std::size_t>(images);
    }
};

/// Fits all levels to all rays; `colors` as in RaySet (used where there is one a ray). The last
/// entry is the finest, the first the whole of S.
std::vector<BlockShares> fit_directions(const std::vector<Crossing>& crossings,
                                        const Rectangle& s,
                                        const Aperture& aperture,
                                        const std::vector<Level>& levels,
                                        const std::vector<glm::vec3>& colors);

/// The up to four blocks around a place on S and their bilinear weights.
struct BlockWeights {
    std::size_t block[4];
    double weight[4];
};
BlockWeights weights_at(glm::ivec2 blocks, const Rectangle& s, glm::dvec2 s_m);

}  // namespace nearfield::rays
