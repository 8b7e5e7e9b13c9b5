// SPDX-License-Identifier: Apache-2.0
#include "fit/lit_region.h"

#include "formats/files/error.h"

#include <algorithm>
#include <cmath>

namespace nearfield::fit {
namespace {

// The positions that show where light is at all: middle, corners and middles of the edges.
std::vector<PositionFrames> looks_of(const std::vector<PositionFrames>& positions,
                                     glm::ivec2 grid) {
    std::vector<PositionFrames> looks;
    for (const PositionFrames& position : positions) {
        const auto is_look = [](int at, int count) {
            return at == 0 || at == count - 1 || at == count / 2;
        };
        if (is_look(position.position.x, grid.x) && is_look(position.position.y, grid.y))
            looks.push_back(position);
    }
    return looks.empty() ? positions : looks;
}

// Light of several positions together, pixel by pixel; NaN where one of them is not known. What
// comes beside the filter lights all of the screen and is taken off.
std::vector<float> light_of_looks(const Measurement& measurement,
                                  const std::vector<PositionFrames>& looks,
                                  const LampDrift& drift) {
    std::vector<float> light;
    for (const PositionFrames& look : looks) {
        const MergedImage image = position_light(measurement, look, drift);
        light.resize(image.light_dn_per_s.size(), 0.0F);
        for (std::size_t k = 0; k < light.size(); ++k)
            light[k] += std::isinf(image.variance[k]) ? std::nanf("") : image.light_dn_per_s[k];
    }
    const PositionFrames blocked = blocked_frames(measurement.capture);
    if (blocked.frames.empty())
        return light;
    const MergedImage image = position_light(measurement, blocked, drift);
    for (std::size_t k = 0; k < light.size(); ++k)
        light[k] -= static_cast<float>(looks.size()) * image.light_dn_per_s[k];
    return light;
}

double share_outside(const rig::Rig& rig, const Extent& extent, const std::vector<float>& light) {
    std::vector<glm::dvec2> outline_px;
    for (const glm::dvec2 corner_m : {extent.min_m, glm::dvec2(extent.max_m.x, extent.min_m.y),
                                      extent.max_m, glm::dvec2(extent.min_m.x, extent.max_m.y)})
        if (const auto at_px = seen_px(rig, corner_m))
            outline_px.push_back(*at_px);
    if (outline_px.size() < 4)
        return 0;
    const auto is_inside = [&](glm::dvec2 at_px) {
        int side = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const glm::dvec2 along = outline_px[(k + 1) % 4] - outline_px[k],
                             to = at_px - outline_px[k];
            side += along.x * to.y - along.y * to.x > 0 ? 1 : -1;
        }
        return side == 4 || side == -4;
    };
    const auto width = static_cast<std::size_t>(rig.lens->size_px.x);
    double inside = 0, all = 0;
    for (std::size_t k = 0; k < light.size(); ++k) {
        if (!std::isfinite(light[k]))
            continue;
        all += double(light[k]);
        const std::size_t row = k / width;
        if (is_inside({static_cast<double>(k % width) + 0.5, static_cast<double>(row) + 0.5}))
            inside += double(light[k]);
    }
    return all > 0 ? std::max(0.0, 1 - inside / all) : 0;
}

}  // namespace

LitRegion lit_region(const Measurement& measurement,
                     const std::vector<PositionFrames>& positions,
                     const LampDrift& drift,
                     const std::optional<Extent>& wanted,
                     double dark_share) {
    const rig::Rig& rig = measurement.rig;
    const std::vector<float> light =
        light_of_looks(measurement, looks_of(positions, rig.planes->grid), drift);
    if (std::none_of(light.begin(), light.end(), [](float value) { return std::isfinite(value); }))
        throw Error{"all light is saturated", measurement.folder, "shorter exposures",
                    "no pixel that is below saturation at all positions"};
    LitRegion region;
    region.extent = wanted ? *wanted : lit_extent(rig, visible_extent(rig), light, dark_share);
    region.outside_share = share_outside(rig, region.extent, light);
    return region;
}

}  // namespace nearfield::fit
