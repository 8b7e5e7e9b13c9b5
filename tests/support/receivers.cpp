// SPDX-License-Identifier: Apache-2.0
#include "tests/support/receivers.h"

#include "tests/support/random.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace nearfield::support {
namespace {

/// Size of the rectangle on U that holds all supports; its center is the slab's u_center_m.
glm::dvec2 aperture_m(const Slab& slab) {
    return (glm::dvec2(slab.grid - 1) + static_cast<double>(slab.profile.cells.size())) *
           slab.pitch_m;
}

glm::dvec3 direction_within(Random& random, double lowest_cosine) {
    const double cosine = random.uniform(lowest_cosine, 1.0);
    const double azimuth_rad = random.uniform(0.0, 2.0 * std::acos(-1.0));
    const double sine = std::sqrt(1.0 - cosine * cosine);
    return {sine * std::cos(azimuth_rad), sine * std::sin(azimuth_rad), -cosine};
}

/// A point of U in the middle 60 % of the aperture.
glm::dvec2 point_on_u(const Slab& slab, Random& random) {
    const double x = random.uniform(-0.3, 0.3), y = random.uniform(-0.3, 0.3);
    return slab.u_center_m + aperture_m(slab) * glm::dvec2(x, y);
}

/// A point of S in the middle half of a texel that lies in the middle of the rectangle.
glm::dvec2 point_on_s(const Slab& slab, Random& random) {
    glm::dvec2 point_m(0.0);
    for (int d = 0; d < 2; ++d) {
        const double texel = std::floor(random.uniform(0.25, 0.75) * slab.texels[d]);
        point_m[d] = slab.s_min_m[d] + slab.texel_m()[d] * (texel + random.uniform(0.25, 0.75));
    }
    return point_m;
}

}  // namespace

std::vector<HardReceiver> hard_receivers(const Slab& slab,
                                         double height_per_delta,
                                         std::uint64_t seed) {
    Random random{seed};
    const double z_m = height_per_delta * slab.delta_m;
    const auto on_ray = [&](glm::dvec2 u_m, glm::dvec2 s_m) {
        return glm::dvec3(s_m + (s_m - u_m) * height_per_delta, z_m);
    };
    std::vector<HardReceiver> receivers;
    const auto add = [&](ReceiverKind kind, const char* name, glm::dvec3 p_m, glm::dvec3 normal) {
        std::ostringstream full;
        full << name << " at " << height_per_delta << " delta, p (" << p_m.x << ", " << p_m.y
             << ", " << p_m.z << "), n (" << normal.x << ", " << normal.y << ", " << normal.z
             << ")";
        receivers.push_back({{p_m, normal}, kind, height_per_delta, full.str()});
    };
    const auto next_position = [&] {
        const glm::dvec2 u_m = point_on_u(slab, random);
        return on_ray(u_m, point_on_s(slab, random));
    };
    const glm::dvec3 facing(0.0, 0.0, -1.0);
    add(ReceiverKind::Facing, "facing", next_position(), facing);
    for (int k = 0; k < 2; ++k) {
        const glm::dvec3 p_m = next_position();
        add(ReceiverKind::Tilted, "tilted", p_m, direction_within(random, 0.3));
    }
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p_m = next_position();
        const glm::dvec3 to_u =
            glm::normalize(glm::dvec3(point_on_u(slab, random), -slab.delta_m) - p_m);
        const glm::dvec3 any = direction_within(random, -1.0);
        add(ReceiverKind::Cut, "cut", p_m, glm::normalize(any - glm::dot(any, to_u) * to_u));
    }
    add(ReceiverKind::Back, "back-facing", next_position(), -facing);
    const glm::dvec2 border_m = slab.s_max_m - 0.5 * slab.texel_m();
    add(ReceiverKind::Partial, "partial", on_ray(slab.u_center_m, border_m),
        direction_within(random, 0.5));
    // Ten lengths of everything away: between the planes rays fan out by up to nine times the
    // aperture.
    const glm::dvec2 far_m =
        slab.s_max_m + 10.0 * (slab.s_max_m - slab.s_min_m + 2.0 * aperture_m(slab));
    add(ReceiverKind::Beside, "beside", on_ray(slab.u_center_m, far_m),
        direction_within(random, 0.5));
    return receivers;
}

model::ReceiverF as_float(const model::Receiver& receiver) {
    return {glm::vec3(receiver.position_m), glm::vec3(receiver.normal)};
}

model::Receiver as_double(const model::ReceiverF& receiver) {
    return {glm::dvec3(receiver.position_m), glm::dvec3(receiver.normal)};
}

FacingRange facing_range(const Slab& slab, const model::Receiver& receiver) {
    FacingRange range{INFINITY, -INFINITY};
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5}) {
            const glm::dvec2 u_m = slab.u_center_m + aperture_m(slab) * glm::dvec2(x, y);
            const double facing_m =
                glm::dot(receiver.normal, glm::dvec3(u_m, -slab.delta_m) - receiver.position_m);
            range.low_m = std::min(range.low_m, facing_m);
            range.high_m = std::max(range.high_m, facing_m);
        }
    return range;
}

}  // namespace nearfield::support
