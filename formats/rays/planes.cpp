// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/planes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::rays {
namespace {

// A part of the rectangle's width that is added beyond the outermost kept ray, so that it lies
// inside.
constexpr double kMargin = 0.02;

// The interval of one coordinate that leaves out at most `trim` of the flux on either side.
template <typename Coordinate>
std::pair<double, double> bound(const std::vector<Crossing>& crossings,
                                double trim,
                                const Coordinate& coordinate) {
    std::vector<std::pair<float, float>> values(crossings.size());
    double total = 0.0;
    for (std::size_t r = 0; r < crossings.size(); ++r) {
        values[r] = {coordinate(crossings[r]), crossings[r].flux};
        total += crossings[r].flux;
    }
    tbb::parallel_sort(values.begin(), values.end());
    std::size_t first = 0, last = values.size() - 1;
    for (double left = trim * total; first < last && left >= values[first].second; ++first)
        left -= values[first].second;
    for (double left = trim * total; last > first && left >= values[last].second; --last)
        left -= values[last].second;
    const double low = values[first].first, high = values[last].first;
    // Rays through one point still need a rectangle: a micrometre, or the float's spacing far from
    // the origin.
    const double margin =
        std::max({0.5 * kMargin * (high - low), 5e-7, 1e-6 * std::abs(low), 1e-6 * std::abs(high)});
    return {low - margin, high + margin};
}

}  // namespace

std::optional<int> slab_of(glm::vec3 direction, int slab_count) {
    if (slab_count == 1)
        return direction.z > 0 ? std::optional<int>(0) : std::nullopt;
    const glm::vec3 size = glm::abs(direction);
    int slab = direction.z > 0 ? 0 : 5;
    if (size.x > size.z && size.x >= size.y)
        slab = direction.x > 0 ? 1 : 2;
    else if (size.y > size.z)
        slab = direction.y > 0 ? 3 : 4;
    return slab < slab_count ? std::optional<int>(slab) : std::nullopt;
}

glm::dmat3 file_from_slab(int slab) {
    const glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    switch (slab) {
        case 1:
            return {y, z, x};
        case 2:
            return {-y, z, -x};
        case 3:
            return {z, x, y};
        case 4:
            return {-z, x, -y};
        case 5:
            return {-x, y, -z};
        default:
            return {x, y, z};
    }
}

Waist find_waist(const RaySet& set,
                 const std::vector<std::uint32_t>& members,
                 const glm::dmat3& file_from_slab) {
    // A ray crosses height z at a + t z (t: tangents). sum w |a + t z - mean|^2 is a parabola in z
    // with its minimum at z = -cov(a, t) / var(t). Two passes: the covariance of differences from
    // the mean keeps its digits.
    const glm::dmat3 slab_from_file = glm::transpose(file_from_slab);
    const auto line = [&](std::uint32_t r, glm::dvec2& a, glm::dvec2& t) {
        const glm::dvec3 p = slab_from_file * glm::dvec3(set.rays[r].position_m);
        const glm::dvec3 d = slab_from_file * glm::dvec3(set.rays[r].direction);
        t = glm::dvec2(d) / d.z;
        a = glm::dvec2(p) - t * p.z;
        return p.z;
    };
    Waist waist{0.0, 1e300};
    double weight = 0.0, start = 0.0;
    glm::dvec2 a{0}, t{0}, mean_a{0}, mean_t{0};
    for (const std::uint32_t r : members) {
        const double z = line(r, a, t);
        const double w = set.rays[r].flux;
        waist.first_start_m = std::min(waist.first_start_m, z);
        weight += w;
        start += w * z;
        mean_a += w * a;
        mean_t += w * t;
    }
    if (!(weight > 0))
        return {0.0, 0.0};
    mean_a /= weight;
    mean_t /= weight;
    double covariance = 0.0, variance = 0.0;
    for (const std::uint32_t r : members) {
        line(r, a, t);
        covariance += set.rays[r].flux * glm::dot(a - mean_a, t - mean_t);
        variance += set.rays[r].flux * glm::dot(t - mean_t, t - mean_t);
    }
    // Tangents that differ by less than 1e-6 cross nowhere that floats could tell.
    waist.s_m = variance > 1e-12 * weight ? -covariance / variance : start / weight;
    return waist;
}

std::vector<Crossing> propagate(const RaySet& set,
                                const std::vector<std::uint32_t>& members,
                                const Planes& planes) {
    const glm::dmat3 slab_from_file = glm::transpose(planes.file_from_slab);
    std::vector<Crossing> crossings(members.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, members.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Ray& ray = set.rays[members[i]];
            const glm::dvec3 p = slab_from_file * glm::dvec3(ray.position_m);
            const glm::dvec3 d = slab_from_file * glm::dvec3(ray.direction);
            const glm::dvec2 tangent = glm::dvec2(d) / d.z;
            crossings[i] = {glm::vec2(glm::dvec2(p) + tangent * (planes.u_m - p.z)),
                            glm::vec2(glm::dvec2(p) + tangent * (planes.s_m - p.z)), ray.flux,
                            members[i]};
        }
    });
    return crossings;
}

Rectangle bound_s(const std::vector<Crossing>& crossings, double trim) {
    const auto [x0, x1] = bound(crossings, trim, [](const Crossing& c) { return c.s_m.x; });
    const auto [y0, y1] = bound(crossings, trim, [](const Crossing& c) { return c.s_m.y; });
    return {{x0, y0}, {x1, y1}};
}

Rectangle bound_u(const std::vector<Crossing>& crossings, double trim) {
    const auto [x0, x1] = bound(crossings, trim, [](const Crossing& c) { return c.u_m.x; });
    const auto [y0, y1] = bound(crossings, trim, [](const Crossing& c) { return c.u_m.y; });
    return {{x0, y0}, {x1, y1}};
}

}  // namespace nearfield::rays
