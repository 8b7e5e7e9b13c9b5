// SPDX-License-Identifier: Apache-2.0
// However slow frames are, nothing that was pressed is lost, and it is pressed where the mouse was.
#include "app/viewer/events.h"

#include <gtest/gtest.h>

#include <vector>

namespace nearfield::viewer {
namespace {

using Kind = InputEvent::Kind;

InputEvent move(float x) {
    return {Kind::Move, 0, false, glm::vec2(x, 0.0F)};
}
InputEvent button(bool is_down) {
    return {Kind::Button, 0, is_down};
}
InputEvent key(int code, bool is_down) {
    return {Kind::Key, code, is_down};
}

/// Events' numbers, frame by frame.
std::vector<std::size_t> frames_of(std::deque<InputEvent> events) {
    std::vector<std::size_t> frames;
    while (!events.empty()) {
        frames.push_back(events_of_a_frame(events));
        events.erase(events.begin(), events.begin() + static_cast<std::ptrdiff_t>(frames.back()));
    }
    return frames;
}

TEST(ViewerEvents, MovesAreTakenTogether) {
    EXPECT_EQ(events_of_a_frame({}), 0U);
    EXPECT_EQ(frames_of({move(1), move(2), move(3)}), std::vector<std::size_t>{3});
}

TEST(ViewerEvents, ADragBeginsWhereTheButtonWasPressed) {
    EXPECT_EQ(frames_of({move(1), button(true), move(2), move(3), button(false), move(4)}),
              (std::vector<std::size_t>{2, 3, 1}));
    EXPECT_EQ(frames_of({button(true), button(false)}), (std::vector<std::size_t>{1, 1}));
}

TEST(ViewerEvents, AKeyThatIsTappedIsHeldForAFrame) {
    constexpr int kCtrl = 341, kZ = 90, kSpace = 32;
    EXPECT_EQ(frames_of({key(kSpace, true), key(kSpace, false), key(kCtrl, true), key(kZ, true),
                         key(kZ, false), key(kCtrl, false)}),
              (std::vector<std::size_t>{1, 3, 2}));
    // Let go in the other order, and seen in the middle of it.
    EXPECT_EQ(frames_of({key(kZ, true), key(kCtrl, false), key(kZ, false)}),
              (std::vector<std::size_t>{1, 2}));
}

}  // namespace
}  // namespace nearfield::viewer
