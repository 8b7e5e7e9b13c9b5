// SPDX-License-Identifier: Apache-2.0
#include "formats/model/sampler_draws.h"
#include "formats/shared/draw.glsl.h"

namespace nearfield::model {

glm::vec2 plane_point(Sequence sequence, std::uint32_t q, std::uint32_t count, glm::vec2 shift) {
    return shared::plane_point(word_of(sequence), q, count, shift);
}

float second_coordinate(Sequence sequence, std::uint32_t q, glm::vec2 shift) {
    return shared::second_coordinate(word_of(sequence), q, shift);
}

}  // namespace nearfield::model
