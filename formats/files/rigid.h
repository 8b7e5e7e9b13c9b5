// SPDX-License-Identifier: Apache-2.0
/// Arithmetic of poses. Frames chain as their names do: a_from_b * b_from_c = a_from_c.
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

namespace nearfield {

inline glm::dvec3 apply(const Rigid& a_from_b, glm::dvec3 point_b) {
    return a_from_b.rotation * point_b + a_from_b.translation_m;
}

inline Rigid inverse(const Rigid& a_from_b) {
    const glm::dmat3 rotation = glm::transpose(a_from_b.rotation);
    return {rotation, -(rotation * a_from_b.translation_m)};
}

inline Rigid operator*(const Rigid& a_from_b, const Rigid& b_from_c) {
    return {a_from_b.rotation * b_from_c.rotation, apply(a_from_b, b_from_c.translation_m)};
}

}  // namespace nearfield
