// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/paraboloid_map.h"

#include "formats/files/error.h"
#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/filtered_samples.glsl.h"
#include "formats/shared/tonemap.glsl.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::environment {
namespace {

// Points in a texel, a side. They hit a pixel as small as a texel by chance: its light would be off
// by up to 10 %. So what is brighter than kBright times the mean comes on top, pixel by pixel.
constexpr int kPoints = 4;
// Parts of a bright pixel, a side, whose light goes to the texel that each lies in.
constexpr int kParts = 16;

std::size_t to_size(int n) {
    return static_cast<std::size_t>(n);
}

/// Of a direction on either side's map, beyond the seam too: paraboloid_sr_per_area with z's sign.
double sr_per_area(int side, glm::vec3 direction) {
    const double z = static_cast<double>(side == 0 ? direction.z : -direction.z);
    const double stretch = 2.0 * static_cast<double>(shared::kParaboloidScale) * (1.0 + z);
    return stretch * stretch;
}

/// What a pixel is shown as, by its points, of all its light.
float plain_share(glm::vec3 rgb, float brightest) {
    const float luminance = shared::luminance709(rgb);
    return luminance > brightest ? brightest / luminance : 1.0F;
}

/// The picture without what goes beyond `brightest`.
LatLong plain_part(const LatLong& picture, float brightest) {
    LatLong plain = picture;
    for (glm::vec3& rgb : plain.radiance)
        rgb *= plain_share(rgb, brightest);
    return plain;
}

glm::vec3 texel_mean(const LatLong& picture, int side, glm::ivec2 texel, int side_px) {
    glm::dvec3 sum(0.0);
    double weights = 0.0;
    for (int k = 0; k < kPoints * kPoints; ++k) {
        const glm::vec2 part = (glm::vec2(k % kPoints, k / kPoints) + 0.5F) / float{kPoints};
        const glm::vec3 direction = shared::direction_from_paraboloid(
            side, (glm::vec2(texel) + part) / static_cast<float>(side_px));
        const double weight = sr_per_area(side, direction);
        sum += weight * glm::dvec3(radiance(picture, direction));
        weights += weight;
    }
    return sum / weights;
}

ParaboloidMap::Level finest_level(const LatLong& picture, int side_px) {
    ParaboloidMap::Level level{side_px, {}};
    for (int side = 0; side < 2; ++side) {
        std::vector<glm::vec4>& texels = level.sides.at(to_size(side));
        texels.resize(to_size(side_px) * to_size(side_px));
        tbb::parallel_for(0, side_px, [&](int row) {
            for (int column = 0; column < side_px; ++column)
                texels[to_size(row) * to_size(side_px) + to_size(column)] =
                    glm::vec4(texel_mean(picture, side, {column, row}, side_px), 0.0F);
        });
    }
    return level;
}

/// Adds light of a small solid angle to the texel of each map that it lies in.
void add_light(ParaboloidMap::Level& level, glm::vec3 direction, glm::dvec3 light) {
    for (int side = 0; side < 2; ++side) {
        // Stereographic from the other side's pole, so that the rim is reached too.
        const double z = static_cast<double>(side == 0 ? direction.z : -direction.z);
        const double scale = 0.5 / (static_cast<double>(shared::kParaboloidScale) * (1.0 + z));
        const glm::dvec2 at = 0.5 + glm::dvec2(direction.x, direction.y) * scale;
        if (!(at.x >= 0.0 && at.x < 1.0 && at.y >= 0.0 && at.y < 1.0))
            continue;
        const auto px = static_cast<double>(level.side_px);
        const glm::ivec2 texel(at * px);
        const glm::vec3 middle = shared::direction_from_paraboloid(
            side, (glm::vec2(texel) + 0.5F) / static_cast<float>(level.side_px));
        level.sides.at(
            to_size(side))[to_size(texel.y) * to_size(level.side_px) + to_size(texel.x)] +=
            glm::vec4(light * (px * px / sr_per_area(side, middle)), 0.0);
    }
}

void add_bright_part(const LatLong& picture, float brightest, ParaboloidMap::Level& level) {
    for (int y = 0; y < picture.size_px.y; ++y)
        for (int x = 0; x < picture.size_px.x; ++x) {
            const glm::vec3 rgb = picture.radiance[picture.index({x, y})];
            const float share = plain_share(rgb, brightest);
            if (share == 1.0F)
                continue;
            const glm::dvec3 light = glm::dvec3(rgb * (1.0F - share)) * pixel_sr(picture, y);
            for (int k = 0; k < kParts * kParts; ++k) {
                const glm::vec2 part = (glm::vec2(k % kParts, k / kParts) + 0.5F) / float{kParts};
                add_light(level,
                          shared::direction_from_latlong((glm::vec2(x, y) + part) /
                                                         glm::vec2(picture.size_px)),
                          light / double{kParts * kParts});
            }
        }
}

/// What the finest level's texels show, squared: the mean of squares of coarser ones follows.
void fill_squares(ParaboloidMap::Level& level) {
    for (std::vector<glm::vec4>& texels : level.sides)
        for (glm::vec4& texel : texels) {
            const float luminance = shared::luminance709(glm::vec3(texel));
            texel.w = luminance * luminance;
        }
}

ParaboloidMap::Level next_level(const ParaboloidMap::Level& finer) {
    ParaboloidMap::Level level{finer.side_px / 2, {}};
    const std::size_t side_px = to_size(level.side_px), finer_px = to_size(finer.side_px);
    for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t row = 0; row < side_px; ++row)
            for (std::size_t column = 0; column < side_px; ++column) {
                const glm::vec4* corner =
                    finer.sides.at(side).data() + 2 * row * finer_px + 2 * column;
                level.sides.at(side).push_back(
                    0.25F * (corner[0] + corner[1] + corner[finer_px] + corner[finer_px + 1]));
            }
    return level;
}

glm::vec4 on_level(const ParaboloidMap::Level& level, const shared::ParaboloidPoint& point) {
    const shared::LinearTaps taps = shared::linear_taps(point.at, level.side_px);
    const std::vector<glm::vec4>& texels = level.sides.at(to_size(point.side));
    const auto texel = [&](int column, int row) {
        return texels[to_size(row) * to_size(level.side_px) + to_size(column)];
    };
    return glm::mix(
        glm::mix(texel(taps.low.x, taps.low.y), texel(taps.high.x, taps.low.y), taps.part.x),
        glm::mix(texel(taps.low.x, taps.high.y), texel(taps.high.x, taps.high.y), taps.part.x),
        taps.part.y);
}

}  // namespace

int side_for(const LatLong& picture) {
    // In a map's middle a texel is widest: 2 b (1 + 1)/side against 2 pi/width.
    const double wanted = 4.0 * static_cast<double>(shared::kParaboloidScale) /
                          (2.0 * std::acos(-1.0)) * picture.size_px.x;
    int side_px = 1;
    while (side_px < wanted)
        side_px *= 2;
    return side_px;
}

ParaboloidMap make_paraboloid_map(const LatLong& picture, int side_px) {
    if (side_px == 0)
        side_px = side_for(picture);
    if (side_px < 1 || (side_px & (side_px - 1)) != 0)
        throw Error{"cannot make an environment's maps", "side", "a power of two",
                    fmt::format("{}", side_px)};
    ParaboloidMap map;
    const float brightest = kBright * mean_luminance(picture);
    map.levels.push_back(finest_level(plain_part(picture, brightest), side_px));
    add_bright_part(picture, brightest, map.levels.front());
    fill_squares(map.levels.front());
    while (map.levels.back().side_px > 1)
        map.levels.push_back(next_level(map.levels.back()));
    return map;
}

glm::vec4 filtered_with_square(const ParaboloidMap& map, glm::vec3 direction, float level) {
    const shared::ParaboloidPoint point = shared::paraboloid_from_direction(direction);
    const float top = static_cast<float>(map.levels.size() - 1);
    const float clamped = std::clamp(level, 0.0F, top);
    const auto finer = static_cast<std::size_t>(clamped);
    const float part = clamped - static_cast<float>(finer);
    const glm::vec4 value = on_level(map.levels[finer], point);
    return part > 0.0F ? glm::mix(value, on_level(map.levels[finer + 1], point), part) : value;
}

glm::vec3 filtered(const ParaboloidMap& map, glm::vec3 direction, float level) {
    return glm::vec3(filtered_with_square(map, direction, level));
}

}  // namespace nearfield::environment
