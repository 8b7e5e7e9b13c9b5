// SPDX-License-Identifier: Apache-2.0
// Views, handles and what is under the mouse.
#include "app/viewer/gizmo.h"
#include "app/viewer/view.h"
#include "render/film.h"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <random>

namespace nearfield::viewer {
namespace {

constexpr glm::ivec2 kSize(640, 360);

View some_view() {
    return look_at({1.0, 2.0, -3.0}, {0.2, 0.4, 5.0}, 0.8);
}

void expect_near(glm::dvec3 a, glm::dvec3 b, double within = 1e-9) {
    EXPECT_LT(glm::length(a - b), within)
        << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

// Against the renderer's own rays, written apart.
TEST(ViewerView, RaysAreTheRenderers) {
    const Camera camera = some_view().camera;
    for (const glm::dvec2 at : {glm::dvec2(0.5, 0.5), glm::dvec2(320.0, 180.0),
                                glm::dvec2(639.5, 0.5), glm::dvec2(17.0, 333.0)}) {
        expect_near(ray_through(camera, kSize, at).direction, render::camera_ray(camera, kSize, at),
                    1e-12);
        const Ray ray = ray_through(camera, kSize, at);
        const auto back = projected(camera, kSize, ray.from_world_m + 3.7 * ray.direction);
        ASSERT_TRUE(back);
        EXPECT_LT(glm::length(*back - at), 1e-9);
    }
    EXPECT_FALSE(projected(camera, kSize, eye_of(some_view()) - ahead_of(some_view())));
}

TEST(ViewerView, OrbitKeepsThePivotAndItsDistance) {
    View view = some_view();
    const glm::dvec3 pivot = pivot_of(view);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> any(-0.7, 0.7);
    for (int k = 0; k < 300; ++k) {
        view = orbited(view, any(random), any(random));
        expect_near(pivot_of(view), pivot, 1e-6);
        EXPECT_NEAR(glm::length(eye_of(view) - pivot), view.distance_m, 1e-9);
        EXPECT_LT(std::abs(ahead_of(view).y), 0.99999);              // never over the pole
        EXPECT_NEAR(view.camera.world_from_camera[0].y, 0.0, 1e-6);  // no roll
    }
}

TEST(ViewerView, PannedPointsStayUnderTheMouse) {
    const View view = some_view(), after = panned(view, {37.0, -12.0}, kSize.y);
    const auto at = projected(after.camera, kSize, pivot_of(view));
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->x, 320.0 + 37.0, 1e-6);
    EXPECT_NEAR(at->y, 180.0 - 12.0, 1e-6);
}

TEST(ViewerView, LampsAreFoundWhereTheyAreSeen) {
    Scene scene;
    LuminaireInstance lamp;
    lamp.world_from_luminaire = glm::translate(glm::dmat4(1.0), glm::dvec3(0.2, 0.4, 5.0));
    scene.luminaires = {lamp};
    const Document document = document_of(scene, "");
    const View view = some_view();
    EXPECT_EQ(lamp_at(document, view.camera, kSize, {322.0, 183.0}, 10.0), std::optional(0));
    EXPECT_EQ(lamp_at(document, view.camera, kSize, {322.0, 193.0}, 10.0), std::nullopt);
}

glm::dmat4 some_pose() {
    return glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0.2, 0.4, 5.0)), 0.3,
                       glm::dvec3(0, 1, 0));
}

Ray ray_to(const Camera& camera, glm::dvec3 at_world_m) {
    return ray_through(camera, kSize, *projected(camera, kSize, at_world_m));
}

TEST(ViewerGizmo, HandlesAreWhereTheyAreDrawn) {
    const Camera camera = some_view().camera;
    for (const bool has_lamps_axes : {false, true}) {
        const Gizmo gizmo = gizmo_of(some_pose(), camera, has_lamps_axes);
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis), u = (a + 1) % 3, v = (a + 2) % 3;
            const glm::dvec3 tip = gizmo.at_world_m + 0.97 * gizmo.size_m * gizmo.axes[a];
            EXPECT_EQ(handle_at(gizmo, ray_to(camera, tip)),
                      std::optional(Handle{HandleKind::Move, axis}));
            const glm::dvec3 on_ring = gizmo.at_world_m + kRingOfSize * gizmo.size_m *
                                                              (std::cos(0.9) * gizmo.axes[u] +
                                                               std::sin(0.9) * gizmo.axes[v]);
            const auto found = handle_at(gizmo, ray_to(camera, on_ring));
            ASSERT_TRUE(found);
            EXPECT_EQ(found->kind, HandleKind::Turn);
        }
        const glm::dvec3 beside = gizmo.at_world_m + 3.0 * gizmo.size_m * gizmo.axes[1];
        EXPECT_FALSE(handle_at(gizmo, ray_to(camera, beside)));
    }
}

// A point of the handle that is taken and moved along goes where the mouse is.
TEST(ViewerGizmo, WhatIsTakenFollowsTheMouse) {
    const Camera camera = some_view().camera;
    const Gizmo gizmo = gizmo_of(some_pose(), camera, false);
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 along = gizmo.axes[static_cast<std::size_t>(axis)];
        const glm::dvec3 taken = gizmo.at_world_m + 0.5 * gizmo.size_m * along;
        const Drag drag{{HandleKind::Move, axis}, gizmo, some_pose(), ray_to(camera, taken)};
        const glm::dmat4 pose = dragged(drag, ray_to(camera, taken + 0.31 * along));
        expect_near(glm::dvec3(pose[3]), glm::dvec3(some_pose()[3]) + 0.31 * along);
        expect_near(glm::dvec3(pose[2]), glm::dvec3(some_pose()[2]));
        const glm::dmat4 stepped = dragged(drag, ray_to(camera, taken + 0.31 * along), 0.05);
        expect_near(glm::dvec3(stepped[3]), glm::dvec3(some_pose()[3]) + 0.30 * along);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis), u = (a + 1) % 3, v = (a + 2) % 3;
        const auto on_ring = [&](double angle) {
            return gizmo.at_world_m +
                   kRingOfSize * gizmo.size_m *
                       (std::cos(angle) * gizmo.axes[u] + std::sin(angle) * gizmo.axes[v]);
        };
        const Drag drag{{HandleKind::Turn, axis}, gizmo, some_pose(), ray_to(camera, on_ring(0.4))};
        const glm::dmat4 pose = dragged(drag, ray_to(camera, on_ring(1.1)));
        const glm::dmat4 expected = glm::rotate(glm::dmat4(1.0), 0.7, gizmo.axes[a]) * some_pose();
        expect_near(glm::dvec3(pose[2]), glm::dvec3(expected[2]));
        expect_near(glm::dvec3(pose[0]), glm::dvec3(expected[0]));
        expect_near(glm::dvec3(pose[3]), glm::dvec3(some_pose()[3]));
    }
}

TEST(ViewerGizmo, ARayThatSaysNothingMovesNothing) {
    const Gizmo gizmo{{0, 0, 0}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 1.0};
    const Ray along{{-5.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    EXPECT_FALSE(along_axis_m(gizmo, 0, along));
    EXPECT_FALSE(about_axis_rad(gizmo, 1, along));
    const Drag drag{{HandleKind::Move, 0}, gizmo, glm::dmat4(1.0), along};
    EXPECT_EQ(dragged(drag, along), glm::dmat4(1.0));
}

}  // namespace
}  // namespace nearfield::viewer
