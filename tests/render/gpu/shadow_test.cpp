// SPDX-License-Identifier: Apache-2.0
#include "formats/model/profile.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/gpu/shadow_run.h"
#include "tests/render/scenes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <utility>

namespace nearfield::render::gpu {
namespace {

class ShadowTest : public GlTest {};

constexpr glm::ivec2 kSize(48, 36);
constexpr float kWeights = 1e-6F;  // rounding of 16 taps' weights in float

/// 4 x 3 images of 8 x 8 texels, uneven, 2 cm apart; the beam's tangents reach 1.5.
LightField uneven_lamp() {
    LightField lamp = test::one_window_lamp(0.02, 1.0F);
    Slab& slab = lamp.slabs[0];
    slab.grid = {4, 3};
    slab.texels = {8, 8};
    slab.s_min_m = glm::dvec2(-0.12);
    slab.s_max_m = glm::dvec2(0.12);
    slab.profile = model::make_profile("bspline");
    slab.coeffs.resize(std::size_t{12} * 64);
    for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
        slab.coeffs[i] = static_cast<float>(1 + (i * 7919) % 7);
    return lamp;
}

/// A lamp 1.2 m above the floor that lights a post standing on it.
Scene post_scene() {
    Scene scene = test::floor_scene();
    scene.luminaires = {test::write_lamp(uneven_lamp(), "uneven_shadow",
                                         test::pose({-0.6, 0.1, 1.2}, {0.4, 0, -1}))};
    Mesh post = test::rectangle("post mesh", {0.6, 0.5});
    scene.meshes.push_back(post);
    glm::dmat4 upright = glm::translate(glm::dmat4(1.0), {0.1, 0.1, 0.25});
    upright = glm::rotate(upright, 1.4, glm::dvec3(0, 0, 1));
    scene.instances.push_back({"post", 1, glm::rotate(upright, 1.5707963, glm::dvec3(1, 0, 0))});
    scene.cameras = {test::camera_at({1.2, -2.2, 1.8}, {-1.0, 2.2, -1.8}, {0, 0, 1}, 0.8)};
    return scene;
}

void expect_valid(const std::vector<float>& visibilities) {
    for (const float v : visibilities)
        EXPECT_TRUE(v == -1.0F || (v >= 0.0F && v <= 1.0F + kWeights)) << v;
}

TEST_F(ShadowTest, MapsAgreeWithRaysTheBetterTheFinerTheyAre) {
    const Scene scene = post_scene();
    ShadowRun run = make_run(device(), scene, kSize);
    const TracedCells traced = trace_cells(run, 4);
    ShadowError before{1.0, 1.0};
    for (const int map_px : {24, 96, 384}) {
        ShadowMapOptions options;
        options.map_px = map_px;
        const std::vector<float> visibilities = mapped(device(), run, options);
        expect_valid(visibilities);
        const ShadowError error = compare(traced, visibilities);
        RecordProperty("light_error_" + std::to_string(map_px), std::to_string(error.light));
        RecordProperty("pairs_" + std::to_string(map_px), std::to_string(error.pairs));
        EXPECT_GT(error.hidden, 0.02);
        EXPECT_EQ(error.outside, 0U);
        EXPECT_LT(error.light, 0.5 * before.light);
        EXPECT_LT(error.pairs, 0.7 * before.pairs);
        before = error;
    }
    // What remains are penumbrae within cells: a cell is all visible or all hidden to a map.
    EXPECT_LT(before.light, 0.002);
    EXPECT_LT(before.pairs, 0.002);
}

// The eye on U is what maps are rendered from by default.
TEST_F(ShadowTest, EyesOnUAreBetterThanEyesOnS) {
    const Scene scene = post_scene();
    ShadowRun run = make_run(device(), scene, kSize);
    const TracedCells traced = trace_cells(run, 4);
    ShadowMapOptions options;
    const double on_u = compare(traced, mapped(device(), run, options)).light;
    options.eye = ShadowEye::Paper;
    const double on_s = compare(traced, mapped(device(), run, options)).light;
    EXPECT_LT(on_u, 0.5 * on_s);
}

// A plane alone has no shadow, whatever its tilt to the light, the maps and the place in the world.
TEST_F(ShadowTest, LitPlanesHaveNoAcne) {
    Scene flat = test::floor_scene();
    flat.cameras = {test::camera_at({1.2, -2.2, 1.8}, {-1.0, 2.2, -1.8}, {0, 0, 1}, 0.8)};
    const glm::dmat4 mirror = glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0});
    const glm::dmat4 far_away = glm::translate(glm::dmat4(1.0), {1000.0, -700.0, 300.0});
    const glm::dmat4 small = glm::scale(glm::dmat4(1.0), glm::dvec3(1e-3));
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.9, glm::dvec3(1, 2, 2) / 3.0);
    for (const double down : {1.0, 0.2, 0.02, 0.0}) {
        flat.luminaires = {test::write_lamp(uneven_lamp(), "uneven_shadow",
                                            test::pose({-1.5, 0.1, 0.2}, {1, 0.1, -down}))};
        for (const glm::dmat4& matrix :
             {glm::dmat4(1.0), far_away * turn, mirror * turn, turn * small}) {
            const Scene scene = test::transformed(flat, matrix);
            ShadowRun run = make_run(device(), scene, kSize);
            for (const auto& [map_px, taps] : {std::pair{16, 16}, {192, 4}, {192, 1}}) {
                const ShadowMapOptions options{ShadowEye::Cell, 0, map_px, taps};
                for (const float v : mapped(device(), run, options))
                    ASSERT_NEAR(std::abs(v), 1.0F, kWeights)
                        << "down " << down << ", " << map_px << " px, " << taps << " taps";
            }
        }
    }
}

/// Points of the floor about the lamp's axis, whatever hides them from the camera.
Surfaces floor_points(Device& device) {
    std::vector<SurfacePoint> points;
    points.reserve(64);
    for (int k = 0; k < 64; ++k) {
        const int column = k % 8, row = k / 8;
        points.push_back(
            {{0.02F * static_cast<float>(column), 0.02F * static_cast<float>(row), 0.0F},
             {0.0F, 0.0F, 1.0F},
             {0.0F, 0.0F, 0.0F},
             0,
             0.0F});
    }
    return upload_surfaces(device, {8, 8}, points, {0, 0, 1}, false);
}

// A sheet casts its shadow from one bias before the receiver on, and none from nearer: that is the
// bound of leaking. The lamp is 2 m over the floor, looking down.
TEST_F(ShadowTest, BlockersHideFromOneBiasBeforeTheReceiverOn) {
    Scene scene = test::floor_scene();
    scene.luminaires = {
        test::write_lamp(uneven_lamp(), "uneven_shadow", test::pose({0, 0, 2}, test::kDown))};
    // All images are lit to the rims of S: every view is as wide.
    const double depth_m = 2.1, texel = (0.24 + 0.02) / 0.1 / 192.0;
    const double bias_m = depth_m * texel;
    for (const double biases : {0.8, 1.2, 10.0}) {
        Scene covered = scene;
        test::add_blocker(covered, "sheet", {0, 0, biases * bias_m}, {3, 3});
        ShadowRun run = make_run(device(), covered, {8, 8});
        run.surfaces.surfaces = floor_points(device());
        for (const int taps : {1, 4, 9, 16}) {
            ShadowMapOptions options;
            options.pcf_taps = taps;
            for (const float v : mapped(device(), run, options))
                EXPECT_NEAR(v, biases < 1.0 ? 1.0F : 0.0F, kWeights)
                    << biases << " biases, " << taps << " taps";
        }
    }
}

TEST_F(ShadowTest, ExcludedInstancesCastNone) {
    Scene scene = post_scene();
    scene.luminaires[0].excludes = {"post"};
    ShadowRun run = make_run(device(), scene, kSize);
    for (const float v : mapped(device(), run, {}))
        EXPECT_NEAR(std::abs(v), 1.0F, kWeights);
    EXPECT_EQ(run.maps.triangles, run.maps.views.views.size() * 2);  // the floor's alone
}

TEST_F(ShadowTest, CellsWithoutLightHaveNoMapAndHideNothing) {
    LightField lamp = uneven_lamp();
    for (int m = 0; m < 12; ++m)
        for (int k = 0; m % 4 != 3 && k < 64; ++k)
            lamp.slabs[0].coeffs[lamp.slabs[0].image_offset(0, m) + static_cast<std::size_t>(k)] =
                0.0F;
    Scene scene = test::floor_scene();
    scene.luminaires = {test::write_lamp(lamp, "half_dark", test::pose({0, 0, 2}, test::kDown))};
    test::add_blocker(scene, "sheet", {0, 0, 1.0}, {3, 3});
    ShadowRun run = make_run(device(), scene, {8, 8});
    run.surfaces.surfaces = floor_points(device());
    const std::vector<float> visibilities = mapped(device(), run, {});
    EXPECT_EQ(run.maps.views.views.size(), 3U * 5U);
    for (std::size_t k = 0; k < visibilities.size(); ++k)
        EXPECT_NEAR(visibilities[k], k % 30 % 6 >= 3 ? 0.0F : 1.0F, kWeights) << k;

    lamp.slabs[0].coeffs.assign(lamp.slabs[0].coeffs.size(), 0.0F);
    scene.luminaires = {test::write_lamp(lamp, "dark", test::pose({0, 0, 2}, test::kDown))};
    ShadowRun dark = make_run(device(), scene, {8, 8});
    for (const float v : mapped(device(), dark, {}))
        EXPECT_EQ(v, 1.0F);
    EXPECT_TRUE(dark.maps.views.views.empty());
}

// Receivers that no map shows are lit, and said to be outside (-1): behind U, beside the beam, at U
// and between the planes beside a map's pyramid.
TEST_F(ShadowTest, ReceiversOutsideTheMapsAreLit) {
    Scene scene = test::floor_scene();
    scene.luminaires = {
        test::write_lamp(uneven_lamp(), "uneven_shadow", test::pose({0, 0, 2}, test::kDown))};
    test::add_blocker(scene, "sheet", {0, 0, 1.9}, {9, 9});
    ShadowRun run = make_run(device(), scene, {8, 8});
    const auto at = [](float x, float y, float z) {
        return SurfacePoint{{x, y, z}, {0.0F, 0.0F, 1.0F}, {0.0F, 0.0F, 0.0F}, 0, 0.0F};
    };
    const std::vector<SurfacePoint> outside = {at(0, 0, 2.5F), at(8, 0, 0), at(0, 0, 2.1F),
                                               at(0.2F, 0, 2.09F)};
    run.surfaces.surfaces = upload_surfaces(device(), {4, 1}, outside, {0, 0, 1}, false);
    for (const float v : mapped(device(), run, {}))
        EXPECT_EQ(v, -1.0F);
    // Only the one on U, which rounding puts on either side of it, may have light.
    EXPECT_LE(count_unmapped(device(), run), 1);
    const std::vector<SurfacePoint> between = {at(0.06F, 0, 2.09F), at(0.07F, 0, 2.01F),
                                               at(-0.06F, 0.05F, 2.095F), at(0, 0, 1.0F)};
    run.surfaces.surfaces = upload_surfaces(device(), {4, 1}, between, {0, 0, 1}, false);
    EXPECT_EQ(count_unmapped(device(), run), 2);
    const std::vector<SurfacePoint> inside = {at(0, 0, 0), at(0, 0, 1.95F), at(0, 0, 2.05F), {}};
    run.surfaces.surfaces = upload_surfaces(device(), {4, 1}, inside, {0, 0, 1}, false);
    const std::vector<float> visibilities = mapped(device(), run, {});
    for (std::size_t k = 0; k < visibilities.size(); ++k)
        EXPECT_NEAR(visibilities[k], k < visibilities.size() / 4 ? 0.0F : 1.0F, kWeights) << k;
}

TEST_F(ShadowTest, MapsAreRenderedAgainOnlyWhereSomethingChanged) {
    Scene scene = post_scene();
    ShadowRun run = make_run(device(), scene, kSize);
    ShadowMapOptions options;
    const auto update = [&] {
        update_shadow_maps(device(), run.pass, run.buffers, run.lamps, 0, options, run.maps);
        return run.maps.renders;
    };
    EXPECT_EQ(update(), 1);
    EXPECT_EQ(update(), 1);
    options.map_px = 64;
    EXPECT_EQ(update(), 2);
    scene.materials[0].base_color = glm::vec3(0.1F);
    run.buffers = upload_scene(device(), scene);
    run.lamps.lamps[0].dim = 0.5F;
    EXPECT_EQ(update(), 2);  // neither matters to visibility
    scene.instances[1].world_from_mesh[3].x += 0.01;
    run.buffers = upload_scene(device(), scene);
    EXPECT_EQ(update(), 3);
    run.lamps.lamps[0].slabs[0].world_from_slab[3].x += 0.01;
    EXPECT_EQ(update(), 4);
    run.lamps.instance_masks[1] = 0;
    EXPECT_EQ(update(), 5);
    EXPECT_EQ(update(), 5);
}

}  // namespace
}  // namespace nearfield::render::gpu
