// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <deque>

namespace nearfield::viewer {

/// What a mouse or a keyboard has done.
struct InputEvent {
    enum class Kind { Move, Button, Wheel, Key, Character };

    Kind kind = Kind::Move;
    int code = 0;  // a button's, a key's (GLFW's), a character's
    bool is_down = false;
    glm::vec2 at{0.0F};  // the mouse's place, or by how much the wheel was turned
};

/// How many of the events, which are in their order, one frame of the interface may take together.
/// ImGui knows what is held at a frame, not what was in between: what was pressed and let go
/// between two frames of a slow machine must be in two of them, or it is lost, and a button's press
/// must be where the mouse was then. At least one where there is any.
std::size_t events_of_a_frame(const std::deque<InputEvent>& events);

}  // namespace nearfield::viewer
