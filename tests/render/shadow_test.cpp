// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::render {
namespace {

using test::add_blocker;
using test::floor_scene;
using test::half_covered;
using test::kDown;
using test::kWindowDelta;
using test::layer;
using test::one_window_lamp;
using test::pose;
using test::small;
using test::write_lamp;

// Proves that an opaque rectangle takes all light and that sigma is zero where nothing is
// uncertain.
TEST(Shadow, BlockerShadowsTotally) {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.05, 1.0F), "lamp", pose({0, 0, 2}, kDown))};
    add_blocker(scene, "blocker", {0, 0, 1.9}, {4, 4});
    scene.cameras = {test::camera_at({0, -3, 1}, {0, 3, -1}, {0, 0, 1}, 0.5)};  // under the blocker
    const Rendered rendered = render_cpu(scene, small());
    for (const char* name : {"", "irradiance", "sigma"})
        for (const float value : layer(rendered.picture, name).values)
            EXPECT_EQ(value, 0.0F);
    EXPECT_GT(rendered.report.shadow_rays, 0U);
}

// Proves the ratio estimator against geometry: on a lamp whose integrand is even over U, light is
// the visible share of the aperture. The middle of an odd picture looks at the aperture's middle.
TEST(Shadow, HalfCoveredApertureGivesHalf) {
    const double unshadowed = kWindowDelta * kWindowDelta * 0.2 * 0.2 / (2.1 * 2.1);
    RenderOptions options = small(1);
    double sum = 0, squares = 0;
    constexpr int kSeeds = 200;
    for (int seed = 0; seed < kSeeds; ++seed) {
        options.seed = static_cast<std::uint32_t>(seed);
        const Rendered rendered = render_cpu(half_covered(), options);
        const double ratio = layer(rendered.picture, "irradiance").values[0] / unshadowed;
        sum += ratio;
        squares += (ratio - 0.5) * (ratio - 0.5);
    }
    const double rms = std::sqrt(squares / kSeeds);
    RecordProperty("observed_rms", std::to_string(rms));
    EXPECT_NEAR(sum / kSeeds, 0.5, 3.0 * rms / std::sqrt(kSeeds));
    EXPECT_LT(rms, 0.25 / std::sqrt(64.0));  // half of what 64 independent samples would do
}

// Measures the ratio estimator's bias at 8 samples against 1024 over penumbra pixels and seeds.
TEST(Shadow, RatioEstimatorBiasIsBelowOnePercentAtEightSamples) {
    // A lamp with structure: weights differ from sample to sample only then.
    LightField lamp = one_window_lamp(0.2, 1.0F);
    Slab& slab = lamp.slabs[0];
    slab.texels = {9, 7};
    slab.coeffs.resize(63);
    for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
        slab.coeffs[i] = static_cast<float>((i * 37) % 11);
    Scene scene = half_covered();
    scene.luminaires = {write_lamp(lamp, "structured", pose({0, 0, 2}, kDown))};
    scene.instances[1].world_from_mesh = glm::translate(glm::dmat4(1.0), {1, 0, 1.2});
    const auto total = [&](int samples, int seeds) {
        double sum = 0;
        for (int seed = 0; seed < seeds; ++seed) {
            RenderOptions options = small(32);
            options.samples = samples;
            options.seed = static_cast<std::uint32_t>(seed);
            const Rendered rendered = render_cpu(scene, options);
            for (const float value : layer(rendered.picture, "irradiance").values)
                sum += value;
        }
        return sum / seeds;
    };
    const double reference = total(1024, 2);
    const double bias = total(8, 32) / reference - 1.0;
    RecordProperty("bias_at_8", std::to_string(bias));
    EXPECT_LT(std::abs(bias), 0.01);
}

// Proves that an excluded mesh casts no shadow in the light of the lamp that names it, by node or
// by mesh, and still does in another's.
TEST(Shadow, ExcludedMeshCastsNoShadowForItsLampAlone) {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.05, 1.0F), "a", pose({0, 0, 2}, kDown))};
    const Rendered open = render_cpu(scene, small());
    add_blocker(scene, "lens", {0, 0, 1.99}, {3, 3});
    scene.cameras = {test::camera_at({0, -3, 1}, {0, 3, -1}, {0, 0, 1}, 0.3)};
    scene.luminaires.push_back(scene.luminaires[0]);
    for (const char* name : {"lens", "lens mesh"}) {
        scene.luminaires[1].excludes = {name};
        const Rendered rendered = render_cpu(scene, small());
        EXPECT_EQ(layer(rendered.picture, "lamp.a").values[0], 0.0F);
        EXPECT_NEAR(layer(rendered.picture, "lamp.a_2").values[std::size_t{3} * 136],
                    layer(open.picture, "lamp.a").values[std::size_t{3} * 136],
                    1e-6F * layer(open.picture, "lamp.a").values[std::size_t{3} * 136]);
    }
}

// Proves that shadow samples are shared among slabs by energy and weighted back: with one of two
// slabs hidden, the other's light is what remains, to within one sample of each of the four sets
// of 16.
TEST(Shadow, HiddenSlabTakesItsShareOfTheLight) {
    LightField both = one_window_lamp(0.05, 1.0F);
    both.slabs.push_back(both.slabs[0]);
    both.slabs[1].coeffs = {3.0F};
    both.slabs[1].luminaire_from_slab.translation_m = {0.5, 0, 0.1};
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(both, "both", pose({0, 0, 2}, kDown))};
    add_blocker(scene, "cap", {0, 0, 1.99}, {0.4, 0.4});
    const Rendered rendered = render_cpu(scene, small());
    // E of a slab is delta^2 C a^2 / (height of U)^2 everywhere on the floor; the second slab's U
    // is 2.0 m high.
    const double expected = kWindowDelta * kWindowDelta * 3.0 * 0.05 * 0.05 / (2.0 * 2.0);
    const double hidden = kWindowDelta * kWindowDelta * 1.0 * 0.05 * 0.05 / (2.1 * 2.1);
    for (std::size_t i = 0; i < 256; ++i) {
        if (layer(rendered.picture, "depth").values[i] < 3.9F)
            continue;  // the cap itself
        EXPECT_NEAR(layer(rendered.picture, "irradiance").values[3 * i], expected,
                    (expected + hidden) / 16.0);
    }
}

}  // namespace
}  // namespace nearfield::render
