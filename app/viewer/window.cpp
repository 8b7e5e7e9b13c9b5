// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/window.h"

#include "app/viewer/events.h"
#include "formats/files/error.h"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <iterator>
#include <optional>
#include <utility>

namespace nearfield::viewer {
namespace {

std::string last_glfw_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "no reason given" : text;
}

GLFWwindow* make_window(const WindowPlace& place) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    // The renderer's context is EGL's as well; where windows have none, the display's own.
    for (const int api : {GLFW_EGL_CONTEXT_API, GLFW_NATIVE_CONTEXT_API}) {
        glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
        if (GLFWwindow* window =
                glfwCreateWindow(place.size_px.x, place.size_px.y, "nearfield", nullptr, nullptr))
            return window;
    }
    throw Error{"cannot open a window", "OpenGL 4.5", "a context", last_glfw_error()};
}

void style(float scale) {
    ImGui::StyleColorsDark();
    ImGuiStyle& look = ImGui::GetStyle();
    look.WindowRounding = 0.0F;
    look.Colors[ImGuiCol_WindowBg].w = 0.82F;
    look.ScaleAllSizes(scale);
    constexpr float kFont_px = 13.0F;  // of ImGui's own font, which is sharp at its multiples
    ImFontConfig font;
    font.SizePixels = kFont_px * scale;
    ImGui::GetIO().Fonts->AddFontDefault(&font);
}

}  // namespace

struct Window::State {
    GLFWwindow* window = nullptr;
    GLuint texture = 0;
    glm::ivec2 texture_px{0};
    std::function<void(const std::string&)> drop;
    std::deque<InputEvent> events;  // that ImGui has not had yet
    std::optional<glm::vec2> mouse;
    std::array<bool, 5> buttons{};  // ImGui's number of them

    void tell(const InputEvent& event);
    void tell_events_of_a_frame();
};

void Window::State::tell(const InputEvent& event) {
    ImGuiIO& io = ImGui::GetIO();
    const auto code = static_cast<std::size_t>(std::max(event.code, 0));
    switch (event.kind) {
        case InputEvent::Kind::Move:
            mouse = event.at;
            break;
        case InputEvent::Kind::Button:
            if (code < buttons.size())
                buttons[code] = event.is_down;
            break;
        case InputEvent::Kind::Wheel:
            io.MouseWheelH += event.at.x;
            io.MouseWheel += event.at.y;
            break;
        case InputEvent::Kind::Key:
            if (code < std::size(io.KeysDown))
                io.KeysDown[code] = event.is_down;
            break;
        case InputEvent::Kind::Character:
            io.AddInputCharacter(static_cast<unsigned>(event.code));
            break;
    }
}

void Window::State::tell_events_of_a_frame() {
    for (std::size_t left = events_of_a_frame(events); left > 0; --left) {
        tell(events.front());
        events.pop_front();
    }
    ImGuiIO& io = ImGui::GetIO();
    const auto held = [&](int left, int right) { return io.KeysDown[left] || io.KeysDown[right]; };
    io.KeyCtrl = held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    io.KeyShift = held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    io.KeyAlt = held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
    io.KeySuper = held(GLFW_KEY_LEFT_SUPER, GLFW_KEY_RIGHT_SUPER);
    if (mouse)
        io.MousePos = ImVec2(mouse->x, mouse->y);
    std::copy(buttons.begin(), buttons.end(), std::begin(io.MouseDown));
}

Window::Window(const WindowPlace& place) : state_(std::make_unique<State>()) {
    if (glfwInit() != GLFW_TRUE)
        throw Error{"cannot open a window", "display", "one", last_glfw_error()};
    try {
        state_->window = make_window(place);
    } catch (...) {
        glfwTerminate();
        throw;
    }
    GLFWwindow* window = state_->window;
    if (place.has_position)
        glfwSetWindowPos(window, place.position_px.x, place.position_px.y);
    glfwSetWindowUserPointer(window, state_.get());
    receive_events();
    glfwMakeContextCurrent(window);
    glfwSwapInterval(1);
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    float scale_x = 1.0F, scale_y = 1.0F;
    glfwGetWindowContentScale(window, &scale_x, &scale_y);
    style(std::max(scale_x, 1.0F));
    ImGui_ImplGlfw_InitForOpenGL(window, false);  // events are handed on by begin()
    ImGui_ImplOpenGL3_Init("#version 450 core");
}

void Window::receive_events() {
    using Kind = InputEvent::Kind;
    GLFWwindow* window = state_->window;
    static const auto state_of = [](GLFWwindow* of) {
        return static_cast<State*>(glfwGetWindowUserPointer(of));
    };
    glfwSetCursorPosCallback(window, [](GLFWwindow* of, double x, double y) {
        state_of(of)->events.push_back({Kind::Move, 0, false, glm::vec2(x, y)});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* of, int button, int action, int) {
        state_of(of)->events.push_back({Kind::Button, button, action == GLFW_PRESS});
    });
    glfwSetScrollCallback(window, [](GLFWwindow* of, double x, double y) {
        state_of(of)->events.push_back({Kind::Wheel, 0, false, glm::vec2(x, y)});
    });
    glfwSetKeyCallback(window, [](GLFWwindow* of, int key, int, int action, int) {
        if (action != GLFW_REPEAT)  // ImGui repeats by itself
            state_of(of)->events.push_back({Kind::Key, key, action == GLFW_PRESS});
    });
    glfwSetCharCallback(window, [](GLFWwindow* of, unsigned character) {
        state_of(of)->events.push_back({Kind::Character, static_cast<int>(character)});
    });
    glfwSetDropCallback(window, [](GLFWwindow* of, int count, const char** paths) {
        for (int k = 0; k < count && state_of(of)->drop; ++k)
            state_of(of)->drop(paths[k]);
    });
}

bool Window::has_events() const {
    return !state_->events.empty();
}

Window::~Window() {
    glDeleteTextures(1, &state_->texture);
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(state_->window);
    glfwTerminate();
}

bool Window::is_closing() const {
    return glfwWindowShouldClose(state_->window) == GLFW_TRUE;
}

void Window::close() {
    glfwSetWindowShouldClose(state_->window, GLFW_TRUE);
}

void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(state_->window, title.c_str());
}

void Window::on_drop(std::function<void(const std::string&)> drop) {
    state_->drop = std::move(drop);
}

glm::ivec2 Window::size_px() const {
    glm::ivec2 size(0);
    glfwGetFramebufferSize(state_->window, &size.x, &size.y);
    return size;
}

WindowPlace Window::place() const {
    WindowPlace place;
    glfwGetWindowSize(state_->window, &place.size_px.x, &place.size_px.y);
    glfwGetWindowPos(state_->window, &place.position_px.x, &place.position_px.y);
    place.has_position = true;
    return place;
}

void Window::wait(double timeout_s) {
    if (timeout_s < 0.0)
        glfwWaitEvents();
    else if (timeout_s > 0.0)
        glfwWaitEventsTimeout(timeout_s);
    else
        glfwPollEvents();
}

void Window::wake() {
    glfwPostEmptyEvent();
}

void Window::begin() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    state_->tell_events_of_a_frame();
    ImGui::NewFrame();
}

void Window::draw_picture() {
    if (state_->texture == 0)
        return;
    const auto texture = static_cast<std::uintptr_t>(state_->texture);
    ImGui::GetBackgroundDrawList()->AddImage(
        // ImGui takes a texture's name as a pointer.
        reinterpret_cast<ImTextureID>(texture),  // NOLINT(performance-no-int-to-ptr)
        ImVec2(0, 0), ImGui::GetIO().DisplaySize);
}

void Window::end() {
    ImGui::Render();
    const glm::ivec2 size = size_px();
    glViewport(0, 0, size.x, size.y);
    glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::swap() {
    glfwSwapBuffers(state_->window);
}

void Window::set_picture(const Developed& picture) {
    if (state_->texture_px != picture.size_px) {
        glDeleteTextures(1, &state_->texture);
        glCreateTextures(GL_TEXTURE_2D, 1, &state_->texture);
        glTextureStorage2D(state_->texture, 1, GL_RGBA8, picture.size_px.x, picture.size_px.y);
        glTextureParameteri(state_->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTextureParameteri(state_->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        state_->texture_px = picture.size_px;
    }
    glTextureSubImage2D(state_->texture, 0, 0, 0, picture.size_px.x, picture.size_px.y, GL_RGBA,
                        GL_UNSIGNED_BYTE, picture.rgba.data());
}

std::vector<unsigned char> Window::pixels() const {
    const glm::ivec2 size = size_px();
    const auto row = static_cast<std::size_t>(3 * size.x);
    std::vector<unsigned char> read(row * static_cast<std::size_t>(size.y)), turned(read.size());
    glReadBuffer(GL_BACK);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, size.x, size.y, GL_RGB, GL_UNSIGNED_BYTE, read.data());
    for (int y = 0; y < size.y; ++y)
        std::copy_n(read.data() + static_cast<std::size_t>(size.y - 1 - y) * row, row,
                    turned.data() + static_cast<std::size_t>(y) * row);
    return turned;
}

}  // namespace nearfield::viewer
