// SPDX-License-Identifier: Apache-2.0
/// A light field as an array of projectors: what renderers without light fields can be given.
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <vector>

namespace nearfield::model {
struct Receiver;
}

namespace nearfield::proxies {

/// A point that throws a picture along its +z; y is up, x to the left of somebody who looks along
/// the light: a slab's frame.
struct Projector {
    Rigid luminaire_from_projector;
    glm::dvec2 tangent{0.0};  // of the half angles that the picture spans along x and y
    glm::ivec2 size_px{0};
    int channels = 1;
    /// Irradiance of a plane at z = 1 m that the picture falls on, [channel][j][i]; i rises with x,
    /// j with y. Constant on a pixel.
    std::vector<float> irradiance;
};

/// A projector for every image with light, at its basis function's center. Pixels hold the far
/// field of image and basis function at their middles, square, as wide as
/// a texel's shorter side: far away the array
/// is the light field but for pixels. Near the lamp its points are seen apart.
/// Cost: a pixel of each image reads the texels that its basis function spans.
std::vector<Projector> projectors_of(const LightField& lightfield);

/// What the array gives at a point, summed over all projectors: luminance (or radiometric total).
double irradiance(const std::vector<Projector>& projectors, const model::Receiver& receiver);

}  // namespace nearfield::proxies
