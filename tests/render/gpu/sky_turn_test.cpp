// SPDX-License-Identifier: Apache-2.0
// How far normals turn across a pixel, which the number of filtered samples depends on.
#include "render/cpu/tracer.h"
#include "render/film.h"
#include "render/gpu/storage.h"
#include "render/gpu/surfaces.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/sky_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::render::gpu {
namespace {

class SkyTurnTest : public GlTest {};

// Proves the turn against closed form: of a ball it is a pixel's width at its depth over the radius
// (2 % less to 15 % more, since chords are shorter than arcs and rows shorter at the poles), of the
// floor and of nothing 0; and against what the CPU finds for the same ray.
TEST_F(SkyTurnTest, IsTheBallsCurvatureTimesThePixel) {
    const Scene scene = test::with_ball(test::under(test::constant_sky(glm::vec3(1.0F))));
    const glm::ivec2 size_px(96, 72);
    const SceneBuffers buffers = upload_scene(device(), scene);
    const SurfacePass pass = make_surface_pass(device(), buffers, size_px, true);
    device().run_pass("surfaces", [&] {
        draw_surfaces(buffers, scene.cameras[0], {0.5, 0.5}, pass);
    });
    const std::vector<float> turn = read_back(pass.surfaces.turn, size_px, 1);
    const std::vector<float> position = read_back(pass.surfaces.position, size_px, 4);
    const std::vector<float> normal = read_back(pass.surfaces.normal, size_px, 4);
    const double pixel = 2.0 * std::tan(0.5 * scene.cameras[0].yfov_rad) / size_px.y;
    const Tracer tracer(scene, {~0U, ~0U}, 1);
    const glm::dvec3 eye(scene.cameras[0].world_from_camera[3]);
    int on_ball = 0, flat = 0, as_on_cpu = 0;
    for (std::size_t k = 0; k < turn.size(); ++k) {
        const glm::vec3 at(position[4 * k], position[4 * k + 1], position[4 * k + 2]);
        const double depth_m = static_cast<double>(normal[4 * k + 3]);
        const bool is_ball =
            position[4 * k + 3] > 0.0F && std::abs(glm::distance(at, {0, 0, 0.3F}) - 0.6F) < 0.01F;
        if (!is_ball || std::abs(at.z) < 0.01F) {
            flat += turn[k] == 0.0F ? 1 : 0;
            continue;
        }
        ++on_ball;
        const double ratio = static_cast<double>(turn[k]) / (pixel * depth_m / 0.6);
        EXPECT_GT(ratio, 0.98);
        EXPECT_LT(ratio, 1.15);
        const glm::ivec2 px(static_cast<int>(k) % size_px.x, static_cast<int>(k) / size_px.x);
        const glm::dvec2 at_px = glm::dvec2(px) + 0.5;
        const auto hit = tracer.trace(eye, camera_ray(scene.cameras[0], size_px, at_px));
        if (hit &&
            std::abs(tracer.curvature(*hit) * pixel * depth_m / static_cast<double>(turn[k]) -
                     1.0) < 1e-4)
            ++as_on_cpu;
    }
    EXPECT_GE(as_on_cpu, 0.99 * on_ball);  // at triangles' borders the two may see different ones
    EXPECT_GT(on_ball, 300);
    EXPECT_GT(flat, 1000);
}

}  // namespace
}  // namespace nearfield::render::gpu
