// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/light.h"

#include "app/viewer/view.h"
#include "formats/shared/tonemap.glsl.h"

#include <algorithm>
#include <cmath>

namespace nearfield::viewer {
namespace {

glm::vec3 rgb_at(const std::vector<float>& values, std::size_t k) {
    return {values[3 * k], values[3 * k + 1], values[3 * k + 2]};
}

void add_scaled(const std::vector<float>& from, glm::vec3 factor, std::vector<float>& to) {
    for (std::size_t k = 0; k < from.size(); k += 3) {
        to[k] += factor.r * from[k];
        to[k + 1] += factor.g * from[k + 1];
        to[k + 2] += factor.b * from[k + 2];
    }
}

/// What a factor a channel does to the luminance of light whose hue is unknown, at most.
float largest(glm::vec3 factor) {
    return std::max({factor.r, factor.g, factor.b});
}

}  // namespace

std::vector<LampGain> gains_of(const Frame& frame,
                               const Document& document,
                               std::optional<int> only) {
    std::vector<LampGain> gains;
    for (const std::shared_ptr<const LampLight>& light : frame.lamps) {
        const EditedLamp* lamp = find_lamp(document, light->lamp);
        LampGain gain{light->lamp, glm::vec3(0.0F)};
        if (lamp != nullptr && lamp->luminaire.on && only.value_or(lamp->id) == lamp->id)
            gain.factor =
                static_cast<float>(lamp->luminaire.dim / light->dim) * lamp->luminaire.tint;
        gains.push_back(gain);
    }
    return gains;
}

Mixed mix(const Frame& frame, const std::vector<LampGain>& gains) {
    const auto pixels =
        static_cast<std::size_t>(frame.size_px.x) * static_cast<std::size_t>(frame.size_px.y);
    Mixed mixed{frame.size_px, std::vector<float>(3 * pixels), std::vector<float>(3 * pixels),
                std::vector<float>(pixels), std::vector<float>(pixels)};
    for (std::size_t l = 0; l < gains.size(); ++l) {
        const glm::vec3 factor = gains[l].factor;
        if (factor == glm::vec3(0.0F))
            continue;
        const LampLight& light = *frame.lamps[l];
        add_scaled(light.radiance, factor, mixed.radiance);
        add_scaled(light.irradiance, factor, mixed.irradiance);
        const float most = largest(factor);
        for (std::size_t k = 0; k < light.sigma.size(); ++k)
            mixed.sigma[k] = std::hypot(mixed.sigma[k], most * light.sigma[k]);
        for (std::size_t k = 0; k < light.bias.size(); ++k)
            mixed.bias[k] += most * light.bias[k];
    }
    for (std::size_t l = 0; l < gains.size(); ++l)  // last, as the renderer
        add_scaled(frame.lamps[l]->seen, gains[l].factor, mixed.radiance);
    return mixed;
}

Reading reading_at(const Frame& frame, const Mixed& mixed, glm::ivec2 pixel) {
    const auto k = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(frame.size_px.x) +
                   static_cast<std::size_t>(pixel.x);
    Reading reading;
    reading.radiance = rgb_at(mixed.radiance, k);
    reading.irradiance = rgb_at(mixed.irradiance, k);
    const float radiance_y = shared::luminance709(reading.radiance);
    reading.radiance_y = static_cast<double>(radiance_y);
    reading.irradiance_y = static_cast<double>(shared::luminance709(reading.irradiance));
    if (radiance_y > 0.0F) {
        reading.sigma_rel = static_cast<double>(mixed.sigma[k] / radiance_y);
        reading.bias_rel = static_cast<double>(mixed.bias[k] / radiance_y);
    }
    reading.depth_m = static_cast<double>(frame.depth_m[k]);
    const Ray ray = ray_through(frame.camera, frame.size_px, glm::dvec2(pixel) + 0.5);
    const glm::dvec3 ahead = -glm::normalize(glm::dvec3(frame.camera.world_from_camera[2]));
    reading.position_world_m =
        ray.from_world_m + ray.direction * (reading.depth_m / glm::dot(ray.direction, ahead));
    return reading;
}

RegionStatistics statistics_of(const Frame& frame,
                               const Mixed& mixed,
                               glm::ivec2 from_px,
                               glm::ivec2 to_px) {
    const glm::ivec2 low = glm::clamp(glm::min(from_px, to_px), glm::ivec2(0), frame.size_px - 1),
                     high = glm::clamp(glm::max(from_px, to_px), glm::ivec2(0), frame.size_px - 1);
    RegionStatistics found;
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            const auto k = static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.size_px.x) +
                           static_cast<std::size_t>(x);
            if (!(frame.depth_m[k] > 0.0F))
                continue;
            const auto lux = static_cast<double>(shared::luminance709(rgb_at(mixed.irradiance, k)));
            found.least = found.pixels == 0 ? lux : std::min(found.least, lux);
            found.largest = std::max(found.largest, lux);
            found.mean += lux;
            ++found.pixels;
        }
    if (found.pixels > 0)
        found.mean /= static_cast<double>(found.pixels);
    if (found.mean > 0.0)
        found.uniformity = found.least / found.mean;
    return found;
}

}  // namespace nearfield::viewer
