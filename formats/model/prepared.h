// SPDX-License-Identifier: Apache-2.0
/// The windowed sum in float and SIMD: what renderers call. Same formulas as luminaire.h
/// (formats/shared), checked against it. Relative error, all found in docs/hard_cases.md: 2e-7
/// typical; irradiance weighting up to 4e-6 on the reference lamp, 2e-5 in the hardest cases;
/// radiance weighting up to 5e-5, by its bound 1e-4 (kWidestCentroidTexelT).
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/axis_window.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::model {

using shared::kWidestCentroidTexelT;

/// A slab made ready for SIMD, which may read a few floats beyond a row's end.
struct PreparedSlab {
    Slab slab;
    /// The end of slab.coeffs again, from an image's start and with zeros behind it: for the images
    /// from which SIMD would read beyond the array.
    std::vector<float> tail;
    std::size_t tail_offset = 0;    // where it starts in slab.coeffs
    std::vector<float> cell_share;  // [n] of int phi
    std::vector<glm::ivec4> lit;  // [m] x, y of the first texel with light and of one past the last
    /// Radiance weighting: receivers that see wider texels go by double precision's pieces.
    float widest_centroid_texel_t = kWidestCentroidTexelT;
};

/// Takes the slab over. Cost: a look at the dark borders of all images, in parallel.
PreparedSlab prepare(Slab slab);

/// A shaded point in the slab's frame, and its unit normal.
struct ReceiverF {
    glm::vec3 position_m{0.0F};
    glm::vec3 normal{0.0F, 0.0F, -1.0F};
};

/// Unshadowed irradiance, R G B (Y three times for one channel).
/// Where image_y is not empty (one entry an image), each image's share of Y is written to it: the
/// exact energies from which visibility samples are drawn. Cost: 2 multiply-adds a texel and
/// channel; up to the window of every image.
glm::vec3 irradiance(const PreparedSlab& prepared,
                     const ReceiverF& receiver,
                     std::span<float> image_y = {});

/// The same for neighboring receivers at once (a tile of 4 x 4 pixels), about twice as fast: what
/// they see of an image is read from memory once. results has one entry a receiver; image_y, where
/// not empty, [receiver][image]. Returns the multiply-adds that it took.
std::uint64_t irradiance(const PreparedSlab& prepared,
                         std::span<const ReceiverF> receivers,
                         std::span<glm::vec3> results,
                         std::span<float> image_y = {});

/// A point on U drawn for a receiver, and what it carries.
struct ApertureSample {
    glm::vec2 u_m{0.0F};
    glm::vec3 weight{
        0.0F};  // integrand of E at u over the density of u: mean of weight over samples is E
};

/// Draws a point on U: image m in proportion to image_y[m], a cell of Phi_m in proportion to
/// Phi_m's integral there, a point uniform in the cell; and evaluates the integrand of irradiance
/// there, over the density of all ways to draw it. select and xi are uniform in [0, 1); image_y as
/// irradiance() wrote it, image_y_sum its sum in order, > 0. The mean of weight * V(u) over many
/// draws is the irradiance shadowed by V: unbiased, since an image that lights the receiver has
/// image_y > 0.
ApertureSample sample_aperture(const PreparedSlab& prepared,
                               const ReceiverF& receiver,
                               std::span<const float> image_y,
                               float image_y_sum,
                               float select,
                               glm::vec2 xi);

}  // namespace nearfield::model
