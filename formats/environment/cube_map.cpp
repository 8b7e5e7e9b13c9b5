// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/cube_map.h"

#include "formats/files/error.h"
#include "formats/shared/filtered_samples.glsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::environment {
namespace {

constexpr int kFacePoints = 4;  // in a texel, a side

/// A face's axis, and the two that follow it.
struct FacePoint {
    int face = 0;
    glm::vec2 at{0.0F};  // [0, 1]^2
};

FacePoint face_point(glm::vec3 direction) {
    const glm::vec3 size = glm::abs(direction);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const float major = direction[axis];
    const glm::vec2 uv(direction[(axis + 1) % 3], direction[(axis + 2) % 3]);
    return {2 * axis + (major < 0.0F ? 1 : 0), 0.5F + 0.5F * uv / std::abs(major)};
}

glm::vec3 face_direction(int face, glm::vec2 at) {
    const int axis = face / 2;
    glm::vec3 direction(0.0F);
    direction[axis] = face % 2 == 0 ? 1.0F : -1.0F;
    direction[(axis + 1) % 3] = 2.0F * at.x - 1.0F;
    direction[(axis + 2) % 3] = 2.0F * at.y - 1.0F;
    return glm::normalize(direction);
}

glm::vec3 face_texel(const LatLong& picture, int face, glm::ivec2 texel, int side_px) {
    glm::dvec3 sum(0.0);
    double weights = 0.0;
    for (int k = 0; k < kFacePoints * kFacePoints; ++k) {
        const glm::vec2 part =
            (glm::vec2(k % kFacePoints, k / kFacePoints) + 0.5F) / float{kFacePoints};
        const glm::vec3 direction =
            face_direction(face, (glm::vec2(texel) + part) / static_cast<float>(side_px));
        const double weight = cube_sr_per_area(direction);
        sum += weight * glm::dvec3(radiance(picture, direction));
        weights += weight;
    }
    return sum / weights;
}

CubeMap::Level coarser(const CubeMap::Level& finer) {
    CubeMap::Level level{finer.side_px / 2, {}};
    const auto px = static_cast<std::size_t>(finer.side_px);
    for (std::size_t face = 0; face < 6; ++face)
        for (std::size_t row = 0; row < px; row += 2)
            for (std::size_t column = 0; column < px; column += 2) {
                const glm::vec3* corner = finer.faces.at(face).data() + row * px + column;
                level.faces.at(face).push_back(
                    0.25F * (corner[0] + corner[1] + corner[px] + corner[px + 1]));
            }
    return level;
}

glm::vec3 on_face(const CubeMap::Level& level, const FacePoint& point) {
    const shared::LinearTaps taps = shared::linear_taps(point.at, level.side_px);
    const std::vector<glm::vec3>& texels = level.faces.at(static_cast<std::size_t>(point.face));
    const auto texel = [&](int column, int row) {
        return texels[static_cast<std::size_t>(row) * static_cast<std::size_t>(level.side_px) +
                      static_cast<std::size_t>(column)];
    };
    return glm::mix(
        glm::mix(texel(taps.low.x, taps.low.y), texel(taps.high.x, taps.low.y), taps.part.x),
        glm::mix(texel(taps.low.x, taps.high.y), texel(taps.high.x, taps.high.y), taps.part.x),
        taps.part.y);
}

}  // namespace

CubeMap make_cube_map(const LatLong& picture, int side_px) {
    if (side_px < 1 || (side_px & (side_px - 1)) != 0)
        throw Error{"cannot make a cube map", "side", "a power of two", fmt::format("{}", side_px)};
    CubeMap map;
    CubeMap::Level finest{side_px, {}};
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < side_px; ++row)
            for (int column = 0; column < side_px; ++column)
                finest.faces.at(static_cast<std::size_t>(face))
                    .push_back(face_texel(picture, face, {column, row}, side_px));
    map.levels.push_back(std::move(finest));
    while (map.levels.back().side_px > 1)
        map.levels.push_back(coarser(map.levels.back()));
    return map;
}

glm::vec3 filtered(const CubeMap& map, glm::vec3 direction, float level) {
    const FacePoint point = face_point(direction);
    const float clamped = std::clamp(level, 0.0F, static_cast<float>(map.levels.size() - 1));
    const auto finer = static_cast<std::size_t>(clamped);
    const float part = clamped - static_cast<float>(finer);
    const glm::vec3 value = on_face(map.levels[finer], point);
    return part > 0.0F ? glm::mix(value, on_face(map.levels[finer + 1], point), part) : value;
}

double cube_sr_per_area(glm::vec3 direction) {
    const glm::dvec3 size(glm::abs(direction));
    return 4.0 * std::pow(std::max({size.x, size.y, size.z}), 3);
}

}  // namespace nearfield::environment
