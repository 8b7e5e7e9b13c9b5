// SPDX-License-Identifier: Apache-2.0
// The hard cases (docs/hard_cases.md) that can be drawn, drawn by OpenGL by every sampler, with
// shadow maps and without: nothing but light comes out, and without shadows it is the CPU's.
#include "formats/model/profile.h"
#include "render/cpu/render.h"
#include "render/gpu/render.h"
#include "tests/render/gpu/comparisons.h"
#include "tests/render/scenes.h"
#include "tests/support/lamps.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <optional>
#include <ostream>

namespace nearfield::render {
namespace {

using model::Sampler;
using test::camera_at;
using test::kDown;
using test::layer;
using test::pose;

constexpr double kLampHeightM = 1.0;

struct HardScene {
    const char* name;
    Scene (*make)();
    /// Compared with the CPU: not where positions in float are themselves no match, where light
    /// jumps, or where a lobe is so narrow that a few samples make all light.
    bool is_compared = true;
};

std::ostream& operator<<(std::ostream& out, const HardScene& scene) {
    return out << scene.name;
}

LightField lamp_of(const Slab& slab) {
    LightField lamp;
    lamp.slabs = {slab};
    return lamp;
}

Slab usual_slab(Weighting weighting = Weighting::Irradiance) {
    support::LampShape shape;
    shape.decades = 1;
    return support::random_lamp(model::make_profile("bspline"), weighting, 21, shape);
}

/// A lamp 1 m over a floor, which it lights straight down, and a sheet in its light.
Scene scene_with(const Slab& slab, const glm::dmat4& turned = glm::dmat4(1.0)) {
    Scene scene = test::floor_scene();
    scene.luminaires = {
        test::write_lamp(lamp_of(slab), "hard", pose({0, 0, kLampHeightM}, kDown) * turned)};
    test::add_blocker(scene, "sheet", {0.1, 0.05, 0.4}, {0.2, 0.15});
    scene.cameras = {camera_at({0.8, -1.5, 1.3}, {-0.8, 1.5, -1.2}, {0, 0, 1}, 0.6)};
    return scene;
}

Scene usual() {
    return scene_with(usual_slab());
}

/// With a sheet at a height over S (towards U), seen from behind the lamp.
Scene with_receiver_at(double height_m) {
    Scene scene = usual();
    test::add_blocker(scene, "receiver", {0.02, 0.01, kLampHeightM + height_m}, {0.2, 0.15});
    scene.cameras = {camera_at({0.4, -0.5, 2.0}, {-0.4, 0.5, -0.95}, {0, 0, 1}, 0.4)};
    return scene;
}

Scene on_s() {
    return with_receiver_at(0.0);
}
Scene between() {
    return with_receiver_at(0.11);
}
Scene at_u() {
    return with_receiver_at(0.2);
}
Scene behind_u() {
    return with_receiver_at(0.27);
}

/// A wall through the middle of U, S and the beam: its own plane cuts every window.
Scene through_u() {
    Scene scene = usual();
    scene.instances.push_back({"wall", static_cast<int>(scene.meshes.size()),
                               glm::rotate(glm::translate(glm::dmat4(1.0), {0.01, 0.0, 1.0}),
                                           1.5707963, glm::dvec3(0, 1, 0))});
    scene.meshes.push_back(test::rectangle("wall mesh", {1.2F, 0.5F}));
    scene.cameras = {camera_at({1.4, -0.6, 1.1}, {-1.4, 0.6, -0.1}, {0, 0, 1}, 0.6)};
    return scene;
}

Scene grazing() {
    Scene scene = usual();
    scene.luminaires[0].world_from_luminaire = pose({-1.2, 0, 0.02}, {1.0, 0.0, -0.001});
    return scene;
}

Scene far_away() {
    Scene scene = usual();
    scene.instances.resize(1);
    scene.instances[0].world_from_mesh = glm::translate(glm::dmat4(1.0), {0, 0, -1e6}) *
                                         glm::scale(glm::dmat4(1.0), glm::dvec3(1e6));
    scene.cameras = {camera_at({0, 0, 2}, kDown, {0, 1, 0}, 1.2)};
    return scene;
}

Scene far_from_the_origin() {
    return test::transformed(usual(), glm::translate(glm::dmat4(1.0), {1e6, -7e5, 3e5}));
}

/// Triangles without area, flat or with normals of length 0.
Scene degenerate() {
    Scene scene = usual();
    Mesh mesh = test::rectangle("needle mesh", {0.4F, 0.4F});
    mesh.triangles = {{0, 0, 0}, {0, 1, 1}, {0, 1, 2}};
    mesh.positions_m[1] = 0.5F * (mesh.positions_m[0] + mesh.positions_m[2]);
    scene.instances.push_back({"needle", static_cast<int>(scene.meshes.size()),
                               glm::translate(glm::dmat4(1.0), {0.0, 0.1, 0.3})});
    scene.meshes.push_back(mesh);
    Mesh smooth = test::rectangle("smooth mesh", {0.3F, 0.3F});
    smooth.normals.assign(4, glm::vec3(0.0F));
    smooth.normals[0] = {0.0F, 0.0F, 1.0F};
    scene.instances.push_back({"smooth", static_cast<int>(scene.meshes.size()),
                               glm::translate(glm::dmat4(1.0), {-0.2, -0.2, 0.05})});
    scene.meshes.push_back(smooth);
    return scene;
}

Scene dark_lamp() {
    Slab slab = usual_slab();
    std::fill(slab.coeffs.begin(), slab.coeffs.end(), 0.0F);
    return scene_with(slab);
}

Scene one_texel_lamp() {
    support::LampShape shape;
    shape.grid = {1, 1};
    shape.texels = {1, 1};
    shape.dark_fraction = 0.0;
    return scene_with(
        support::random_lamp(model::make_profile("box"), Weighting::Irradiance, 5, shape));
}

/// Of every image one texel, in the last column.
Scene one_texel_lit() {
    Slab slab = usual_slab();
    std::fill(slab.coeffs.begin(), slab.coeffs.end(), 0.0F);
    for (int m = 0; m < slab.image_count(); ++m)
        slab.coeffs[slab.image_offset(0, m) + static_cast<std::size_t>(slab.texels.x * 11 - 1)] =
            3.0F;
    return scene_with(slab);
}

Scene wide_range() {
    support::LampShape shape;
    shape.decades = 10;
    return scene_with(
        support::random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 9, shape));
}

/// Windows of 1e-11 of their image's light: one texel outshines all others.
Scene dark_windows() {
    Slab slab = usual_slab();
    for (int m = 0; m < slab.image_count(); ++m)
        slab.coeffs[slab.image_offset(0, m)] = 1e11F;
    return scene_with(slab);
}

Scene radiance_weighting() {
    return scene_with(usual_slab(Weighting::Radiance));
}

Scene odd_width() {
    support::LampShape shape;
    shape.grid = {2, 3};
    shape.texels = {300, 7};
    shape.decades = 1;
    return scene_with(
        support::random_lamp(model::make_profile("quadratic"), Weighting::Irradiance, 6, shape));
}

Scene mirrored() {
    return scene_with(usual_slab(), glm::scale(glm::dmat4(1.0), {-1.0, 1.0, 1.0}));
}
Scene tiny() {
    return scene_with(usual_slab(), glm::scale(glm::dmat4(1.0), glm::dvec3(1e-3)));
}
Scene huge() {
    return test::transformed(usual(), glm::scale(glm::dmat4(1.0), glm::dvec3(1e3)));
}

/// A mirror but for rounding, which sees the lamp's own image.
Scene mirror() {
    Scene scene = usual();
    scene.materials[0] = {"mirror", glm::vec3(0.9F), 1.0F, 0.01F};
    return scene;
}

const HardScene kScenes[] = {
    {"usual", usual},
    {"on_s", on_s},
    {"between", between},
    {"at_u", at_u, false},
    {"behind_u", behind_u},
    {"through_u", through_u},
    {"grazing", grazing},
    {"far_away", far_away},
    {"far_from_the_origin", far_from_the_origin, false},
    {"degenerate", degenerate},
    {"dark_lamp", dark_lamp},
    {"one_texel_lamp", one_texel_lamp},
    {"one_texel_lit", one_texel_lit},
    {"wide_range", wide_range},
    {"dark_windows", dark_windows},
    {"radiance_weighting", radiance_weighting},
    {"odd_width", odd_width},
    {"mirrored", mirrored},
    {"tiny", tiny},
    {"huge", huge},
    {"mirror", mirror, false},
};

constexpr std::optional<Sampler> kWays[] = {std::nullopt,         Sampler::Uniform,
                                            Sampler::Precomputed, Sampler::Pdis,
                                            Sampler::Systematic,  Sampler::Cells};

class GlHardScenes : public testing::TestWithParam<HardScene> {};

TEST_P(GlHardScenes, GiveLightAndNothingElse) {
    const Scene scene = GetParam().make();
    for (const std::optional<Sampler> sampler : kWays) {
        SCOPED_TRACE(sampler ? model::name_of(*sampler) : "sum");
        RenderOptions options;
        options.size_px = {32, 24};
        options.sampler = sampler;
        options.samples = 16;
        options.effects.shadows = Switch::Off;
        const Rendered lit = render_gl(scene, options);
        test::expect_light(lit.picture);
        if (GetParam().is_compared) {
            const Rendered cpu = render_cpu(scene, options);
            for (const char* name : {"", "irradiance"})
                EXPECT_GE(
                    test::share_within(layer(lit.picture, name), layer(cpu.picture, name), 1e-3, 0),
                    0.995)
                    << "layer '" << name << "'";
        }
        options.effects.shadows = Switch::On;
        const Rendered shadowed = render_gl(scene, options);
        test::expect_light(shadowed.picture);
        // Visibility is at most 1. Two sums in float, each of them within 1.4e-5.
        const std::vector<float>&after = layer(shadowed.picture, "irradiance").values,
              &before = layer(lit.picture, "irradiance").values;
        for (std::size_t k = 0; k < after.size(); ++k)
            ASSERT_LE(after[k], before[k] * (1.0F + 3e-5F)) << k;
    }
}

INSTANTIATE_TEST_SUITE_P(All, GlHardScenes, testing::ValuesIn(kScenes), [](const auto& one) {
    return std::string(one.param.name);
});

}  // namespace
}  // namespace nearfield::render
