// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/aperture.h"
#include "sample_data/bench/bench.h"

#include <glm/glm.hpp>

#include <functional>
#include <span>

namespace nearfield::sample_data {

/// A lamp as light through a plane: z = 0 of the `emitter` frame, light goes towards +z.
struct RayLamp {
    Rigid lamp_from_emitter;
    Aperture aperture;  // where on the plane it shines from
    /// Features of radiance along tangents, smallest: what nodes on the aperture must resolve.
    glm::dvec2 feature_tangent{0.0};
    /// L through point a, for one tangent.y and many tangent.x; rgb is [channel][i], cd/m^2. Zero
    /// outside the aperture. Called from many threads.
    std::function<void(
        glm::dvec2 a_m, double tangent_y, std::span<const double> tangent_x, std::span<double> rgb)>
        radiance_row;
};

/// Throws Error if the lamp's file cannot be read or holds more than one slab.
RayLamp make_ray_lamp(const BenchLamp& lamp);

/// L through point a along one direction.
glm::dvec3 radiance(const RayLamp& lamp, glm::dvec2 a_m, glm::dvec2 tangent);

}  // namespace nearfield::sample_data
