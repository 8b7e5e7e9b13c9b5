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

Waist find_waist(const RaySet& set,
                 const std::vector<Member>& members,
                 const glm::dmat3& file_from_slab) {
    // A ray crosses height z at a + t z (t: tangents). sum w |a + t z - mean|^2 is a parabola in z
    // with its minimum at z = -cov(a, t) / var(t). Two passes: the covariance of differences from
    // the mean keeps its digits.
    const glm::dmat3 slab_from_file = glm::transpose(file_from_slab);
    const auto line = [&](const Ray& ray, glm::dvec2& a, glm::dvec2& t) {
        const glm::dvec3 p = slab_from_file * glm::dvec3(ray.position_m);
        const glm::dvec3 d = slab_from_file * glm::dvec3(ray.direction);
        t = glm::dvec2(d) / d.z;
        a = glm::dvec2(p) - t * p.z;
        return p.z;
    };
    Waist waist{0.0, 1e300};
    double weight = 0.0, start = 0.0;
    glm::dvec2 a{0}, t{0}, mean_a{0}, mean_t{0};
    for (const Member& member : members) {
        const Ray& ray = set.rays[member.ray];
        const double z = line(ray, a, t);
        const double w = static_cast<double>(ray.flux) * member.share;
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
    for (const Member& member : members) {
        const Ray& ray = set.rays[member.ray];
        line(ray, a, t);
        const double w = static_cast<double>(ray.flux) * member.share;
        covariance += w * glm::dot(a - mean_a, t - mean_t);
        variance += w * glm::dot(t - mean_t, t - mean_t);
    }
    // Tangents that differ by less than 1e-6 cross nowhere that floats could tell.
    waist.s_m = variance > 1e-12 * weight ? -covariance / variance : start / weight;
    return waist;
}

std::vector<Crossing> propagate(const RaySet& set,
                                const std::vector<Member>& members,
                                const Planes& planes) {
    const glm::dmat3 slab_from_file = glm::transpose(planes.file_from_slab);
    std::vector<Crossing> crossings(members.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, members.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Member& member = members[i];
            const Ray& ray = set.rays[member.ray];
            const glm::dvec3 p = slab_from_file * glm::dvec3(ray.position_m);
            const glm::dvec3 d = slab_from_file * glm::dvec3(ray.direction);
            const glm::dvec2 tangent = glm::dvec2(d) / d.z;
            crossings[i] = {glm::vec2(glm::dvec2(p) + tangent * (planes.u_m - p.z)),
                            glm::vec2(glm::dvec2(p) + tangent * (planes.s_m - p.z)),
                            ray.flux * member.share, member.share, member.ray};
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
