// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace nearfield::render {

/// Where a camera ray meets the scene.
struct Hit {
    glm::dvec3 position_world_m{0.0};
    glm::dvec3 geometric_normal{0.0};  // unit, of the triangle, towards the ray's origin
    glm::dvec3 shading_normal{0.0};    // unit, interpolated, on the geometric normal's side
    glm::dvec3 tangent{0.0};           // interpolated, of any length; 0: the mesh has none
    double offset_m = 0;  // how far rays that leave must start above the surface to miss it
    int material = 0;
    std::size_t instance = 0, triangle = 0;  // of the scene, of its mesh
};

/// The scene's triangles, ready for rays (Embree). Safe to use from many threads.
class Tracer {
  public:
    /// masks[i]: instance i stops rays whose mask shares a bit with it. threads: that build.
    Tracer(const Scene& scene, const std::vector<std::uint32_t>& masks, int threads);
    ~Tracer();
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    /// The nearest triangle along a ray of any mask. direction: unit length.
    std::optional<Hit> trace(glm::dvec3 origin_world_m, glm::dvec3 direction_world) const;

    /// How far the normals of a hit's triangle turn by length, in 1/m (sample_count.glsl.h); 0
    /// where the mesh has no normals.
    double curvature(const Hit& hit) const;

    /// Whether anything that `mask` meets lies between two points. The end itself does not count.
    bool is_occluded(glm::dvec3 from_world_m, glm::dvec3 to_world_m, std::uint32_t mask) const;

    /// Whether nothing stands between a point and what is infinitely far. direction: unit length.
    bool is_open(glm::dvec3 from_world_m, glm::dvec3 direction_world) const;

    /// What Embree holds.
    double bytes() const;

  private:
    struct Embree;
    const Scene& scene_;
    std::vector<glm::dmat3> normal_from_mesh_;
    std::unique_ptr<Embree> embree_;
};

}  // namespace nearfield::render
