// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/develop.h"

#include <glm/glm.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace nearfield::viewer {

/// Where a window is on its display; position none: wherever the display puts it.
struct WindowPlace {
    glm::ivec2 size_px{1280, 720};
    bool has_position = false;
    glm::ivec2 position_px{0};
};

/// A window with an OpenGL 4.5 context, which is current in the thread that made it, and ImGui's
/// input and drawing in it. One at a time.
class Window {
  public:
    /// Throws Error where there is no display, or no such context.
    explicit Window(const WindowPlace& place);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    bool is_closing() const;
    void close();
    void set_title(const std::string& title);
    /// Called with each file that is dropped on the window.
    void on_drop(std::function<void(const std::string&)> drop);
    glm::ivec2 size_px() const;  // of what is drawn into
    WindowPlace place() const;

    /// Sleeps until something happens or wake() is called, or for timeout_s (below 0: any time).
    void wait(double timeout_s);
    /// From any thread.
    static void wake();

    /// Whether there are some that ImGui has not had yet: a frame takes only so many.
    bool has_events() const;

    /// Between the two ImGui is drawn; draw_picture() puts the picture behind it, which fills the
    /// window, pixel by pixel or stretched.
    void begin();
    void draw_picture();
    void end();
    /// Shows what was drawn.
    void swap();
    void set_picture(const Developed& picture);

    /// What was drawn, [row from the top][column][r, g, b]; between end() and swap().
    std::vector<unsigned char> pixels() const;

  private:
    void receive_events();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace nearfield::viewer
