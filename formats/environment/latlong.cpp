// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/latlong.h"

#include "formats/files/error.h"
#include "formats/files/image.h"
#include "formats/photos/photo.h"
#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/tonemap.glsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace nearfield::environment {
namespace {

constexpr const char* kReading = "cannot read environment";

LatLong from_exr(const std::string& path) {
    const Picture picture = read_picture(path);
    const auto found = std::find_if(picture.layers.begin(), picture.layers.end(),
                                    [](const Layer& layer) { return layer.name.empty(); });
    if (found == picture.layers.end())
        throw Error{kReading, path, "channels R, G, B or Y", "none of them"};
    const auto channel = [&](const char* name) {
        return std::find(found->channels.begin(), found->channels.end(), name) -
               found->channels.begin();
    };
    const auto count = static_cast<std::ptrdiff_t>(found->channels.size());
    const bool is_gray = channel("Y") < count;
    const std::ptrdiff_t rgb[3] = {channel(is_gray ? "Y" : "R"), channel(is_gray ? "Y" : "G"),
                                   channel(is_gray ? "Y" : "B")};
    if (*std::max_element(std::begin(rgb), std::end(rgb)) >= count)
        throw Error{kReading, path, "channels R, G, B or Y", "others"};
    LatLong result;
    result.size_px = picture.size_px;
    for (auto texel = found->values.begin(); texel != found->values.end(); texel += count)
        result.radiance.emplace_back(texel[rgb[0]], texel[rgb[1]], texel[rgb[2]]);
    return result;
}

}  // namespace

LatLong read_latlong(const std::string& path) {
    const std::string ending = std::filesystem::path(path).extension().string();
    LatLong picture;
    if (ending == ".exr") {
        picture = from_exr(path);
    } else if (ending == ".hdr") {
        photos::RadiancePicture read = photos::read_radiance(path);
        picture = {read.size_px, std::move(read.rgb)};
    } else {
        throw Error{kReading, path, "a name that ends in .hdr or .exr", "'" + ending + "'"};
    }
    check(picture, path);
    return picture;
}

void check(const LatLong& picture, const std::string& where) {
    constexpr int kMostWide = 1 << 14;  // 1.5 GiB, and coordinates are floats
    const glm::ivec2 size = picture.size_px;
    if (size.x != 2 * size.y || size.x < 2 || size.x > kMostWide)
        throw Error{kReading, where,
                    fmt::format("a latitude-longitude picture, twice as wide as high, at most {} "
                                "pixels wide",
                                kMostWide),
                    fmt::format("{} x {}", size.x, size.y)};
    const auto is_light = [](float value) { return std::isfinite(value) && value >= 0.0F; };
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const glm::vec3 rgb = picture.radiance[picture.index({x, y})];
            for (int c = 0; c < 3; ++c)
                if (!is_light(rgb[c]))
                    throw Error{kReading, fmt::format("{}, column {}, row {}", where, x, y),
                                "finite numbers >= 0", fmt::format("{}", rgb[c])};
        }
}

glm::vec3 radiance(const LatLong& picture, glm::vec3 direction) {
    const glm::vec2 at = shared::latlong_from_direction(direction) * glm::vec2(picture.size_px);
    return picture
        .radiance[picture.index(glm::clamp(glm::ivec2(at), glm::ivec2(0), picture.size_px - 1))];
}

double pixel_sr(const LatLong& picture, int y) {
    // 2 pi (cos above - cos below) of the zone; the difference of cosines as a product of sines,
    // which near the poles keeps its digits.
    const double pi = std::acos(-1.0);
    const double middle = pi * (y + 0.5) / picture.size_px.y;
    return 4.0 * pi / picture.size_px.x * std::sin(middle) * std::sin(0.5 * pi / picture.size_px.y);
}

float mean_luminance(const LatLong& picture) {
    double sum = 0.0;
    for (int y = 0; y < picture.size_px.y; ++y)
        for (int x = 0; x < picture.size_px.x; ++x)
            sum +=
                pixel_sr(picture, y) *
                static_cast<double>(shared::luminance709(picture.radiance[picture.index({x, y})]));
    return static_cast<float>(sum / (4.0 * std::acos(-1.0)));
}

glm::vec3 pixel_direction(const LatLong& picture, glm::ivec2 pixel) {
    return shared::direction_from_latlong((glm::vec2(pixel) + 0.5F) / glm::vec2(picture.size_px));
}

}  // namespace nearfield::environment
