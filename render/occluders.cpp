// SPDX-License-Identifier: Apache-2.0
#include "render/occluders.h"

#include "render/beam.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace nearfield::render {
namespace {

constexpr std::size_t kMostPlanes = 64;
// Of the largest coordinate: where shadow rays start above a surface (Hit::offset_m).
constexpr double kUnits = 16.0 / 8388608.0;
// 1 - cosine of normals of the same plane: 1.4e-6 rad, less than kUnits tell anywhere.
constexpr double kSameDirection = 1e-12;

using Corners = std::array<glm::dvec3, 8>;

glm::dvec3 to_world(const Instance& instance, glm::vec3 position_m) {
    return {instance.world_from_mesh * glm::dvec4(position_m, 1.0)};
}

/// Of the mesh's bounding box, in the world.
Corners box_corners(const Scene& scene, const Instance& instance) {
    glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    for (const glm::vec3 position :
         scene.meshes[static_cast<std::size_t>(instance.mesh)].positions_m) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    Corners corners{};
    for (unsigned c = 0; c < 8; ++c)
        corners[c] =
            to_world(instance, {(c & 1U) != 0 ? high.x : low.x, (c & 2U) != 0 ? high.y : low.y,
                                (c & 4U) != 0 ? high.z : low.z});
    return corners;
}

bool may_meet(const PlacedSlab& slab, const Corners& corners_world_m) {
    Corners corners{};
    for (std::size_t c = 0; c < corners.size(); ++c)
        corners[c] = glm::dvec3(slab.slab_from_world * glm::dvec4(corners_world_m[c], 1.0));
    return may_meet(beam_of(slab.prepared->slab), corners);
}

/// dot(normal, p) = offset.
struct Plane {
    glm::dvec3 normal{0.0};
    double offset_m = 0.0;

    double height_m(glm::dvec3 p) const { return glm::dot(normal, p) - offset_m; }
};

/// Which sides of a plane something touches, by more than a tolerance.
struct Sides {
    bool above = false, below = false;

    void add(double height_m, double tolerance_m) {
        above |= height_m > tolerance_m;
        below |= height_m < -tolerance_m;
    }
};

/// One lamp's geometry, and the planes looked at so far.
struct Search {
    const Scene& scene;
    const Lamp& lamp;
    const std::vector<std::size_t>& reached;
    std::vector<Corners> boxes;  // [reached]
    double tolerance_m = 0.0;
    std::vector<Plane> planes;
};

Search start_search(const Scene& scene, const Lamp& lamp, const std::vector<std::size_t>& reached) {
    Search search{scene, lamp, reached, {}, 0.0, {}};
    double largest_m = 0.0;
    const auto include = [&](glm::dvec3 p) {
        largest_m = std::max({largest_m, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    };
    for (const std::size_t i : reached) {
        search.boxes.push_back(box_corners(scene, scene.instances[i]));
        std::for_each(search.boxes.back().begin(), search.boxes.back().end(), include);
    }
    for (const PlacedSlab& slab : lamp.slabs)
        std::for_each(slab.u_corners_world_m.begin(), slab.u_corners_world_m.end(), include);
    search.tolerance_m = kUnits * largest_m;
    return search;
}

Sides sides_of_lamp(const Search& search, const Plane& plane) {
    Sides sides;
    for (const PlacedSlab& slab : search.lamp.slabs)
        for (const glm::dvec3 corner : slab.u_corners_world_m)
            sides.add(plane.height_m(corner), search.tolerance_m);
    return sides;
}

/// Whether the instance has points on the plane's other side than the lamp. Boxes tell most.
bool is_opposite(const Search& search, std::size_t k, const Plane& plane, const Sides& lamp) {
    const auto is_beyond = [&](const Sides& sides) {
        return (lamp.above && sides.below) || (lamp.below && sides.above);
    };
    Sides of_box;
    for (const glm::dvec3 corner : search.boxes[k])
        of_box.add(plane.height_m(corner), search.tolerance_m);
    if (!is_beyond(of_box))
        return false;
    const Instance& instance = search.scene.instances[search.reached[k]];
    Sides sides;
    for (const glm::vec3 p :
         search.scene.meshes[static_cast<std::size_t>(instance.mesh)].positions_m)
        sides.add(plane.height_m(to_world(instance, p)), search.tolerance_m);
    return is_beyond(sides);
}

bool is_known(const Search& search, const Plane& plane) {
    return std::any_of(search.planes.begin(), search.planes.end(), [&](const Plane& known) {
        const double cosine = glm::dot(known.normal, plane.normal);
        return std::abs(cosine) > 1.0 - kSameDirection &&
               std::abs(known.offset_m - std::copysign(1.0, cosine) * plane.offset_m) <=
                   search.tolerance_m;
    });
}

/// Nothing for a triangle without area, which stops no light.
std::optional<Plane> plane_of(const Instance& instance, const Mesh& mesh, glm::uvec3 triangle) {
    const glm::dvec3 a = to_world(instance, mesh.positions_m[triangle.x]);
    const glm::dvec3 normal = glm::cross(to_world(instance, mesh.positions_m[triangle.y]) - a,
                                         to_world(instance, mesh.positions_m[triangle.z]) - a);
    const double length = glm::length(normal);
    if (!(length > 0.0))
        return std::nullopt;
    return Plane{normal / length, glm::dot(normal, a) / length};
}

/// Indices into `reached`, small instances first: a post is a better answer than the road.
std::vector<std::size_t> by_size(const Search& search) {
    std::vector<std::size_t> order(search.reached.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto diagonal_m = [&](std::size_t k) {
        return glm::distance(search.boxes[k].front(), search.boxes[k].back());
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return diagonal_m(a) < diagonal_m(b); });
    return order;
}

/// What lies behind the plane of instance reached[k], as seen from the lamp: another instance
/// rather than itself.
std::optional<std::size_t> find_behind(const Search& search, std::size_t k, const Plane& plane) {
    const Sides lamp = sides_of_lamp(search, plane);
    if (lamp.above && lamp.below)
        return k;
    for (std::size_t other = 0; other < search.reached.size(); ++other)
        if (other != k && is_opposite(search, other, plane, lamp))
            return other;
    return is_opposite(search, k, plane, lamp) ? std::optional(k) : std::nullopt;
}

}  // namespace

std::string name_of_instance(const Scene& scene, std::size_t instance) {
    const std::string& name = scene.instances[instance].name;
    return name.empty() ? fmt::format("instance {}", instance) : fmt::format("'{}'", name);
}

std::vector<std::size_t> instances_reached(const Scene& scene, const Lamp& lamp) {
    std::vector<std::size_t> reached;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (scene.meshes[static_cast<std::size_t>(instance.mesh)].triangles.empty())
            continue;
        const Corners corners = box_corners(scene, instance);
        if (std::any_of(lamp.slabs.begin(), lamp.slabs.end(),
                        [&](const PlacedSlab& slab) { return may_meet(slab, corners); }))
            reached.push_back(i);
    }
    return reached;
}

std::optional<std::string> find_occluder(const Scene& scene,
                                         const Lamp& lamp,
                                         const std::vector<std::size_t>& reached,
                                         const std::vector<bool>& is_blocking) {
    Search search = start_search(scene, lamp, reached);
    std::optional<std::string> found;
    for (const std::size_t k : by_size(search)) {
        const Instance& instance = scene.instances[reached[k]];
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        if (!is_blocking[reached[k]])
            continue;
        for (const glm::uvec3 triangle : mesh.triangles) {
            const std::optional<Plane> plane = plane_of(instance, mesh, triangle);
            if (!plane || is_known(search, *plane))
                continue;
            const std::string name = name_of_instance(scene, reached[k]);
            if (search.planes.size() == kMostPlanes)
                return found ? found
                             : fmt::format("{} and what is before it lie in more than {} planes",
                                           name, kMostPlanes);
            search.planes.push_back(*plane);
            const std::optional<std::size_t> behind = find_behind(search, k, *plane);
            if (behind && *behind != k)
                return fmt::format("{} may stand between lamp '{}' and {}", name, lamp.name,
                                   name_of_instance(scene, reached[*behind]));
            if (behind && !found)
                found =
                    fmt::format("{} may shadow itself in the light of lamp '{}'", name, lamp.name);
        }
    }
    return found;
}

}  // namespace nearfield::render
