// SPDX-License-Identifier: Apache-2.0
#include "render/film.h"

#include "formats/files/error.h"
#include "formats/shared/rng.glsl.h"
#include "render/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace nearfield::render {
namespace {

void allocate(Picture& picture) {
    const std::size_t pixels =
        static_cast<std::size_t>(picture.size_px.x) * static_cast<std::size_t>(picture.size_px.y);
    for (Layer& layer : picture.layers)
        layer.values.assign(pixels * layer.channels.size(), 0.0F);
}

/// The layers' floats, and what finding errors and a PNG take at most besides.
double bytes_per_pixel(const Picture& picture) {
    double floats = 0.0;
    for (const Layer& layer : picture.layers)
        floats += static_cast<double>(layer.channels.size());
    constexpr double kBesides = 32.0;
    return 4.0 * floats + kBesides;
}

void check_memory(const Picture& picture) {
    const double needed =
        bytes_per_pixel(picture) * picture.size_px.x * static_cast<double>(picture.size_px.y);
    const double available = available_memory_bytes();
    constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
    if (needed > available)
        throw Error{"the picture is larger than the memory that is left",
                    fmt::format("{} x {} pixels", picture.size_px.x, picture.size_px.y),
                    fmt::format("at most {:.1f} GiB", available / kGiB),
                    fmt::format("{:.1f} GiB", needed / kGiB)};
}

}  // namespace

const Camera& find_camera(const Scene& scene, const std::string& name) {
    std::string names;
    for (const Camera& camera : scene.cameras) {
        if (name.empty() || camera.name == name)
            return camera;
        names += (names.empty() ? "" : ", ") + camera.name;
    }
    throw Error{"no such camera", "scene", names.empty() ? "a scene with a camera" : names,
                name.empty() ? "none" : "'" + name + "'"};
}

glm::ivec2 complete_size(glm::ivec2 size_px, const Camera& camera) {
    constexpr double kUsualAspect = 4.0 / 3.0;
    const double aspect = camera.aspect > 0.0 ? camera.aspect : kUsualAspect;
    if (size_px.y == 0)
        // Clamped before the conversion: an aspect may be 1e-300.
        size_px.y = static_cast<int>(
            std::lround(std::clamp(size_px.x / aspect, 1.0, static_cast<double>(kMaxExtentPx))));
    return size_px;
}

int strata_per_side(int samples_per_pixel) {
    return static_cast<int>(std::lround(std::sqrt(samples_per_pixel)));
}

glm::dvec2 film_position_px(
    glm::ivec2 pixel, int stratum, int n, std::uint32_t random_x, std::uint32_t random_y) {
    const glm::dvec2 jitter =
        n == 1 ? glm::dvec2(0.5)
               : glm::dvec2(shared::unit_float(random_x), shared::unit_float(random_y));
    return glm::dvec2(pixel) +
           (glm::dvec2(stratum % n, stratum / n) + jitter) / static_cast<double>(n);
}

glm::dvec3 camera_ray(const Camera& camera, glm::ivec2 size_px, glm::dvec2 position_px) {
    const double tan_half = std::tan(0.5 * camera.yfov_rad);
    const double px =
        2.0 * tan_half / static_cast<double>(size_px.y);  // square pixels at distance 1
    const glm::dvec3 direction((position_px.x - 0.5 * size_px.x) * px,
                               (0.5 * size_px.y - position_px.y) * px, -1.0);
    // Cameras of scenes made elsewhere may carry a scale; directions do not.
    return glm::normalize(glm::dmat3(camera.world_from_camera) * direction);
}

Picture make_picture(const Lamps& lamps, glm::ivec2 size_px, const MoreLayers& more) {
    Picture picture;
    picture.size_px = size_px;
    const std::vector<std::string> rgb = {"R", "G", "B"};
    picture.layers = {{"", rgb, {}},        {"irradiance", rgb, {}},         {"albedo", rgb, {}},
                      {"depth", {"Z"}, {}}, {"normal", {"X", "Y", "Z"}, {}}, {"sigma", {"Y"}, {}}};
    for (const Lamp& lamp : lamps.lamps)
        picture.layers.push_back({"lamp." + lamp.name, rgb, {}});
    if (more.environment)
        picture.layers.push_back({"environment", rgb, {}});
    if (more.sigma_measured)
        picture.layers.push_back({"sigma_measured", {"Y"}, {}});
    check_memory(picture);
    allocate(picture);
    return picture;
}

std::optional<std::size_t> find_layer(const Picture& picture, const std::string& name) {
    for (std::size_t k = 0; k < picture.layers.size(); ++k)
        if (picture.layers[k].name == name)
            return k;
    return std::nullopt;
}

std::size_t add_bias_layer(Picture& picture) {
    picture.layers.push_back({"bias_bound", {"Y"}, {}});
    picture.layers.back().values.assign(picture.layers[kSigma].values.size(), 0.0F);
    return picture.layers.size() - 1;
}

double layer_bytes(const Picture& picture) {
    double bytes = 0.0;
    for (const Layer& layer : picture.layers)
        bytes += static_cast<double>(layer.values.size() * sizeof(float));
    return bytes;
}

}  // namespace nearfield::render
