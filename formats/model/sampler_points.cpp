// SPDX-License-Identifier: Apache-2.0
#include "formats/model/sampler_draws.h"
#include "formats/shared/sequences.glsl.h"

#include <bit>

namespace nearfield::model {
namespace {

glm::uvec2 shift_words(glm::vec2 shift) {
    return {shared::unit_word(shift.x), shared::unit_word(shift.y)};
}

// Scrambling's seed: all bits of a shift.
glm::uvec2 seed_words(glm::vec2 shift) {
    return {std::bit_cast<std::uint32_t>(shift.x), std::bit_cast<std::uint32_t>(shift.y)};
}

glm::vec2 unit_floats(glm::uvec2 words) {
    return {shared::unit_float(words.x), shared::unit_float(words.y)};
}

}  // namespace

glm::vec2 plane_point(Sequence sequence, std::uint32_t q, std::uint32_t count, glm::vec2 shift) {
    switch (sequence) {
        case Sequence::Halton:
            return unit_floats(shared::halton_point(q) + shift_words(shift));
        case Sequence::R2:
            return shared::r2_point(q, shift_words(shift));
        case Sequence::Fibonacci: {
            const double first = (static_cast<double>(q) + static_cast<double>(shift.x)) /
                                 static_cast<double>(count);
            return {static_cast<float>(first) < 1.0F ? static_cast<float>(first) : 0x1.fffffep-1F,
                    shared::unit_float(shared::golden_word(q) + shift_words(shift).y)};
        }
        case Sequence::Sobol:
            return unit_floats(shared::sobol_point(q, seed_words(shift)));
    }
    return glm::vec2(0.0F);
}

float second_coordinate(Sequence sequence, std::uint32_t q, glm::vec2 shift) {
    const std::uint32_t moved = shift_words(shift).y;
    switch (sequence) {
        case Sequence::Halton:
            return shared::unit_float(shared::radical_inverse_3(q + 1U) + moved);
        case Sequence::R2:
        case Sequence::Fibonacci:
            return shared::unit_float(shared::golden_word(q) + moved);
        case Sequence::Sobol:
            // Not shuffled: the first coordinate keeps the order of q. By the second shift alone,
            // which the first must not depend on; hashed, since scrambling needs all of 32 bits.
            return shared::unit_float(shared::owen_scramble(shared::sobol_second(q),
                                                            shared::hash4({moved, 0U, 0U, 4U}).x));
    }
    return 0.0F;
}

float third_shift(glm::vec2 shift) {
    const glm::uvec2 seed = seed_words(shift);
    return shared::unit_float(shared::hash4({seed.x, seed.y, 0U, 3U}).x);
}

}  // namespace nearfield::model
