// SPDX-License-Identifier: Apache-2.0
// The environment's light by OpenGL against the CPU's.
#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "render/gpu/render.h"
#include "render/gpu/session.h"
#include "render/metrics.h"
#include "tests/render/gpu/comparisons.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <iostream>
#include <string>

namespace nearfield::render {
namespace {

using test::expect_light, test::layer, test::metal, test::share_within, test::sunny_sky,
    test::under;

constexpr int kWidth = 64;
// Of values; the rest: at borders the devices may see different triangles, or different pixels of
// the sky.
constexpr double kAlike = 0.999;

RenderOptions small_options() {
    RenderOptions options;
    options.size_px = {kWidth, 48};
    return options;
}

shared::Brdf varnish(shared::uint kind) {
    shared::Brdf brdf = metal(kind, 30.0F, {0.3F, 0.1F});
    brdf.specular = {0.4F, 0.5F, 0.6F};
    brdf.diffuse = {0.5F, 0.3F, 0.2F};
    return brdf;
}

Scene turned(Scene scene) {
    scene.environment->world_from_environment =
        glm::dmat3(test::pose({}, glm::normalize(glm::dvec3(0.4, 0.5, -0.6))));
    scene.environment->intensity = 3.0;
    return scene;
}

Scene with_roof(Scene scene) {
    test::add_blocker(scene, "roof", {0.3, 0.2, 0.8}, {1.2F, 0.8F});
    return scene;
}

/// Share of values that agree within 1e-3, of radiance, irradiance and the environment's layer: the
/// least. At triangles' borders and where directions fall between two pixels devices may differ.
double share_alike(const Scene& scene, const RenderOptions& options) {
    const Picture cpu = render_cpu(scene, options).picture;
    const Picture gl = render_gl(scene, options).picture;
    expect_light(gl);
    double least = 1.0;
    for (const std::string name : {"", "environment"})
        least = std::min(least, share_within(layer(gl, name), layer(cpu, name), 1e-3));
    return least;
}

// Proves that every lobe, turned and dimmed environments and what is seen past everything are the
// CPU's.
TEST(GlSky, IsTheCpusLight) {
    for (const shared::uint kind : {shared::kBrdfPhong, shared::kBrdfGgx, shared::kBrdfWard,
                                    shared::kBrdfLafortune, shared::kBrdfHalfwayDisk})
        EXPECT_GE(share_alike(turned(under(sunny_sky(), varnish(kind))), small_options()), kAlike)
            << kind;
    const Scene diffuse = turned(under(sunny_sky()));
    EXPECT_GE(share_alike(diffuse, small_options()), kAlike);
}

// Proves the same of each way to filter, of shifted samples and of far lamps.
TEST(GlSky, EveryOptionIsTheCpus) {
    const Scene scene = turned(under(sunny_sky(), varnish(shared::kBrdfGgx)));
    const auto share = [&](const EnvironmentOptions& environment) {
        RenderOptions options = small_options();
        options.environment = environment;
        return share_alike(scene, options);
    };
    EXPECT_GE(share({.level = FilterLevel::Gems}), kAlike);
    EXPECT_GE(share({.level = FilterLevel::None}), kAlike);
    EXPECT_GE(share({.level = FilterLevel::Mfis}), kAlike);
    EXPECT_GE(share({.suns = 0}), kAlike);
    EXPECT_GE(share({.is_anisotropic = true}), kAlike);
    EXPECT_GE(share({.is_shifted = true}), kAlike);
    EXPECT_GE(share({.method = EnvironmentMethod::Lights, .directions = 32}), kAlike);
}

// Proves that pixels draw as many samples as the CPU's, by what light varies over their lobes.
// (With several camera samples, which the devices place differently, surface_test.cpp proves the
// turns.)
TEST(GlSky, DrawsAsManySamplesAsTheCpu) {
    const Scene scene = turned(test::with_ball(under(test::soft_sky(), varnish(shared::kBrdfGgx))));
    RenderOptions options = small_options();
    options.effects.shadows = Switch::Off;
    options.environment.error_rel = 0.02;
    options.environment.samples = 256;
    EXPECT_GE(share_alike(scene, options), kAlike);
    const Picture counted = render_gl(scene, options).picture;
    options.environment.error_rel = 0.0;
    EXPECT_LT(share_within(layer(render_gl(scene, options).picture, ""), layer(counted, ""), 1e-3),
              0.9);
    // Programs for turns compile, and make no difference of more than samples do.
    options.environment.error_rel = 0.02;
    options.samples_per_pixel = 4;
    const Picture several = render_gl(scene, options).picture;
    expect_light(several);
    EXPECT_LT(lab_difference(layer(several, "").values,
                             layer(render_cpu(scene, options).picture, "").values),
              1.0);
}

// Proves that camera samples and lamps beside the environment are added up as on the CPU.
TEST(GlSky, AddsToLampsAndCameraSamples) {
    Scene scene = test::uneven_scene();
    scene.environment = sunny_sky();
    scene.environment->intensity = 0.01;
    RenderOptions options = small_options();
    options.effects.shadows = Switch::Off;
    const Picture cpu = render_cpu(scene, options).picture;
    const Picture gl = render_gl(scene, options).picture;
    for (const std::string name : {"", "irradiance", "lamp.uneven", "environment"})
        EXPECT_GE(share_within(layer(gl, name), layer(cpu, name), 1e-3), kAlike) << name;
}

// Proves that maps find what rays find: Lab difference of pictures with their shadows, against that
// of a picture without.
TEST(GlSky, MapsThrowTheShadowsOfRays) {
    for (const EnvironmentMethod method :
         {EnvironmentMethod::Filtered, EnvironmentMethod::Lights}) {
        const Scene scene = turned(with_roof(under(test::soft_sky(), varnish(shared::kBrdfPhong))));
        RenderOptions options = small_options();
        options.environment.method = method;
        const Rendered cpu = render_cpu(scene, options);
        EXPECT_GT(cpu.report.shadow_rays, 0U);
        const Rendered gl = render_gl(scene, options);
        expect_light(gl.picture);
        options.effects.shadows = Switch::Off;
        const Rendered without = render_gl(scene, options);
        const auto lab = [&](const Rendered& one) {
            return lab_difference(layer(one.picture, "environment").values,
                                  layer(cpu.picture, "environment").values);
        };
        std::cout << name_of(method) << ": maps " << lab(gl) << ", none " << lab(without)
                  << " Lab\n";
        EXPECT_LT(lab(gl), 0.1 * lab(without));
        EXPECT_GT(lab(without), 1.0);
    }
}

// Proves that means over neighbors keep the light and soften its steps, the more the wider.
TEST(GlSky, NeighborsShareWhatTheyFindHidden) {
    const Scene scene = turned(with_roof(under(test::soft_sky())));
    RenderOptions options = small_options();
    const auto picture = [&](int filter_px) {
        options.environment.filter_px = filter_px;
        return render_gl(scene, options).picture;
    };
    const auto sum = [](const Picture& one) {
        double all = 0.0;
        for (const float value : layer(one, "irradiance").values)
            all += static_cast<double>(value);
        return all;
    };
    const auto steps = [](const Picture& one) {
        double all = 0.0;
        const std::vector<float>& values = layer(one, "irradiance").values;
        for (std::size_t k = 3; k < values.size(); k += 3)
            all += std::pow(static_cast<double>(values[k] - values[k - 3]), 2);
        return all;
    };
    const Picture sharp = picture(0), soft = picture(1), softer = picture(3);
    EXPECT_NEAR(sum(soft) / sum(sharp), 1.0, 0.01);
    EXPECT_NEAR(sum(softer) / sum(sharp), 1.0, 0.02);
    EXPECT_LT(steps(soft), steps(sharp));
    EXPECT_LT(steps(softer), steps(soft));
}

std::string passes_in(const Rendered& rendered) {
    std::string text;
    for (const PlannedPass& pass : rendered.report.plan.passes)
        text += pass.is_in ? std::string(pass.name) + ";" : "";
    return text;
}

// Proves that nothing runs that is not called for, and that what is in the plan has its cost.
TEST(GlSky, OnlyWhereCalledFor) {
    const Scene diffuse = under(sunny_sky());
    Scene none = diffuse;
    none.environment.reset();
    EXPECT_EQ(passes_in(render_gl(none, small_options())), "g-buffer;");
    const Rendered plain = render_gl(diffuse, small_options());
    EXPECT_EQ(passes_in(plain), "g-buffer;environment;sky irradiance;accumulate;");
    for (const PassReport& cost : plain.report.costs)
        EXPECT_GT(cost.time_s, 0.0);
    EXPECT_EQ(passes_in(render_gl(with_roof(diffuse), small_options())),
              "g-buffer;environment;sky maps;sky irradiance;accumulate;");
    const Scene glossy = under(sunny_sky(), metal(shared::kBrdfPhong, 10.0F, {}));
    EXPECT_THAT(passes_in(render_gl(glossy, small_options())),
                testing::HasSubstr("environment;sky samples;"));
    RenderOptions off = small_options();
    off.effects.environment = Switch::Off;
    EXPECT_EQ(layer(render_gl(diffuse, off).picture, "").values,
              layer(render_gl(none, small_options()).picture, "").values);
    RenderOptions forced = small_options();
    forced.effects.shadows = Switch::On;
    EXPECT_EQ(layer(render_gl(diffuse, forced).picture, "").values,
              layer(plain.picture, "").values);
}

// Proves that the CPU's methods are refused by name.
TEST(GlSky, RefusesWhatTracesRays) {
    RenderOptions options = small_options();
    options.environment.method = EnvironmentMethod::Reference;
    try {
        render_gl(under(sunny_sky()), options);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.got, "reference");
    }
}

// Proves that a session's pictures are those of renderers that know nothing of each other, while
// the environment turns, brightens, changes its file, and what stands before it moves; and that
// turning and brightening upload nothing.
TEST(GlSky, FollowsChangesFromFrameToFrame) {
    std::vector<Scene> scenes = {with_roof(under(sunny_sky(), varnish(shared::kBrdfGgx)))};
    scenes.push_back(turned(scenes[0]));
    scenes.push_back(scenes[1]);
    scenes.back().instances.back().world_from_mesh[3].x += 0.4;
    scenes.push_back(scenes[2]);
    scenes.back().environment->path = test::soft_sky().path;
    scenes.push_back(scenes[0]);
    scenes.back().environment.reset();
    std::vector<Picture> alone;
    for (const Scene& scene : scenes)
        alone.push_back(render_gl(scene, small_options()).picture);
    gpu::Session session;
    std::vector<std::uint64_t> bytes;
    for (std::size_t k = 0; k < scenes.size(); ++k) {
        const Picture picture =
            session.render(scenes[k], small_options(), begin_call(small_options(), {})).picture;
        EXPECT_EQ(layer(picture, "").values, layer(alone[k], "").values) << k;
        bytes.push_back(session.allocated_bytes());
    }
    EXPECT_LT(bytes[1] - bytes[0], 10000U);  // views and materials
}

}  // namespace
}  // namespace nearfield::render
