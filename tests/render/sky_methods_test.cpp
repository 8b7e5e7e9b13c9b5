// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"
#include "tests/environment/skies.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>

namespace nearfield::render {
namespace {

using test::layer, test::metal, test::reference, test::relative_rms, test::rms_of_mean, test::small,
    test::soft_sky, test::sunny_sky, test::under;

Picture by(const Scene& scene, const EnvironmentOptions& environment, int samples = 0) {
    RenderOptions options = small();
    options.environment = environment;
    options.samples = samples;
    return render_cpu(scene, options).picture;
}

shared::Brdf matt_and_glossy() {
    shared::Brdf brdf = metal(shared::kBrdfPhong, 10.0F, {});
    brdf.specular = glm::vec3(0.4F);
    brdf.diffuse = glm::vec3(0.5F);
    return brdf;
}

Scene with_roof(Scene scene) {
    test::add_blocker(scene, "roof", {0.3, 0.2, 0.8}, {1.2F, 0.8F});
    return scene;
}

// Proves that far lamps drawn by luminance, and candidates chosen among more, end at the reference,
// shadows included: where they differ they differ by their noise.
TEST(SkyMethods, BaselinesEndAtTheReference) {
    const Scene scene = with_roof(under(soft_sky(), matt_and_glossy()));
    const Picture truth = reference(scene, 4096).picture;
    const Picture lights = by(scene, {.method = EnvironmentMethod::Lights, .directions = 4096});
    EXPECT_LT(relative_rms(lights, truth), 0.02);
    EXPECT_GT(
        relative_rms(by(scene, {.method = EnvironmentMethod::Lights, .directions = 16}), truth),
        2.0 * relative_rms(lights, truth));
    const Picture resampled = by(scene, {.method = EnvironmentMethod::Resampled}, 1024);
    EXPECT_LT(relative_rms(resampled, truth), 0.02);
}

// Proves that one candidate kept of 8 is unbiased too: means over pixels of a plain floor, 256 of
// them, are the truth's within 4 of their own sigmas.
TEST(SkyMethods, ResampledIsUnbiased) {
    const Scene scene = under(soft_sky(), matt_and_glossy());
    const Picture truth = reference(scene, 4096).picture;
    RenderOptions options = small();
    options.environment.method = EnvironmentMethod::Resampled;
    options.samples = 4;
    double sum = 0.0, variance = 0.0, expected = 0.0;
    for (std::uint32_t seed = 1; seed <= 16; ++seed) {
        options.seed = seed;
        const Picture picture = render_cpu(scene, options).picture;
        for (std::size_t k = 0; k < layer(picture, "sigma").values.size(); ++k)
            if (layer(picture, "depth").values[k] > 0.0F) {
                sum += static_cast<double>(layer(picture, "").values[3 * k + 1]);
                expected += static_cast<double>(layer(truth, "").values[3 * k + 1]);
                variance += std::pow(static_cast<double>(layer(picture, "sigma").values[k]), 2);
            }
    }
    EXPECT_LT(std::abs(sum - expected), 4.0 * std::sqrt(variance));
    EXPECT_LT(std::sqrt(variance), 0.01 * expected);
}

// Proves that filtered light is hidden where the reference's is: with rays in few directions the
// picture is nearer to the traced one, and the more the nearer until harmonics end it.
TEST(SkyMethods, FilteredLightThrowsShadows) {
    const Scene scene = with_roof(under(soft_sky(), matt_and_glossy()));
    const Picture truth = reference(scene, 4096).picture;
    const auto error = [&](int directions) {
        return relative_rms(by(scene, {.samples = 128, .directions = directions}), truth);
    };
    EXPECT_LT(error(64), 0.5 * error(0));
    EXPECT_LT(error(64), error(8));
}

// Proves that directions cost nothing where nothing can hide the sky, and change nothing.
TEST(SkyMethods, OneSurfaceAsksForNoRay) {
    const Scene scene = under(sunny_sky(), matt_and_glossy());
    RenderOptions options = small();
    const Rendered plain = render_cpu(scene, options);
    EXPECT_EQ(plain.report.shadow_rays, 0U);
    options.effects.shadows = Switch::On;
    const Rendered forced = render_cpu(scene, options);
    EXPECT_GT(forced.report.shadow_rays, 0U);
    EXPECT_EQ(layer(plain.picture, "").values, layer(forced.picture, "").values);
}

// Proves what levels by the density's mean and lookups along the longer axis are for: brushed
// metal, whose lobe is much longer than wide, is blurred less by them than by FIS' round filter.
TEST(SkyMethods, BrushedMetalIsBlurredLess) {
    const Scene scene = under(sunny_sky(), metal(shared::kBrdfWard, 0.0F, {0.02F, 0.4F}));
    const Picture truth = reference(scene, 4096, false).picture;
    const auto error = [&](const EnvironmentOptions& options) {
        return rms_of_mean(by(scene, options), truth);
    };
    const double fis = error({.samples = 64});
    const double anisotropic = error({.samples = 64, .is_anisotropic = true});
    std::cout << "fis " << fis << ", anisotropic " << anisotropic << ", unfiltered "
              << error({.samples = 64, .level = FilterLevel::None}) << "\n";
    EXPECT_LT(anisotropic, fis);
}

}  // namespace
}  // namespace nearfield::render
