// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace nearfield::environment {

/// Light from all directions, as a latitude-longitude picture
/// (formats/shared/environment_maps.glsl.h says where a direction stands). Radiance is constant on
/// each pixel: what is left of the truth, and what all estimates are measured against.
struct LatLong {
    glm::ivec2 size_px{0};
    std::vector<glm::vec3> radiance;  // [row from +y][column], linear Rec.709, finite, >= 0

    std::size_t index(glm::ivec2 pixel) const {
        return static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(size_px.x) +
               static_cast<std::size_t>(pixel.x);
    }
};

/// Reads a picture of light, NAME.hdr (Radiance) or NAME.exr (one part, R G B or Y). Throws Error
/// if it cannot be read, is not twice as wide as high, is larger than 2^26 pixels, or holds a value
/// that is negative or not finite: with the pixel.
LatLong read_latlong(const std::string& path);

/// Throws Error naming `where` if the picture breaks a rule above.
void check(const LatLong& picture, const std::string& where);

/// What arrives from a direction of unit length.
glm::vec3 radiance(const LatLong& picture, glm::vec3 direction);

/// Solid angle of a pixel of row y, exactly: a zone's share.
double pixel_sr(const LatLong& picture, int y);

/// Of the mean: what is brighter is looked at pixel by pixel, since points in a texel and few
/// samples meet it by chance.
constexpr float kBright = 8.0F;

/// Over all directions.
float mean_luminance(const LatLong& picture);

/// The direction to a pixel's middle.
glm::vec3 pixel_direction(const LatLong& picture, glm::ivec2 pixel);

}  // namespace nearfield::environment
