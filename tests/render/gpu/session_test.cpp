// SPDX-License-Identifier: Apache-2.0
// A session's pictures are those of renderers that know nothing of each other.
#include "render/gpu/session.h"

#include "render/gpu/render.h"
#include "tests/render/gpu/comparisons.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace nearfield::render {
namespace {

using test::layer;
using test::with_second_lamp;

RenderOptions small_options(int q = 0) {
    RenderOptions options;
    options.size_px = {96, 72};
    options.q = q;
    options.samples = 16;
    return options;
}

Rendered render_by(gpu::Session& session,
                   const Scene& scene,
                   const RenderOptions& options,
                   std::optional<std::size_t> only = std::nullopt) {
    return session.render(scene, options, begin_call(options, {}), only);
}

void expect_equal(const Picture& a, const Picture& b, const std::string& what) {
    ASSERT_EQ(a.layers.size(), b.layers.size()) << what;
    for (std::size_t k = 0; k < a.layers.size(); ++k)
        EXPECT_EQ(a.layers[k].values, b.layers[k].values) << what << ": " << a.layers[k].name;
}

/// A picture, and how it is when it is the first. Made before there is a session, since a thread
/// has one context that is current.
struct Case {
    std::string what;
    Scene scene;
    RenderOptions options;
    Picture alone = render_gl(scene, options).picture;
};

std::vector<Case> changes_of(Scene scene) {
    std::vector<Case> cases;
    const auto add = [&](const std::string& what, const RenderOptions& options) {
        cases.push_back({what, scene, options});
    };
    add("the first", small_options());
    scene.luminaires[1].world_from_luminaire[3] += glm::dvec4(0.1, 0.05, 0.0, 0.0);
    add("a lamp moved", small_options());
    add("a draft", small_options(8));
    add("after a draft", small_options());
    RenderOptions coarse = small_options(8);
    coarse.shadow_maps = {ShadowEye::Cell, 4, 64, 4};
    coarse.size_px = {40, 30};
    add("few maps, another size", coarse);
    scene.instances.back().world_from_mesh[3].x += 0.1;
    add("geometry moved", small_options());
    scene.luminaires[0].on = false;
    add("a lamp off", small_options());
    scene.luminaires[0].on = true;
    scene.materials[0].base_color = {0.9F, 0.1F, 0.2F};
    add("a lamp on again, another color", small_options());
    RenderOptions sampled = small_options();
    sampled.sampler = model::Sampler::Systematic;
    add("samples", sampled);
    sampled.sampler = model::Sampler::Pdis;
    add("samples that read more tables", sampled);
    add("sums again", small_options());
    return cases;
}

TEST(GlSession, PicturesAreThoseOfRenderersOfTheirOwn) {
    const std::vector<Case> cases = changes_of(with_second_lamp(test::uneven_scene()));
    gpu::Session session;
    for (const Case& one : cases)
        expect_equal(render_by(session, one.scene, one.options).picture, one.alone, one.what);
}

TEST(GlSession, OneLampIsItsPartBitByBit) {
    Scene scene = with_second_lamp(test::uneven_scene());
    LuminaireInstance off = scene.luminaires[0];
    off.name = "off";
    off.on = false;
    scene.luminaires.insert(scene.luminaires.begin() + 1, off);
    const Rendered all = render_gl(scene, small_options());
    gpu::Session session;
    const Rendered first = render_by(session, scene, small_options(), 0),
                   third = render_by(session, scene, small_options(), 2);
    EXPECT_EQ(layer(first.picture, "").values, layer(all.picture, "lamp.uneven").values);
    EXPECT_EQ(layer(third.picture, "").values, layer(all.picture, "lamp.second").values);
    const std::vector<float>&a = layer(first.picture, "irradiance").values,
          &b = layer(third.picture, "irradiance").values,
          &both = layer(all.picture, "irradiance").values;
    for (std::size_t k = 0; k < both.size(); ++k)
        ASSERT_EQ(both[k], a[k] + b[k]);
}

TEST(GlSession, APictureThatIsGivenUpLeavesNothingBehind) {
    const Case whole{"after all", with_second_lamp(test::uneven_scene()), small_options(8)};
    const Scene& scene = whole.scene;
    gpu::Session session;
    int asked = 0, stops = 0;
    // Stopped later and later, until it is not.
    for (int most = 0; most < 1000; most += 3) {
        asked = 0;
        RenderHooks hooks;
        hooks.is_stopped = [&] { return ++asked > most; };
        try {
            session.render(scene, small_options(8), begin_call(small_options(8), hooks));
            break;
        } catch (const Stopped&) {
            ++stops;
        }
    }
    EXPECT_GE(stops, 5);
    expect_equal(render_by(session, scene, small_options(8)).picture, whole.alone, whole.what);
}

// Rows that are drawn apart, since the call may be stopped, are as those drawn at once.
TEST(GlSession, WhatMayBeGivenUpIsTheSameLight) {
    const Scene scene = test::uneven_scene();
    RenderOptions options = small_options();
    options.size_px = {256, 192};  // bands on a rasterizer
    const Picture at_once = render_gl(scene, options).picture;
    RenderHooks hooks;
    hooks.is_stopped = [] { return false; };
    gpu::Session session;
    expect_equal(session.render(scene, options, begin_call(options, hooks)).picture, at_once,
                 "in bands");
}

// What a draft leaves out changes nothing else.
TEST(GlSession, WithoutTheBiasBoundLightIsTheSame) {
    const Scene scene = with_second_lamp(test::uneven_scene());
    gpu::Session session;
    RenderOptions options = small_options(8);
    const Picture with = render_by(session, scene, options).picture;
    options.has_bias_bound = false;
    const Rendered without = render_by(session, scene, options);
    EXPECT_EQ(with.layers.size(), without.picture.layers.size() + 1);
    for (std::size_t k = 0; k < without.picture.layers.size(); ++k)
        EXPECT_EQ(without.picture.layers[k].values, with.layers[k].values) << with.layers[k].name;
    EXPECT_EQ(without.report.sampling.bias_mean_rel, 0.0);
}

// Of several in one process, which share their display, each ends alone.
TEST(GlSession, OutlivesOthers) {
    const Scene scene = test::plain_scene();
    auto first = std::make_unique<gpu::Session>();
    Picture in_thread;
    std::thread([&] {
        gpu::Session second;
        std::thread([&] { gpu::Session third; }).join();
        in_thread = render_by(second, scene, small_options()).picture;
    }).join();
    expect_equal(render_by(*first, scene, small_options()).picture, in_thread, "after others");
}

TEST(GlSession, MemoryStaysAsItIs) {
    gpu::Session session;
    Scene scene = test::uneven_scene();
    const auto round = [&] {
        for (const int width : {96, 64, 48}) {
            RenderOptions options = small_options(width == 96 ? 0 : 8);
            options.size_px = {width, 48};
            render_by(session, scene, options);
        }
        return session.allocated_bytes();
    };
    round();
    const std::uint64_t before = round();
    const std::uint64_t of_round = round() - before;
    // Materials are uploaded anew, and little else.
    EXPECT_LT(of_round, 100'000U);
}

// Powers of two, which round nothing. Without shadows: a map is seen from the middle of its cell's
// light, which a tint moves.
TEST(GlSession, TintIsAFactorOfEachChannel) {
    Scene scene = test::uneven_scene();
    RenderOptions options = small_options();
    options.effects.shadows = Switch::Off;
    const Rendered white = render_gl(scene, options);
    const glm::vec3 tint(1.0F, 0.5F, 0.125F);
    scene.luminaires[0].tint = tint;
    const Rendered tinted = render_gl(scene, options);
    const std::vector<float>&a = layer(white.picture, "irradiance").values,
          &b = layer(tinted.picture, "irradiance").values;
    for (std::size_t k = 0; k < a.size(); ++k)
        ASSERT_EQ(b[k], tint[static_cast<int>(k % 3)] * a[k]);
}

}  // namespace
}  // namespace nearfield::render
