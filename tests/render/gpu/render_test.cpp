// SPDX-License-Identifier: Apache-2.0
// Whole pictures by OpenGL against the CPU's.
#include "render/gpu/render.h"

#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "render/metrics.h"
#include "tests/render/gpu/comparisons.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

using test::expect_light;
using test::layer;
using test::share_within;
using test::with_second_lamp;

RenderOptions small_options(Switch shadows) {
    RenderOptions options;
    options.size_px = {96, 72};
    options.effects.shadows = shadows;
    return options;
}

TEST(GlRender, UnshadowedSumIsTheCpus) {
    const Scene scene = test::uneven_scene();
    const RenderOptions options = small_options(Switch::Off);
    const Rendered cpu = render_cpu(scene, options), gl = render_gl(scene, options);
    expect_light(gl.picture);
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
        expect_light(gl.picture);
        EXPECT_GE(share_within(layer(gl.picture, ""), layer(cpu.picture, ""), 1e-3), 0.995)
            << model::name_of(sampler);
        EXPECT_NEAR(gl.report.sampling.mean_rel / cpu.report.sampling.mean_rel, 1.0, 0.02)
            << model::name_of(sampler);
    }
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

// Passes of 16, 48 and 36 samples, weighted by them, are the CPU's: light and sigma.
TEST(GlRender, UnequalPassesAreTheCpus) {
    const Scene scene = with_second_lamp(test::uneven_scene());
    RenderOptions options = small_options(Switch::Off);
    options.sampler = model::Sampler::Systematic;
    options.error_rel = 1e-5;
    options.samples = 100;
    const Rendered cpu = render_cpu(scene, options), gl = render_gl(scene, options);
    EXPECT_EQ(gl.report.passes, 3);
    EXPECT_EQ(gl.report.samples, 100.0);
    EXPECT_FALSE(gl.report.is_error_reached);
    EXPECT_GE(share_within(layer(gl.picture, ""), layer(cpu.picture, ""), 1e-3), 0.995);
    EXPECT_NEAR(gl.report.sampling.mean_rel / cpu.report.sampling.mean_rel, 1.0, 0.02);
}

/// A clock that stands still but for what it is told: each reading is a step.
struct FakeClock {
    double step_s = 0.0;
    int readings = 0;

    RenderHooks hooks() {
        RenderHooks result;
        result.clock_s = [this] { return step_s * ++readings; };
        return result;
    }
};

// By a clock of its own: a picture within a time goes on until its limit of samples, ends with the
// time, and always has its first pass, which a report of too little time owns up to.
TEST(GlRender, PassesEndWithTheTime) {
    const Scene scene = test::uneven_scene();
    RenderOptions options = small_options(Switch::Off);
    options.size_px = {24, 18};
    options.sampler = model::Sampler::Uniform;
    options.samples = 512;
    options.time_s = 1.0;
    double samples = 0.0;
    for (const double step_s : {3.0, 0.15, 0.06, 1e-6}) {
        FakeClock clock{step_s};
        const RenderReport report = render_gl(scene, options, clock.hooks()).report;
        EXPECT_GE(report.samples, samples) << step_s;
        samples = report.samples;
        if (step_s > 1.0) {
            EXPECT_EQ(report.passes, 1);
            EXPECT_GT(report.time_s, options.time_s);
            EXPECT_THAT(summary(report, options, options.size_px),
                        testing::HasSubstr(" of 1000 ms bought an error of "));
        } else {
            // Beyond the time only the readings at the end.
            EXPECT_LE(report.time_s, options.time_s + 2.0 * step_s) << step_s;
            EXPECT_GT(report.passes, 1) << step_s;
        }
    }
    EXPECT_EQ(samples, 512.0);
}

/// Luminance, pixel by pixel.
std::vector<double> luminances(const Picture& picture) {
    std::vector<double> y;
    const std::vector<float>& rgb = layer(picture, "").values;
    for (std::size_t k = 0; k < rgb.size(); k += 3)
        y.push_back(0.2126 * static_cast<double>(rgb[k]) +
                    0.7152 * static_cast<double>(rgb[k + 1]) +
                    0.0722 * static_cast<double>(rgb[k + 2]));
    return y;
}

/// The uneven lamp with images so fine that windows span up to 6 texels, two materials glossy.
Scene fine_scene(bool is_glossy) {
    Scene scene = test::uneven_scene();
    LightField lamp = read_lightfield(scene.luminaires[0].path);
    Slab& slab = lamp.slabs[0];
    slab.texels = {64, 48};
    slab.coeffs.resize(std::size_t{3} * 6 * 64 * 48);
    for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
        slab.coeffs[i] = static_cast<float>((i / 16 * 7919) % 101);
    const glm::dmat4 pose = scene.luminaires[0].world_from_luminaire;
    scene.luminaires = {test::write_lamp(lamp, "fine", pose)};
    if (is_glossy)
        scene.materials[0] = {"varnish", {0.6F, 0.5F, 0.4F}, 0.0F, 0.4F};
    return scene;
}

// bias_bound is 1.5 |E_q - E_2q|, as pictures at q and at 2q show it, shadows included and gloss
// left out; it counts as error.
TEST(GlRender, CoarseSumsBoundTheirBias) {
    for (const bool is_glossy : {false, true}) {
        const Scene scene = fine_scene(is_glossy);
        RenderOptions options = small_options(Switch::Auto);
        options.size_px = {32, 24};
        options.samples = 4;
        const auto at_q = [&](int q) {
            options.q = q;
            return render_gl(scene, options);
        };
        const Rendered exact = at_q(0), coarse = at_q(2), finer = at_q(4);
        EXPECT_EQ(exact.picture.layers.back().name, "lamp.fine");
        const std::vector<double> y = luminances(coarse.picture), y_2q = luminances(finer.picture),
                                  y_exact = luminances(exact.picture);
        const std::vector<float>& bound = layer(coarse.picture, "bias_bound").values;
        double largest = 0.0, error = 0.0, bounds = 0.0;
        for (std::size_t k = 0; k < y.size(); ++k)
            largest = std::max(largest, y[k]);
        for (std::size_t k = 0; k < y.size(); ++k) {
            EXPECT_NEAR(static_cast<double>(bound[k]), 1.5 * std::abs(y[k] - y_2q[k]),
                        2e-6 * largest);
            error += std::abs(y[k] - y_exact[k]);
            bounds += static_cast<double>(bound[k]);
        }
        EXPECT_GT(bounds, 0.0);
        EXPECT_LE(error, bounds);
        EXPECT_GT(coarse.report.sampling.bias_mean_rel, 0.0);
        EXPECT_THAT(summary(coarse.report, options, options.size_px), testing::HasSubstr("bias "));
    }
}

// Where the bias alone is more than the error that is asked for, more samples do not help.
TEST(GlRender, NoPassIsAddedWhereTheBiasIsTheError) {
    RenderOptions options = small_options(Switch::Off);
    options.size_px = {24, 18};
    options.q = 2;
    options.error_rel = 1e-4;
    const RenderReport report = render_gl(fine_scene(true), options).report;
    EXPECT_EQ(report.passes, 1);
    EXPECT_FALSE(report.is_error_reached);
    EXPECT_GT(report.sampling.bias_mean_rel, 1e-4);
}

}  // namespace
}  // namespace nearfield::render
