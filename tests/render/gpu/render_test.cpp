// SPDX-License-Identifier: Apache-2.0
// Whole pictures by OpenGL against the CPU's.
#include "render/gpu/render.h"

#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "render/metrics.h"
#include "sample_data/reference_lamp.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

using test::layer;

RenderOptions small_options(Switch shadows) {
    RenderOptions options;
    options.size_px = {96, 72};
    options.effects.shadows = shadows;
    return options;
}

/// Share of values above 1e-3 of the largest that agree within a relative error.
double share_within(const Layer& a, const Layer& reference, double relative) {
    const float largest = *std::max_element(reference.values.begin(), reference.values.end());
    std::size_t lit = 0, within = 0;
    for (std::size_t k = 0; k < reference.values.size(); ++k) {
        if (!(reference.values[k] > 1e-3F * largest))
            continue;
        ++lit;
        const double error = std::abs(
            static_cast<double>(a.values[k]) / static_cast<double>(reference.values[k]) - 1.0);
        within += error <= relative ? 1U : 0U;
    }
    EXPECT_GT(lit, 1000U);
    return static_cast<double>(within) / static_cast<double>(std::max<std::size_t>(lit, 1));
}

void expect_finite(const Picture& picture) {
    for (const Layer& each : picture.layers)
        EXPECT_TRUE(std::all_of(each.values.begin(), each.values.end(), [](float value) {
            return std::isfinite(value);
        })) << each.name;
}

const PassReport* cost_of(const RenderReport& report, PassId id) {
    const auto found = std::find_if(report.costs.begin(), report.costs.end(),
                                    [&](const PassReport& cost) { return cost.id == id; });
    return found == report.costs.end() ? nullptr : &*found;
}

/// The first lamp's file once more, elsewhere and dimmed.
Scene with_second_lamp(Scene scene) {
    LuminaireInstance second = scene.luminaires.front();
    second.name = "second";
    second.world_from_luminaire[3] += glm::dvec4(0.4, -0.3, 0.2, 0.0);
    second.dim = 0.5;
    scene.luminaires.push_back(second);
    return scene;
}

TEST(GlRender, UnshadowedSumIsTheCpus) {
    const Scene scene = test::uneven_scene();
    const RenderOptions options = small_options(Switch::Off);
    const Rendered cpu = render_cpu(scene, options), gl = render_gl(scene, options);
    expect_finite(gl.picture);
    EXPECT_GE(share_within(layer(gl.picture, ""), layer(cpu.picture, ""), 1e-3), 0.995);
    EXPECT_GE(share_within(layer(gl.picture, "irradiance"), layer(cpu.picture, "irradiance"), 1e-3),
              0.995);
    EXPECT_GE(share_within(layer(gl.picture, "depth"), layer(cpu.picture, "depth"), 1e-5), 0.995);
    EXPECT_GE(share_within(layer(gl.picture, "albedo"), layer(cpu.picture, "albedo"), 1e-6), 0.995);
    EXPECT_EQ(gl.report.sampling.mean_rel, 0.0);
}

// Two lamps, whose samples are independent of each other.
TEST(GlRender, SamplersDrawTheCpusSamples) {
    const Scene scene = with_second_lamp(test::uneven_scene());
    RenderOptions options = small_options(Switch::Off);
    options.samples = 16;
    for (const model::Sampler sampler : {model::Sampler::Systematic, model::Sampler::Cells,
                                         model::Sampler::Uniform, model::Sampler::Pdis}) {
        options.sampler = sampler;
        const Rendered cpu = render_cpu(scene, options), gl = render_gl(scene, options);
        expect_finite(gl.picture);
        EXPECT_GE(share_within(layer(gl.picture, ""), layer(cpu.picture, ""), 1e-3), 0.995)
            << model::name_of(sampler);
        EXPECT_NEAR(gl.report.sampling.mean_rel / cpu.report.sampling.mean_rel, 1.0, 0.02)
            << model::name_of(sampler);
    }
}

/// The reference lamp over a floor, with sheets at two heights in its light: 13 x 11 cells.
Scene sheets_under_lamp() {
    Scene scene = test::floor_scene();
    scene.luminaires = {test::write_lamp(sample_data::make_reference_lamp(), "reference",
                                         test::pose({0.0, 0.0, 1.5}, test::kDown))};
    test::add_blocker(scene, "high", {0.2, 0.1, 0.5}, {0.3F, 0.3F});
    test::add_blocker(scene, "low", {-0.25, -0.1, 0.1}, {0.25F, 0.4F});
    return scene;
}

// A pixel's camera samples share its samples, as on the CPU: sigma is no smaller for them.
TEST(GlRender, CameraSamplesShareAPixelsSamples) {
    const Scene scene = test::uneven_scene();
    RenderOptions options = small_options(Switch::Off);
    options.sampler = model::Sampler::Uniform;
    options.samples_per_pixel = 4;
    const Rendered cpu = render_cpu(scene, options), gl = render_gl(scene, options);
    EXPECT_NEAR(gl.report.sampling.mean_rel / cpu.report.sampling.mean_rel, 1.0, 0.1);
}

TEST(GlRender, ShadowMapsAreNearTracedShadows) {
    const Scene scene = sheets_under_lamp();
    RenderOptions options = small_options(Switch::Auto);
    options.samples = 256;
    const Rendered cpu = render_cpu(scene, options), gl = render_gl(scene, options);
    const Rendered unshadowed = render_gl(scene, small_options(Switch::Off));
    expect_finite(gl.picture);
    const Layer& reference = layer(cpu.picture, "");
    const double error = lab_difference(layer(gl.picture, "").values, reference.values);
    const double without = lab_difference(layer(unshadowed.picture, "").values, reference.values);
    EXPECT_LE(error, 1.2);  // the papers' figure for their own scene
    EXPECT_GT(without, 4.0 * error) << "shadows that hardly matter prove little";
    RecordProperty("lab_error", std::to_string(error));
}

TEST(GlRender, WhatTheSceneDoesNotCallForHasNoPassAndNoBuffer) {
    Scene scene = test::uneven_scene();
    const Rendered off = render_gl(scene, small_options(Switch::Off));
    EXPECT_EQ(cost_of(off.report, PassId::ShadowMaps), nullptr);
    EXPECT_EQ(cost_of(off.report, PassId::Samples), nullptr);
    EXPECT_EQ(cost_of(off.report, PassId::BoxEnergies), nullptr);
    const Rendered on = render_gl(scene, small_options(Switch::On));
    ASSERT_NE(cost_of(on.report, PassId::ShadowMaps), nullptr);
    EXPECT_GT(cost_of(on.report, PassId::ShadowMaps)->bytes, 0.0);
    EXPECT_GT(cost_of(on.report, PassId::ShadowMaps)->time_s, 0.0);
}

// Nothing stands between: forced shadows change nothing.
TEST(GlRender, ForcedShadowsOfABareFloorChangeNothing) {
    Scene scene = test::floor_scene();
    scene.luminaires = test::uneven_scene().luminaires;
    const Rendered automatic = render_gl(scene, small_options(Switch::Auto));
    EXPECT_FALSE(automatic.report.plan.has_shadows);
    const Rendered forced = render_gl(scene, small_options(Switch::On));
    EXPECT_TRUE(forced.report.plan.has_shadows);
    EXPECT_LE(test::difference(layer(automatic.picture, ""), layer(forced.picture, "")), 1e-6);
}

TEST(GlRender, LampsOfOneFileShareItsTextures) {
    Scene scene = test::uneven_scene();
    const Rendered one = render_gl(scene, small_options(Switch::Off));
    scene = with_second_lamp(scene);
    const Rendered two = render_gl(scene, small_options(Switch::Off));
    EXPECT_EQ(two.report.lamp_bytes, one.report.lamp_bytes);
    EXPECT_GT(one.report.lamp_bytes, 0.0);
    const Rendered cpu = render_cpu(scene, small_options(Switch::Off));
    for (const std::string name : {"lamp.uneven", "lamp.second"})
        EXPECT_GE(share_within(layer(two.picture, name), layer(cpu.picture, name), 1e-3), 0.995)
            << name;
}

TEST(GlRender, PassesAreAddedUntilTheErrorIsReached) {
    const Scene scene = test::uneven_scene();
    RenderOptions options = small_options(Switch::Off);
    options.sampler = model::Sampler::Systematic;
    options.error_rel = 0.02;
    const Rendered rendered = render_gl(scene, options);
    EXPECT_TRUE(rendered.report.is_error_reached);
    EXPECT_LE(rendered.report.sampling.error_rel(), 0.02);
    EXPECT_GT(rendered.report.passes, 1);
}

}  // namespace
}  // namespace nearfield::render
