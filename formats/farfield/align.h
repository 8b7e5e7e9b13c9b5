// SPDX-License-Identifier: Apache-2.0
/// How one lamp must be turned and moved so that it shines as another does.
#pragma once

#include "formats/farfield/lamp_view.h"
#include "formats/files/lightfield.h"

namespace nearfield::farfield {

/// p_a = rotation * p_b + translation_m. The rotation makes intensities agree best in directions
/// where A shines, from the best of 24 turns about z on; the translation, of two light fields,
/// illuminance at 2 and 5 lamp sizes from A, from the difference of their light's centers on.
/// Rotations that intensity does not show (about an axis of symmetry) stay as they are.
Rigid align(const LampView& a, const LampView& b, std::uint32_t seed);

/// The same direction in B's frame.
inline glm::dvec3 direction_in_b(const Rigid& a_from_b, const glm::dvec3& direction_a) {
    return glm::transpose(a_from_b.rotation) * direction_a;
}

}  // namespace nearfield::farfield
