// SPDX-License-Identifier: Apache-2.0
#include "fit/texel_plan.h"

#include "formats/files/error.h"
#include "formats/rig/lens.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace nearfield::fit {
namespace {

constexpr int kEdgePoints = 33;  // of a rectangle's edge, enough for a lens' distortion

std::optional<glm::dvec2> on_s(const rig::Rig& rig, glm::dvec2 at_px) {
    const auto ray = rig::ray_camera(*rig.lens, at_px);
    if (!ray)
        return std::nullopt;
    const Rigid& camera_from_slab = rig.planes->camera_from_slab;
    const glm::dmat3 slab_from_camera = glm::transpose(camera_from_slab.rotation);
    const glm::dvec3 center_m = -(slab_from_camera * camera_from_slab.translation_m);
    const glm::dvec3 direction = slab_from_camera * *ray;
    const double distance = -center_m.z / direction.z;
    if (!(distance > 0) || !std::isfinite(distance))
        return std::nullopt;
    return glm::dvec2(center_m + distance * direction);
}

bool is_visible(const rig::Rig& rig, const Extent& extent) {
    for (int k = 0; k < kEdgePoints; ++k) {
        const double t = static_cast<double>(k) / (kEdgePoints - 1);
        const glm::dvec2 at_m = glm::mix(extent.min_m, extent.max_m, t);
        const glm::dvec2 edges_m[] = {{at_m.x, extent.min_m.y},
                                      {at_m.x, extent.max_m.y},
                                      {extent.min_m.x, at_m.y},
                                      {extent.max_m.x, at_m.y}};
        for (const glm::dvec2 edge_m : edges_m)
            if (!seen_px(rig, edge_m))
                return false;
    }
    return true;
}

// The largest t in 0 ... 1 for which is_right holds, which it does from 0 on.
template <typename IsRight>
double last_right(const IsRight& is_right) {
    double low = 0, high = 1;
    if (is_right(1.0))
        return 1;
    for (int step = 0; step < 30; ++step) {
        const double middle = 0.5 * (low + high);
        (is_right(middle) ? low : high) = middle;
    }
    return low;
}

// Neighboring pixels together, of which noise says less than of one.
constexpr int kBlock_px = 4;

struct Blocks {
    glm::ivec2 count{0};
    std::vector<double> mean, mean_sigma;  // [row][column]; a block without known pixels is dark

    bool is_lit(glm::ivec2 at, double limit) const {
        constexpr double kSure = 3;  // sigmas
        if (at.x < 0 || at.y < 0 || at.x >= count.x || at.y >= count.y)
            return false;
        const auto k = static_cast<std::size_t>(at.y * count.x + at.x);
        return mean[k] > limit && mean[k] > kSure * mean_sigma[k];
    }
};

void add_block(std::span<const float> light, glm::ivec2 size_px, glm::ivec2 at, Blocks& blocks) {
    const glm::ivec2 min_px = kBlock_px * at, max_px = glm::min(min_px + kBlock_px, size_px);
    double count = 0, sum = 0, square = 0;
    for (int y = min_px.y; y < max_px.y; ++y)
        for (int x = min_px.x; x < max_px.x; ++x) {
            const auto value = double(light[static_cast<std::size_t>(y * size_px.x + x)]);
            if (!std::isfinite(value))
                continue;
            count += 1;
            sum += value;
            square += value * value;
        }
    const double mean = count > 0 ? sum / count : 0;
    const double variance = count > 0 ? std::max(0.0, square / count - mean * mean) : 0;
    blocks.mean.push_back(mean);
    blocks.mean_sigma.push_back(std::sqrt(variance / std::max(1.0, count - 1)));
}

Blocks blocks_of(std::span<const float> light, glm::ivec2 size_px) {
    Blocks blocks;
    blocks.count = (size_px + kBlock_px - 1) / kBlock_px;
    for (int y = 0; y < blocks.count.y; ++y)
        for (int x = 0; x < blocks.count.x; ++x)
            add_block(light, size_px, {x, y}, blocks);
    return blocks;
}

// Light has neighbors; of ten thousand dark blocks some are beyond three sigmas, but not together.
bool is_in_light(const Blocks& blocks, glm::ivec2 at, double limit) {
    constexpr int kNeighbors = 2;
    if (!blocks.is_lit(at, limit))
        return false;
    int lit = 0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
            lit += blocks.is_lit(at + glm::ivec2(x, y), limit) ? 1 : 0;
    return lit > kNeighbors;  // itself included
}

}  // namespace

std::optional<glm::dvec2> seen_px(const rig::Rig& rig, glm::dvec2 s_m) {
    const Rigid& camera_from_slab = rig.planes->camera_from_slab;
    const auto at_px = rig::project_px(*rig.lens, camera_from_slab.rotation * glm::dvec3(s_m, 0.0) +
                                                      camera_from_slab.translation_m);
    if (!at_px || at_px->x < 0 || at_px->y < 0 || at_px->x > rig.lens->size_px.x ||
        at_px->y > rig.lens->size_px.y)
        return std::nullopt;
    return at_px;
}

Extent visible_extent(const rig::Rig& rig) {
    const glm::dvec2 size_px(rig.lens->size_px);
    const auto middle_m = on_s(rig, 0.5 * size_px);
    if (!middle_m || !seen_px(rig, *middle_m))
        throw Error{"the camera does not see S", "rig", "S before the camera", ""};
    Extent bounds{*middle_m, *middle_m};
    for (int k = 0; k < kEdgePoints; ++k) {
        const double t = static_cast<double>(k) / (kEdgePoints - 1);
        const glm::dvec2 edges_px[] = {{t * size_px.x, 0},
                                       {t * size_px.x, size_px.y},
                                       {0, t * size_px.y},
                                       {size_px.x, t * size_px.y}};
        for (const glm::dvec2 edge_px : edges_px)
            if (const auto at_m = on_s(rig, edge_px)) {
                bounds.min_m = glm::min(bounds.min_m, *at_m);
                bounds.max_m = glm::max(bounds.max_m, *at_m);
            }
    }
    // As much of the bounds as is seen in one piece, then every side outwards by itself.
    const double share = last_right([&](double t) {
        return is_visible(
            rig, {glm::mix(*middle_m, bounds.min_m, t), glm::mix(*middle_m, bounds.max_m, t)});
    });
    Extent extent{glm::mix(*middle_m, bounds.min_m, share),
                  glm::mix(*middle_m, bounds.max_m, share)};
    for (const bool is_max : {false, true})
        for (int axis = 0; axis < 2; ++axis) {
            const Extent before = extent;
            const double limit_m = (is_max ? bounds.max_m : bounds.min_m)[axis];
            const auto moved = [&](double t) {
                Extent grown = before;
                double& side_m = (is_max ? grown.max_m : grown.min_m)[axis];
                side_m += t * (limit_m - side_m);
                return grown;
            };
            extent = moved(last_right([&](double t) { return is_visible(rig, moved(t)); }));
        }
    // A hair inside: rounding must not put the outermost texels' corners out of sight.
    constexpr double kHair = 1e-9;
    const glm::dvec2 hair_m = kHair * (extent.max_m - extent.min_m);
    return {extent.min_m + hair_m, extent.max_m - hair_m};
}

Extent lit_extent(const rig::Rig& rig,
                  const Extent& visible,
                  std::span<const float> light,
                  double dark_share) {
    constexpr double kMargin = 0.03;
    const glm::ivec2 size_px = rig.lens->size_px;
    const Blocks blocks = blocks_of(light, size_px);
    const double brightest = *std::max_element(blocks.mean.begin(), blocks.mean.end());
    if (!(brightest > 0.0))
        throw Error{"no light in the capture", "positions", "pixels brighter than dark", "none"};
    Extent lit{visible.max_m, visible.min_m};
    for (int y = 0; y < blocks.count.y; ++y)
        for (int x = 0; x < blocks.count.x; ++x) {
            if (!is_in_light(blocks, {x, y}, dark_share * brightest))
                continue;
            for (const glm::ivec2 corner :
                 {glm::ivec2(0), glm::ivec2(1, 0), glm::ivec2(0, 1), glm::ivec2(1)}) {
                const glm::ivec2 at_px = kBlock_px * (glm::ivec2(x, y) + corner);
                if (const auto at_m = on_s(rig, glm::dvec2(glm::min(at_px, size_px)))) {
                    lit.min_m = glm::min(lit.min_m, *at_m);
                    lit.max_m = glm::max(lit.max_m, *at_m);
                }
            }
        }
    const glm::dvec2 margin_m = kMargin * (lit.max_m - lit.min_m);
    lit.min_m = glm::max(lit.min_m - margin_m, visible.min_m);
    lit.max_m = glm::min(lit.max_m + margin_m, visible.max_m);
    return lit;
}

glm::ivec2 matching_texels(const rig::Rig& rig, const Extent& extent, int most) {
    const glm::dvec2 middle_m = 0.5 * (extent.min_m + extent.max_m);
    const double cell_px =
        rig.radiometry->mosaic == "mono" || rig.radiometry->mosaic == "rgb" ? 1 : 2;
    glm::ivec2 texels{1};
    for (int axis = 0; axis < 2; ++axis) {
        glm::dvec2 from_m = middle_m, to_m = middle_m;
        from_m[axis] = extent.min_m[axis];
        to_m[axis] = extent.max_m[axis];
        const auto from_px = seen_px(rig, from_m), to_px = seen_px(rig, to_m);
        const double length_px = from_px && to_px ? glm::length(*to_px - *from_px) : cell_px * most;
        texels[axis] = std::clamp(static_cast<int>(std::lround(length_px / cell_px)), 1, most);
    }
    return texels;
}

}  // namespace nearfield::fit
