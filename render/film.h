// SPDX-License-Identifier: Apache-2.0
/// Where camera rays go, and the layers that every renderer fills.
#pragma once

#include "formats/files/image.h"
#include "formats/scene/scene.h"
#include "render/lamps.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace nearfield::render {

/// The camera of that name, or the first one. Throws Error with the names that there are.
const Camera& find_camera(const Scene& scene, const std::string& name);

/// With the height by the camera's aspect ratio (4 : 3 if unknown) where it is 0.
glm::ivec2 complete_size(glm::ivec2 size_px, const Camera& camera);

/// A pixel's strata along one side.
int strata_per_side(int samples_per_pixel);

/// The middle of one of n x n strata of a pixel, moved within it at random if n > 1. Pixel (x, y)
/// spans x ... x + 1.
glm::dvec2 film_position_px(
    glm::ivec2 pixel, int stratum, int n, std::uint32_t random_x, std::uint32_t random_y);

/// The direction through a position on the film, in the world, of unit length.
glm::dvec3 camera_ray(const Camera& camera, glm::ivec2 size_px, glm::dvec2 position_px);

/// Layers in their order; behind the lamps' layers those that not every picture has.
enum LayerIndex : std::size_t {
    kRadiance,
    kIrradiance,
    kAlbedo,
    kDepth,
    kNormal,
    kSigma,
    kFirstLamp
};

/// Layers that not every picture has.
struct MoreLayers {
    bool environment = false;
    bool sigma_measured = false;
};

/// All layers, black: those above, one a lamp, then environment and sigma_measured, if asked for.
/// Throws Error if the picture is larger than the memory that is left.
Picture make_picture(const Lamps& lamps, glm::ivec2 size_px, const MoreLayers& more);

/// Where the layer of that name is, or nothing.
std::optional<std::size_t> find_layer(const Picture& picture, const std::string& name);

/// Adds the layer bias_bound, black; returns its index.
std::size_t add_bias_layer(Picture& picture);

/// Memory of all layers.
double layer_bytes(const Picture& picture);

}  // namespace nearfield::render
