// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/events.h"

namespace nearfield::viewer {

std::size_t events_of_a_frame(const std::deque<InputEvent>& events) {
    using Kind = InputEvent::Kind;
    bool has_button = false, has_key_press = false;
    std::size_t count = 0;
    for (const InputEvent& event : events) {
        // A key is pressed together with what is held: neither may be let go in the same frame.
        const bool waits =
            (has_button && (event.kind == Kind::Button || event.kind == Kind::Move)) ||
            (has_key_press && event.kind == Kind::Key && !event.is_down);
        if (waits)
            break;
        has_button = has_button || event.kind == Kind::Button;
        has_key_press = has_key_press || (event.kind == Kind::Key && event.is_down);
        ++count;
    }
    return count;
}

}  // namespace nearfield::viewer
