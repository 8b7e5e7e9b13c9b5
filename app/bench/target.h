// SPDX-License-Identifier: Apache-2.0
/// What estimators are measured on: a lamp, receivers, and the exact illuminance at them.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"
#include "formats/model/mip_sum.h"
#include "formats/model/sampler.h"

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace nearfield::bench {

/// A lamp with all that any estimator reads of it.
struct Lamp {
    std::vector<model::SamplingSlab> slabs;
    std::vector<model::PreparedMips> mips;  // [slab]
};

Lamp make_lamp(const std::vector<Slab>& slabs);

struct Target {
    const Lamp* lamp = nullptr;
    std::vector<model::ReceiverF> receivers;  // [receiver][slab], in the slab's frame
    /// Luminance by the sum in double, at the same (rounded) places as the receivers.
    std::vector<float> truth_y;  // [receiver]
    glm::ivec2 size{0};          // of a grid of receivers, row by row from below; 0: scattered

    std::size_t count() const { return truth_y.size(); }
};

/// Receivers are in the luminaire's frame. Cost: 0.1 ms a receiver, thread and 60,000 texels in
/// view.
Target make_target(const Lamp& lamp,
                   std::span<const model::Receiver> receivers,
                   glm::ivec2 size = glm::ivec2(0));

/// A wall across the beam, facing the lamp: at the receivers' median distance, as wide and as high
/// as they lie there.
struct Wall {
    glm::dvec2 lower_m{0.0}, upper_m{0.0};
    double z_m = 0;
    glm::ivec2 size{0};
};
Wall wall_of(std::span<const model::Receiver> receivers, glm::ivec2 size);
std::vector<model::Receiver> receivers_on(const Wall& wall);

}  // namespace nearfield::bench
