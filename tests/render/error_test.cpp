// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <string>
#include <vector>

namespace nearfield::render {
namespace {

using test::floor_scene;
using test::half_covered;
using test::kDown;
using test::layer;
using test::one_window_lamp;
using test::pose;
using test::small;
using test::transformed;
using test::write_lamp;

/// Penumbrae over the whole picture: an uneven lamp whose lower half a sheet hides here and there.
Scene penumbra_scene() {
    Scene scene = half_covered();
    LightField lamp = one_window_lamp(0.2, 1.0F);
    Slab& slab = lamp.slabs[0];
    slab.texels = {9, 7};
    slab.coeffs.resize(63);
    for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
        slab.coeffs[i] = static_cast<float>((i * 37) % 11);
    scene.luminaires = {write_lamp(lamp, "structured", pose({0, 0, 2}, kDown))};
    scene.instances[1].world_from_mesh = glm::translate(glm::dmat4(1.0), {1, 0, 1.2});
    return scene;
}

/// Sigma as stated, and the error that there is, against the mean of all pictures: roots of means
/// of squares over pixels and seeds, and the same of the stated sigma's mean.
struct Calibration {
    double stated_rms = 0, stated_mean = 0, true_rms = 0, true_mean = 0;
};
Calibration calibrate(const Scene& scene, RenderOptions options, int seeds) {
    std::vector<std::vector<double>> y;
    Calibration result;
    double count = 0;
    for (int seed = 0; seed < seeds; ++seed) {
        options.seed = static_cast<std::uint32_t>(seed);
        const Rendered rendered = render_cpu(scene, options);
        const Layer& radiance = layer(rendered.picture, "");
        y.emplace_back();
        for (std::size_t i = 0; i < radiance.values.size(); i += 3)
            y.back().push_back(static_cast<double>(shared::luminance709(
                {radiance.values[i], radiance.values[i + 1], radiance.values[i + 2]})));
        for (const float sigma : layer(rendered.picture, "sigma").values) {
            result.stated_rms += static_cast<double>(sigma * sigma);
            result.stated_mean += static_cast<double>(sigma);
            ++count;
        }
    }
    for (std::size_t i = 0; i < y[0].size(); ++i) {
        double mean = 0, squares = 0;
        for (const auto& picture : y)
            mean += picture[i] / seeds;
        for (const auto& picture : y)
            squares += (picture[i] - mean) * (picture[i] - mean) / (seeds - 1);
        result.true_rms += squares / static_cast<double>(y[0].size());
        result.true_mean += std::sqrt(squares) / static_cast<double>(y[0].size());
    }
    result.stated_rms = std::sqrt(result.stated_rms / count);
    result.stated_mean /= count;
    result.true_rms = std::sqrt(result.true_rms);
    return result;
}

// Proves that the layer sigma is the error that there is, on average over pixels: for sums and
// samplers, one pass and several, one camera sample a pixel. Says nothing of single pixels, whose
// sigma few sets tell, nor of the bias of some samplers.
TEST(RenderError, SigmaIsTheErrorThatThereIs) {
    // The true sigma is itself known to 2 %, from 30 seeds and 144 pixels; the rest is the spread's
    // skewness in penumbrae.
    constexpr double kTolerance = 0.1;
    std::vector<RenderOptions> all(5, small(12));
    all[1].sampler = model::Sampler::Systematic;
    all[2].sampler = model::Sampler::Cells;
    all[3].error_rel = 0.05;
    all[4].samples = 8;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Calibration found = calibrate(penumbra_scene(), all[k], 30);
        const double mean_ratio = found.stated_mean / found.true_mean;
        RecordProperty("stated_per_true_mean_" + std::to_string(k), std::to_string(mean_ratio));
        RecordProperty("stated_per_true_rms_" + std::to_string(k),
                       std::to_string(found.stated_rms / found.true_rms));
        EXPECT_GT(found.true_rms, 0.0);
        EXPECT_NEAR(mean_ratio, 1.0, kTolerance) << k;
    }
}

// Proves that passes go on until the error is reached, that a wider goal costs less, and that a
// limit of samples is kept and said.
TEST(RenderError, PassesEndAtTheErrorOrAtTheLimit) {
    const Scene scene = penumbra_scene();
    RenderOptions options = small(24);
    double shadow_rays = 0;
    for (const double error_rel : {0.1, 0.03, 0.01}) {
        options.error_rel = error_rel;
        const RenderReport report = render_cpu(scene, options).report;
        EXPECT_TRUE(report.is_error_reached);
        EXPECT_LE(report.sampling.error_rel(), error_rel);
        EXPECT_GE(static_cast<double>(report.shadow_rays), shadow_rays);
        shadow_rays = static_cast<double>(report.shadow_rays);
    }
    EXPECT_GT(render_cpu(scene, options).report.passes, 1);
    options.samples = 40;
    const RenderReport limited = render_cpu(scene, options).report;
    EXPECT_FALSE(limited.is_error_reached);
    EXPECT_EQ(limited.samples, 40.0);
    EXPECT_GT(limited.sampling.error_rel(), 0.01);
}

/// A clock that stands still but for what it is told: each tile of a pass is one reading.
struct FakeClock {
    std::atomic<int> readings = 0;
    double step_s = 0;

    RenderHooks hooks() {
        RenderHooks result;
        result.clock_s = [this] { return step_s * ++readings; };
        return result;
    }
};

// Proves by a clock of its own, which goes on by a step with every reading, that a picture within a
// time has at least one pass over all its pixels, that no pass starts when the time is over, and
// that more time buys more samples.
TEST(RenderError, PassesEndWithTheTime) {
    const Scene scene = penumbra_scene();
    RenderOptions options = small(48);
    const Rendered whole = render_cpu(scene, options);
    options.samples = 128;  // to this clock samples cost nothing
    double samples = 0;
    for (const double step_s : {10.0, 1e-2, 1e-3, 1e-4}) {
        FakeClock clock;
        clock.step_s = step_s;
        options.time_s = 1.0;
        const Rendered rendered = render_cpu(scene, options, clock.hooks());
        const RenderReport& report = rendered.report;
        EXPECT_GE(report.passes, 1);
        EXPECT_GE(report.samples, samples) << step_s;
        samples = report.samples;
        for (const char* name : {"depth", "normal", "albedo"})
            EXPECT_EQ(layer(rendered.picture, name).values, layer(whole.picture, name).values);
        // Beyond the time only what is read once a tile and what a first pass needs.
        if (step_s < 1.0)
            EXPECT_LE(report.time_s, options.time_s + 20.0 * step_s);
        else
            EXPECT_EQ(report.passes, 1);
    }
}

// Proves that a sum too slow for the time is coarsened, and that the picture says by how much at
// most.
TEST(RenderError, TooLittleTimeCoarsensTheSumAndBoundsItsBias) {
    Scene scene = penumbra_scene();
    LightField lamp = one_window_lamp(0.2, 1.0F);
    lamp.slabs[0].texels = {64, 64};
    lamp.slabs[0].coeffs.resize(std::size_t{64} * 64);
    for (std::size_t i = 0; i < lamp.slabs[0].coeffs.size(); ++i)
        lamp.slabs[0].coeffs[i] = static_cast<float>((i * 37) % 11);
    scene.luminaires = {write_lamp(lamp, "fine", pose({0, 0, 2}, kDown))};
    // Every reading goes on by 0.7 of the step before: coarser trials seem faster, never fast
    // enough.
    double now_s = 0.0, step_s = 100.0;
    std::mutex mutex;
    RenderHooks hooks;
    hooks.clock_s = [&] {
        const std::lock_guard lock(mutex);
        return now_s += step_s *= 0.7;
    };
    RenderOptions options = small(24);
    options.samples = 16;
    options.time_s = 1.0;
    const Rendered hurried = render_cpu(scene, options, hooks);
    EXPECT_EQ(hurried.report.q, 2);
    options.time_s = 0.0;
    const Rendered exact = render_cpu(scene, options);
    EXPECT_EQ(exact.report.q, 0);
    const Layer &bound = layer(hurried.picture, "bias_bound"), &coarse = layer(hurried.picture, ""),
                &fine = layer(exact.picture, "");
    double bounds = 0;
    for (const float value : bound.values) {
        EXPECT_GE(value, 0.0F);
        bounds += static_cast<double>(value);
    }
    EXPECT_GT(bounds, 0.0);
    EXPECT_NEAR(hurried.report.sampling.error_rel(),
                hurried.report.sampling.mean_rel + hurried.report.sampling.bias_mean_rel, 0.0);
    EXPECT_NE(coarse.values, fine.values);
}

// Proves the figures of noise on numbers computed by hand: 20 lit pixels of sigma 1 ... 20 %, whose
// 95th percentile is 19 % and half of which are above 10 %; a dark pixel does not count.
TEST(RenderError, NoiseFiguresAreThoseComputedByHand) {
    Layer radiance{"", {"R", "G", "B"}, {}}, sigma{"sigma", {"Y"}, {}};
    for (int percent = 20; percent >= 1; --percent) {
        radiance.values.insert(radiance.values.end(), 3, 2.0F);
        sigma.values.push_back(2.0F * 0.01F * static_cast<float>(percent));
    }
    radiance.values.insert(radiance.values.end(), 3, 0.0019F);
    sigma.values.push_back(1.0F);
    sigma.values[10] = 0.2001F;  // 10 % and a little
    const Noise noise = summarize_noise(radiance, sigma);
    constexpr double kTolerance = 1e-6;  // float inputs
    EXPECT_NEAR(noise.mean_rel, (0.105 * 20.0 + 0.00005) / 20.0, kTolerance);
    EXPECT_NEAR(noise.p95_rel, 0.19, kTolerance);
    EXPECT_NEAR(noise.share_above_10_percent, 11.0 / 20.0, kTolerance);
    EXPECT_EQ(summarize_noise({"", {}, {0, 0, 0}}, {"", {}, {0}}).mean_rel, 0.0);
}

// Proves sigma_measured in closed form: of one coefficient, sigma over light is its own relative
// sigma and the common scale's in squares, whatever the scale of the scene; lamps of one file add
// as they are.
TEST(RenderError, MeasuredSigmaIsTheFilesRelativeSigmaTimesDiffuseRadiance) {
    LightField lamp = one_window_lamp(0.05, 2.0F);
    lamp.slabs[0].sigma = {0.06F};
    lamp.scale_sigma_rel = 0.04;
    const double relative = std::hypot(0.03, 0.04);
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(lamp, "measured", pose({0.3, 0.1, 2}, {0.1, 0.2, -1}))};
    scene.luminaires[0].dim = 0.5;
    scene.luminaires.push_back(scene.luminaires[0]);
    for (const double scale : {1.0, 0.01}) {
        const glm::dmat4 matrix = glm::scale(glm::dmat4(1.0), glm::dvec3(scale));
        RenderOptions options = small(5);
        options.samples_per_pixel = 4;
        options.sigma_measured = true;
        const Rendered rendered = render_cpu(transformed(scene, matrix), options);
        EXPECT_TRUE(rendered.report.has_sigma_measured);
        for (std::size_t i = 0; i < 25; ++i) {
            const float radiance = layer(rendered.picture, "").values[3 * i + 1];
            EXPECT_GT(radiance, 0.0F);
            EXPECT_NEAR(layer(rendered.picture, "sigma_measured").values[i] / radiance, relative,
                        1e-5 * relative);  // float sums against double
        }
    }
}

// Proves that the layer is not there where nobody asked for it, or where no file knows.
TEST(RenderError, MeasuredSigmaIsLeftOutWhereNothingIsKnown) {
    LightField lamp = one_window_lamp(0.05, 2.0F);
    Scene scene = floor_scene();
    RenderOptions options = small(4);
    const auto layers = [&] {
        scene.luminaires = {write_lamp(lamp, "perhaps", pose({0, 0, 2}, kDown))};
        return render_cpu(scene, options).picture.layers.size();
    };
    const std::size_t without = layers();
    options.sigma_measured = true;
    EXPECT_EQ(layers(), without);
    lamp.slabs[0].sigma = {0.06F};
    EXPECT_EQ(layers(), without + 1);
    options.sigma_measured = false;
    EXPECT_EQ(layers(), without);
}

}  // namespace
}  // namespace nearfield::render
