// SPDX-License-Identifier: Apache-2.0
// Lamps in the picture: closed form of a window's radiance, who hides it, and that nothing else
// changes. Both devices.
#include "render/seen_lamps.h"

#include "render/cpu/render.h"
#include "render/film.h"
#include "render/gpu/render.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

using test::layer;

constexpr double kAperture_m = 0.2;
constexpr float kCoefficient = 50.0F;

/// A floor, and a lamp at (0, 0, 1) that shines along +x into a camera 2 m before its U plane.
Scene into_the_camera(glm::dvec3 eye = {2.0 - test::kWindowDelta, 0.0, 1.0}) {
    Scene scene = test::floor_scene();
    scene.luminaires = {test::write_lamp(test::one_window_lamp(kAperture_m, kCoefficient), "seen",
                                         test::pose({0, 0, 1}, {1, 0, 0}))};
    scene.cameras = {test::camera_at(eye, {-1, 0, 0}, {0, 0, 1}, 0.3)};
    return scene;
}

RenderOptions options_for(bool shows_lamps) {
    RenderOptions options;
    options.size_px = {61, 41};
    options.shows_lamps = shows_lamps;
    return options;
}

std::vector<float> seen_in(const Scene& scene) {
    const std::vector<float> cpu =
        layer(render_cpu(scene, options_for(true)).picture, kSeenLamps).values;
    EXPECT_EQ(cpu, layer(render_gl(scene, options_for(true)).picture, kSeenLamps).values);
    return cpu;
}

float most(const std::vector<float>& values) {
    return *std::max_element(values.begin(), values.end());
}

// L = delta^2 C / cos^4, of which every pixel's angle is known.
TEST(SeenLamps, AWindowsRadianceIsItsClosedForm) {
    const std::vector<float> seen = seen_in(into_the_camera());
    const double unit_px = 0.5 * 41 / std::tan(0.15);
    int lit = 0;
    for (int y = 0; y < 41; ++y)
        for (int x = 0; x < 61; ++x) {
            const glm::dvec2 t((x + 0.5 - 30.5) / unit_px, (y + 0.5 - 20.5) / unit_px);
            // U is 2 m away.
            const glm::dvec2 u_m = 2.0 * glm::abs(t);
            if (std::abs(std::max(u_m.x, u_m.y) - 0.5 * kAperture_m) < 1e-6)
                continue;  // its very edge
            const bool is_inside = std::max(u_m.x, u_m.y) < 0.5 * kAperture_m;
            const double r2 = 1.0 + glm::dot(t, t);
            const double wanted = is_inside ? test::kWindowDelta * test::kWindowDelta *
                                                  static_cast<double>(kCoefficient) * r2 * r2
                                            : 0.0;
            EXPECT_NEAR(seen[static_cast<std::size_t>(3 * (y * 61 + x))], wanted, 1e-5 * wanted)
                << x << " " << y;
            lit += is_inside ? 1 : 0;
        }
    EXPECT_GT(lit, 150);
}

TEST(SeenLamps, AreNotSeenFromBehindOrThroughASheet) {
    Scene scene = into_the_camera();
    ASSERT_GT(most(seen_in(scene)), 0.0F);
    EXPECT_EQ(most(seen_in(into_the_camera({-0.5, 0.0, 1.0}))), 0.0F);
    Mesh sheet = test::rectangle("sheet", glm::vec2(1.0F));
    scene.meshes.push_back(sheet);
    glm::dmat4 upright = test::pose({1.0, 0.0, 1.0}, {1, 0, 0});
    scene.instances.push_back({"sheet", static_cast<int>(scene.meshes.size()) - 1, upright});
    EXPECT_EQ(most(seen_in(scene)), 0.0F);
    scene.instances.back().world_from_mesh[3].x = -0.5;  // behind the lamp
    EXPECT_GT(most(seen_in(scene)), 0.0F);
}

TEST(SeenLamps, DimIsAFactorAndScaleIsNone) {
    Scene scene = into_the_camera();
    const float bright = most(seen_in(scene));
    scene.luminaires[0].dim = 0.5;
    EXPECT_EQ(most(seen_in(scene)), 0.5F * bright);
    scene.luminaires[0].dim = 1.0;
    glm::dmat4& pose = scene.luminaires[0].world_from_luminaire;
    for (int axis = 0; axis < 3; ++axis)
        pose[axis] *= 3.0;
    // U is three times as wide and lies 0.3 m behind S, so the eye is 2.2 m away from it.
    const std::vector<float> scaled = seen_in(scene);
    EXPECT_NEAR(scaled[3 * (20 * 61 + 30)], 0.5F, 1e-5F);
    EXPECT_GT(std::count_if(scaled.begin(), scaled.end(), [](float v) { return v > 0.0F; }), 3000);
}

TEST(SeenLamps, EverythingElseIsAsWithoutThem) {
    const Scene scene = into_the_camera();
    const Picture with = render_cpu(scene, options_for(true)).picture,
                  without = render_cpu(scene, options_for(false)).picture;
    ASSERT_EQ(with.layers.size(), without.layers.size() + 1);
    for (std::size_t k = 0; k < without.layers.size(); ++k) {
        if (k == kRadiance)
            continue;
        EXPECT_EQ(with.layers[k].values, without.layers[k].values) << without.layers[k].name;
    }
    const std::vector<float>& seen = with.layers.back().values;
    for (std::size_t i = 0; i < seen.size(); ++i)
        ASSERT_EQ(with.layers[kRadiance].values[i], without.layers[kRadiance].values[i] + seen[i]);
}

}  // namespace
}  // namespace nearfield::render
