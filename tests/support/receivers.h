// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"
#include "formats/model/prepared.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::support {

/// Heights of receivers over S, in units of delta, from near U to the far field; S itself and both
/// of its sides.
constexpr double kHardHeights[] = {-0.9, -0.5, -0.01, -1e-4, -1e-7, 0.0, 1e-7,
                                   1e-4, 0.01, 0.3,   1.0,   30.0,  1e3, 1e6};

/// What makes a receiver easy or hard for an estimator.
enum class ReceiverKind {
    Facing,   // normal (0, 0, -1)
    Tilted,   // any normal within 72 degrees of it; near U its plane may cut the aperture
    Cut,      // its plane passes through the middle of the aperture
    Back,     // normal (0, 0, 1): no light
    Partial,  // rays from U's middle meet S's border
    Beside,   // no ray from U to it meets S's rectangle: no light
};

struct HardReceiver {
    model::Receiver receiver;
    ReceiverKind kind;
    double height_per_delta;
    std::string name;  // kind and height
};

/// Receivers of every kind at one height, in the slab's frame. Rays through them meet S in the
/// middle half of a texel, since C_m, and so the truth at small heights, jumps at texels' edges.
std::vector<HardReceiver> hard_receivers(const Slab& slab,
                                         double height_per_delta,
                                         std::uint64_t seed);

/// A receiver as float represents it, and that one in double: one truth for both sums. Functions
/// that are called, not inlined: where GCC 12 vectorizes glm::dvec3(glm::vec3(p)) it drops both
/// conversions and with them the rounding.
model::ReceiverF as_float(const model::Receiver& receiver);
model::Receiver as_double(const model::ReceiverF& receiver);

/// Smallest and largest of n . (u - p) over the rectangle on U that holds all basis functions'
/// supports.
struct FacingRange {
    double low_m, high_m;
};
FacingRange facing_range(const Slab& slab, const model::Receiver& receiver);

}  // namespace nearfield::support
