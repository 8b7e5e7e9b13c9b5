// SPDX-License-Identifier: Apache-2.0
#include "render/seen_lamps.h"

#include "formats/model/sampler.h"
#include "render/film.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace nearfield::render {
namespace {

// Of the depth: a surface that U lies on, within rounding of floats, does not hide it.
constexpr double kSameDepth = 1e-5;

/// Pixels [low, high).
struct PixelBox {
    glm::ivec2 low{0}, high{0};
};

/// Where U may be in the picture: all of it if a corner is not in front of the camera.
PixelBox box_of(const Camera& camera, glm::ivec2 size_px, const PlacedSlab& slab) {
    const glm::dmat4 camera_from_world = glm::inverse(camera.world_from_camera);
    const double unit_px = 0.5 * size_px.y / std::tan(0.5 * camera.yfov_rad);
    glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
    for (const glm::dvec3& corner : slab.u_corners_world_m) {
        const glm::dvec3 local(camera_from_world * glm::dvec4(corner, 1.0));
        if (!(local.z < 0.0))
            return {glm::ivec2(0), size_px};
        const glm::dvec2 at_px =
            0.5 * glm::dvec2(size_px) + glm::dvec2(-local.x, local.y) * (unit_px / local.z);
        low = glm::min(low, at_px);
        high = glm::max(high, at_px);
    }
    const glm::dvec2 most(size_px);
    return {glm::ivec2(glm::clamp(glm::floor(low), glm::dvec2(0.0), most)),
            glm::ivec2(glm::clamp(glm::ceil(high), glm::dvec2(0.0), most))};
}

/// A slab and who looks at it.
struct Look {
    const Camera& camera;
    glm::ivec2 size_px;
    const PlacedSlab& slab;
    glm::dvec3 eye_world_m, forward, eye_m;  // the last in the slab's frame
};

PixelBox box_of(const std::vector<Look>& looks) {
    PixelBox all;
    for (const Look& look : looks) {
        const PixelBox box = box_of(look.camera, look.size_px, look.slab);
        const bool is_first = &look == &looks.front();
        all.low = is_first ? box.low : glm::min(all.low, box.low);
        all.high = is_first ? box.high : glm::max(all.high, box.high);
    }
    return all;
}

Look look_of(const Camera& camera, glm::ivec2 size_px, const PlacedSlab& slab) {
    const glm::dvec3 eye_world_m(camera.world_from_camera[3]);
    return {camera,
            size_px,
            slab,
            eye_world_m,
            -glm::normalize(glm::dvec3(camera.world_from_camera[2])),
            glm::dvec3(slab.slab_from_world * glm::dvec4(eye_world_m, 1.0))};
}

/// At those slabs of a lamp that are turned to the camera.
std::vector<Look> looks_at(const Lamp& lamp, const Camera& camera, glm::ivec2 size_px) {
    std::vector<Look> looks;
    for (const PlacedSlab& slab : lamp.slabs) {
        const Look look = look_of(camera, size_px, slab);
        if (look.eye_m.z > -slab.prepared->slab.delta_m)  // else behind U
            looks.push_back(look);
    }
    return looks;
}

/// What reaches the eye from U through a place of the film, unless a surface at surface_depth_m (0:
/// none) is nearer.
glm::vec3 radiance_at(const Look& look, glm::dvec2 at_px, double surface_depth_m) {
    const glm::dvec3 ray = camera_ray(look.camera, look.size_px, at_px);
    const glm::dvec3 ray_in_slab = glm::dmat3(look.slab.slab_from_world) * ray;
    if (!(ray_in_slab.z < 0.0))
        return glm::vec3(0.0F);
    // From the eye, in world metres: the matrix carries the lamp's scale.
    const double along_m = -(look.slab.prepared->slab.delta_m + look.eye_m.z) / ray_in_slab.z;
    const double depth_m = along_m * glm::dot(ray, look.forward);
    if (surface_depth_m > 0.0 && surface_depth_m < (1.0 - kSameDepth) * depth_m)
        return glm::vec3(0.0F);
    const glm::dvec2 u_m = glm::dvec2(look.eye_m) + along_m * glm::dvec2(ray_in_slab);
    return model::radiance_towards(*look.slab.prepared, glm::vec3(look.eye_m), glm::vec2(u_m));
}

/// The mean over a pixel's strata.
glm::vec3 radiance_of_pixel(const Look& look, glm::ivec2 pixel, int strata, double depth_m) {
    glm::vec3 sum(0.0F);
    for (int k = 0; k < strata * strata; ++k)
        sum += radiance_at(look,
                           glm::dvec2(pixel) + (glm::dvec2(k % strata, k / strata) + 0.5) /
                                                   static_cast<double>(strata),
                           depth_m);
    return sum / static_cast<float>(strata * strata);
}

void add(std::vector<float>& values, std::size_t pixel, glm::vec3 rgb) {
    for (std::size_t c = 0; c < 3; ++c)
        values[3 * pixel + c] += rgb[static_cast<int>(c)];
}

}  // namespace

void add_seen_lamps(const Opening& opening,
                    const RenderOptions& options,
                    std::optional<std::size_t> only,
                    Picture& picture) {
    const glm::ivec2 size_px = picture.size_px;
    const int strata = strata_per_side(options.samples_per_pixel);
    Layer seen{kSeenLamps, {"R", "G", "B"}, {}};
    seen.values.resize(picture.layers[kRadiance].values.size());
    for (std::size_t k = 0; k < opening.lamps.lamps.size(); ++k) {
        if (only.value_or(k) != k)
            continue;
        const Lamp& lamp = opening.lamps.lamps[k];
        const std::vector<Look> looks = looks_at(lamp, opening.camera, size_px);
        const PixelBox box = box_of(looks);
        for (int y = box.low.y; y < box.high.y; ++y)
            for (int x = box.low.x; x < box.high.x; ++x) {
                const auto pixel = static_cast<std::size_t>(y * size_px.x + x);
                const auto depth_m = static_cast<double>(picture.layers[kDepth].values[pixel]);
                glm::vec3 radiance(0.0F);
                for (const Look& look : looks)
                    radiance += lamp.dim * radiance_of_pixel(look, {x, y}, strata, depth_m);
                add(picture.layers[kRadiance].values, pixel, radiance);
                add(seen.values, pixel, radiance);
            }
    }
    picture.layers.push_back(std::move(seen));
}

}  // namespace nearfield::render
