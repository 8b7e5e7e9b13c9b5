// SPDX-License-Identifier: Apache-2.0
// Panels without a window: ImGui in a surfaceless context, with a mouse and keys made by hand.
#include "app/viewer/panels.h"

#include "render/gpu/headless.h"
#include "render/gpu/objects.h"
#include "tests/render/scenes.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <memory>
#include <vector>

namespace nearfield::viewer {
namespace {

constexpr glm::ivec2 kWindow(1280, 720);

/// ImGui with a frame of its own to draw into.
class Screen {
  public:
    Screen() {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = ImVec2(kWindow.x, kWindow.y);
        io.DeltaTime = 1.0F / 60.0F;
        io.KeyMap[ImGuiKey_Enter] = GLFW_KEY_ENTER;
        io.KeyMap[ImGuiKey_A] = GLFW_KEY_A;
        io.KeyMap[ImGuiKey_Backspace] = GLFW_KEY_BACKSPACE;
        ImGui_ImplOpenGL3_Init("#version 450 core");
        GLuint texture = 0, framebuffer = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &texture);
        glTextureStorage2D(texture, 1, GL_RGBA8, kWindow.x, kWindow.y);
        glCreateFramebuffers(1, &framebuffer);
        glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
        texture_ = render::gpu::Texture(texture);
        framebuffer_ = render::gpu::Framebuffer(framebuffer);
    }
    ~Screen() {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui::DestroyContext();
    }
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    void draw(Viewer& viewer, PanelState& state) {
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
        glViewport(0, 0, kWindow.x, kWindow.y);
        glClear(GL_COLOR_BUFFER_BIT);
        ImGui_ImplOpenGL3_NewFrame();
        ImGui::NewFrame();
        draw_panels(viewer, state, glm::vec2(kWindow));
        handle_input(viewer, state, glm::vec2(kWindow));
        draw_overlay(viewer, state, glm::vec2(kWindow));
        ImGui::Render();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
        EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    }

    /// Pixels that are not black.
    int drawn() const {
        std::vector<std::uint32_t> pixels(static_cast<std::size_t>(kWindow.x * kWindow.y));
        glGetTextureImage(texture_.id(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                          static_cast<GLsizei>(4 * pixels.size()), pixels.data());
        return static_cast<int>(std::count_if(pixels.begin(), pixels.end(), [](std::uint32_t rgba) {
            return (rgba & 0xFFFFFFU) != 0U;
        }));
    }

  private:
    render::gpu::HeadlessContext context_;
    render::gpu::Texture texture_;
    render::gpu::Framebuffer framebuffer_;
};

class ViewerPanels : public testing::Test {
  protected:
    void SetUp() override {
        Scene scene = test::with_second_lamp(test::uneven_scene());
        take(viewer_, {document_of(scene, "scene.gltf"), {}});
        draw();
    }

    void draw(int frames = 3) {
        for (int k = 0; k < frames; ++k)
            screen_.draw(viewer_, state_);
    }
    glm::vec2 middle_of(const std::string& name, float at = 0.5F) {
        const auto found = state_.places.find(name);
        if (found == state_.places.end()) {
            ADD_FAILURE() << "no widget '" << name << "'";
            return glm::vec2(0.0F);
        }
        const glm::vec4 place = found->second;
        return {glm::mix(place.x, place.z, at), 0.5F * (place.y + place.w)};
    }
    void move_to(glm::vec2 at) {
        ImGui::GetIO().MousePos = ImVec2(at.x, at.y);
        draw();
    }
    void press(bool is_down) {
        ImGui::GetIO().MouseDown[0] = is_down;
        draw(2);
    }
    void click(const std::string& name, float at = 0.5F) {
        move_to(middle_of(name, at));
        press(true);
        press(false);
    }
    void key(int key, bool ctrl = false) {
        ImGuiIO& io = ImGui::GetIO();
        io.KeyCtrl = ctrl;
        io.KeysDown[key] = true;
        draw(1);
        io.KeysDown[key] = false;
        io.KeyCtrl = false;
        draw(1);
    }
    void type(const std::string& text) {
        key(GLFW_KEY_A, true);
        ImGui::GetIO().AddInputCharactersUTF8(text.c_str());
        draw(1);
        key(GLFW_KEY_ENTER);
    }
    const LuminaireInstance& lamp(std::size_t k) { return viewer_.history.now.lamps[k].luminaire; }

    Screen screen_;
    Viewer viewer_;
    PanelState state_;
};

TEST_F(ViewerPanels, AreThere) {
    EXPECT_GT(screen_.drawn(), 20'000);
    key(GLFW_KEY_TAB);
    draw();
    const int without = screen_.drawn();
    EXPECT_LT(without, 20'000);
    key(GLFW_KEY_F1);
    draw();
    EXPECT_GT(screen_.drawn(), without + 5'000);
}

TEST_F(ViewerPanels, ASwitchIsASwitch) {
    click("on uneven");
    EXPECT_FALSE(lamp(0).on);
    click("undo");
    EXPECT_TRUE(lamp(0).on);
    click("redo");
    EXPECT_FALSE(lamp(0).on);
}

TEST_F(ViewerPanels, NumbersCanBeTyped) {
    click("lamp second");
    click("x m", 0.2F);
    type("1.25");
    EXPECT_EQ(lamp(1).world_from_luminaire[3].x, 1.25);
    EXPECT_EQ(viewer_.history.past.size(), 1U);
    click("yaw deg", 0.2F);
    type("30");
    EXPECT_NEAR(glm::degrees(std::atan2(lamp(1).world_from_luminaire[2].x,
                                        lamp(1).world_from_luminaire[2].z)),
                30.0, 1e-9);
}

TEST_F(ViewerPanels, ASliderThatIsHeldIsOneStep) {
    move_to(middle_of("dim", 0.5F));
    press(true);
    for (const float at : {0.4F, 0.3F, 0.2F})
        move_to(middle_of("dim", at));
    press(false);
    EXPECT_LT(lamp(0).dim, 0.7);
    EXPECT_EQ(viewer_.history.past.size(), 1U);
    key(GLFW_KEY_Z, true);
    EXPECT_EQ(lamp(0).dim, 1.0);
}

TEST_F(ViewerPanels, HandlesAreDragged) {
    const glm::dvec3 before(lamp(0).world_from_luminaire[3]);
    viewer_.view = look_at(before + glm::dvec3(0.3, 1.2, 3.0), before, 0.8);
    draw();
    const glm::vec2 at = middle_of("handle x");
    move_to(at);
    ASSERT_TRUE(viewer_.hot);
    press(true);
    ASSERT_TRUE(viewer_.drag);
    for (int k = 1; k <= 5; ++k)
        move_to(at + glm::vec2(8.0F * static_cast<float>(k), 0.0F));
    press(false);
    const glm::dvec3 after(lamp(0).world_from_luminaire[3]);
    EXPECT_GT(after.x - before.x, 0.02);
    EXPECT_EQ(after.y, before.y);
    EXPECT_EQ(after.z, before.z);
    EXPECT_EQ(viewer_.history.past.size(), 1U);
    // And the handle is still under the mouse.
    const glm::vec2 moved = middle_of("handle x");
    EXPECT_NEAR(moved.x, at.x + 40.0F, 3.0F);
}

TEST_F(ViewerPanels, EmptySpaceTurnsTheView) {
    key(GLFW_KEY_TAB);  // no panels, no handles
    const glm::dvec3 eye = eye_of(viewer_.view), pivot = pivot_of(viewer_.view);
    move_to({640.0F, 600.0F});
    press(true);
    move_to({700.0F, 640.0F});
    press(false);
    EXPECT_GT(glm::length(eye_of(viewer_.view) - eye), 0.01);
    EXPECT_LT(glm::length(pivot_of(viewer_.view) - pivot), 1e-9);
    EXPECT_TRUE(viewer_.history.past.empty());
}

TEST_F(ViewerPanels, KeysDoWhatTheHelpSays) {
    key(GLFW_KEY_SPACE);
    EXPECT_FALSE(lamp(0).on);
    key(GLFW_KEY_L);
    EXPECT_EQ(viewer_.look.shown, Shown::Lux);
    key(GLFW_KEY_I);
    EXPECT_TRUE(viewer_.look.has_isolux);
    key(GLFW_KEY_D, true);
    EXPECT_EQ(viewer_.history.now.lamps.size(), 3U);
    key(GLFW_KEY_DELETE);
    EXPECT_EQ(viewer_.history.now.lamps.size(), 2U);
}

}  // namespace
}  // namespace nearfield::viewer
