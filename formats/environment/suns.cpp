// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/suns.h"

#include "formats/shared/tonemap.glsl.h"

#include <algorithm>
#include <cmath>

namespace nearfield::environment {
namespace {

constexpr double kRadius_rad = 0.026;  // 1.5 degrees

struct BrightPixel {
    std::size_t index = 0;
    glm::dvec3 direction{0.0};
    glm::dvec3 light{0.0};  // what goes beyond, times solid angle
    float luminance = 0.0F;
    float share = 0.0F;  // of the pixel's light that goes beyond
};

std::vector<BrightPixel> bright_pixels(const LatLong& picture) {
    const float brightest = kBright * mean_luminance(picture);
    std::vector<BrightPixel> pixels;
    for (int y = 0; y < picture.size_px.y; ++y)
        for (int x = 0; x < picture.size_px.x; ++x) {
            const std::size_t index = picture.index({x, y});
            const float luminance = shared::luminance709(picture.radiance[index]);
            if (!(luminance > brightest))
                continue;
            const float share = 1.0F - brightest / luminance;
            pixels.push_back({index, glm::dvec3(pixel_direction(picture, {x, y})),
                              glm::dvec3(picture.radiance[index] * share) * pixel_sr(picture, y),
                              luminance, share});
        }
    return pixels;
}

double luminance_of(glm::dvec3 light) {
    return static_cast<double>(shared::luminance709(glm::vec3(light)));
}

/// The brightest pixel and those about it.
std::vector<BrightPixel> take_brightest(std::vector<BrightPixel>& left, double radius_rad) {
    const glm::dvec3 middle =
        std::max_element(left.begin(), left.end(), [](const auto& a, const auto& b) {
            return a.luminance < b.luminance;
        })->direction;
    const auto first =
        std::stable_partition(left.begin(), left.end(), [&](const BrightPixel& pixel) {
            return glm::distance(pixel.direction, middle) > radius_rad;
        });
    std::vector<BrightPixel> taken(first, left.end());
    left.erase(first, left.end());
    return taken;
}

}  // namespace

Suns take_suns(const LatLong& picture, int most) {
    Suns result;
    result.rest = picture;
    const double diagonal_rad = std::sqrt(2.0) * std::acos(-1.0) / picture.size_px.y;
    std::vector<BrightPixel> left = bright_pixels(picture);
    while (!left.empty() && static_cast<int>(result.suns.size()) < most) {
        const std::vector<BrightPixel> taken =
            take_brightest(left, std::max(kRadius_rad, diagonal_rad));
        glm::dvec3 light(0.0), direction(0.0);
        for (const BrightPixel& pixel : taken) {
            light += pixel.light;
            direction += pixel.direction * luminance_of(pixel.light);
            result.rest.radiance[pixel.index] *= 1.0F - pixel.share;
        }
        direction = glm::normalize(direction);
        for (const BrightPixel& pixel : taken)
            result.radius_rad = std::max(
                result.radius_rad,
                static_cast<float>(glm::distance(pixel.direction, direction) + 0.5 * diagonal_rad));
        result.suns.push_back({glm::vec3(direction), glm::vec3(light)});
    }
    return result;
}

}  // namespace nearfield::environment
