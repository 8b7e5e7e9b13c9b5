// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"
#include "tests/environment/skies.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace nearfield::render {
namespace {

using test::constant_sky, test::difference, test::for_each_surface, test::layer, test::metal,
    test::reference, test::relative_rms, test::small, test::sunny_sky, test::under;

// Proves absolute scale: under light of 1 from everywhere a surface of albedo 0.5 looks 0.5, its
// irradiance is pi, and what is past it is 1. Filtered and as a reference.
TEST(Sky, ConstantLightGivesTheAlbedo) {
    const Scene scene = under(constant_sky(glm::vec3(1.0F)));
    for (const bool is_reference : {false, true}) {
        const Rendered rendered =
            is_reference ? reference(scene, 1024) : render_cpu(scene, small());
        const Picture& picture = rendered.picture;
        for_each_surface(picture, [&](std::size_t k) {
            EXPECT_NEAR(layer(picture, "").values[3 * k], 0.5F, is_reference ? 0.02F : 1e-3F);
            EXPECT_NEAR(layer(picture, "irradiance").values[3 * k], 3.14159F,
                        is_reference ? 0.12F : 6e-3F);
        });
        EXPECT_EQ(layer(picture, "").values, layer(picture, "environment").values);
        const auto& depth = layer(picture, "depth").values;
        const auto past = std::find(depth.begin(), depth.end(), 0.0F) - depth.begin();
        ASSERT_LT(past, static_cast<std::ptrdiff_t>(depth.size()));
        EXPECT_EQ(layer(picture, "").values[3 * static_cast<std::size_t>(past)], 1.0F);
    }
}

// Proves that filtered samples carry each lobe's weight: under constant light what they give is the
// lobe's albedo, which the reference draws in another way (it evaluates lobe and density).
TEST(Sky, ConstantLightGivesEachLobesAlbedo) {
    for (const shared::Brdf& brdf :
         {metal(shared::kBrdfPhong, 20.0F, {}), metal(shared::kBrdfGgx, 0.0F, {0.3F, 0.3F}),
          metal(shared::kBrdfWard, 0.0F, {0.2F, 0.4F}), metal(shared::kBrdfLafortune, 8.0F, {}),
          metal(shared::kBrdfHalfwayDisk, 30.0F, {})}) {
        const Scene scene = under(constant_sky(glm::vec3(1.0F)), brdf);
        RenderOptions options = small();
        options.environment.samples = 256;
        EXPECT_LT(relative_rms(render_cpu(scene, options).picture, reference(scene, 4096).picture),
                  0.015)
            << brdf.kind;
    }
}

// Proves that filtered samples converge to the reference where light is soft, and that under a sun
// of one pixel they are nearer to it than the same samples unfiltered, which hit it or miss it.
TEST(Sky, FilteredSamplesAreNearTheReference) {
    const auto error = [](const Scene& scene, const Picture& truth, FilterLevel level,
                          int samples) {
        RenderOptions options = small();
        options.environment.samples = samples;
        options.environment.level = level;
        options.environment.suns = 0;
        return test::rms_of_mean(render_cpu(scene, options).picture, truth);
    };
    const Scene soft = under(test::soft_sky(), metal(shared::kBrdfPhong, 30.0F, {}));
    const Picture soft_truth = reference(soft, 1024, false).picture;
    const double few = error(soft, soft_truth, FilterLevel::Fis, 16);
    const double more = error(soft, soft_truth, FilterLevel::Fis, 256);
    const Scene sunny = under(sunny_sky(), metal(shared::kBrdfPhong, 30.0F, {}));
    const Picture sunny_truth = reference(sunny, 4096, false).picture;
    const double filtered = error(sunny, sunny_truth, FilterLevel::Fis, 64);
    const double plain = error(sunny, sunny_truth, FilterLevel::None, 64);
    std::cout << "soft " << few << " -> " << more << "; sunny, filtered " << filtered
              << ", unfiltered " << plain << "\n";
    EXPECT_LT(more, 0.02);
    EXPECT_LT(more, 0.7 * few);
    EXPECT_LT(filtered, 0.8 * plain);
}

// Proves that rotation turns what arrives as it turns the scene, and that intensity is a factor.
TEST(Sky, TurnsAndScales) {
    shared::Brdf brdf = metal(shared::kBrdfPhong, 10.0F, {});
    brdf.specular = glm::vec3(0.5F);
    brdf.diffuse = {0.2F, 0.3F, 0.4F};
    const Scene scene = under(sunny_sky(), brdf);
    const Rendered plain = render_cpu(scene, small());

    Scene bright = scene;
    bright.environment->intensity = 4.0;
    const Rendered four = render_cpu(bright, small());
    for (std::size_t k = 0; k < layer(plain.picture, "").values.size(); ++k)
        EXPECT_EQ(layer(four.picture, "").values[k], 4.0F * layer(plain.picture, "").values[k]);

    const glm::dmat4 turn = test::pose({0.3, 0.1, 0.2}, glm::normalize(glm::dvec3(0.4, 0.5, 0.6)));
    Scene turned = test::transformed(scene, turn);
    turned.environment->world_from_environment = glm::dmat3(turn);
    const Rendered both = render_cpu(turned, small());
    // Tangents of a mesh without them are made from world normals: isotropic lobes do not care but
    // for where samples fall.
    EXPECT_LT(difference(layer(plain.picture, "irradiance"), layer(both.picture, "irradiance")),
              1e-4);
    Scene sky_alone = test::transformed(scene, turn);
    EXPECT_GT(difference(layer(plain.picture, "irradiance"),
                         layer(render_cpu(sky_alone, small()).picture, "irradiance")),
              0.05);
}

// Proves that lamps' light is what it is without a sky, and the sky's what it is without lamps.
TEST(Sky, AddsToLamps) {
    Scene scene = test::uneven_scene();
    const Picture lamps = render_cpu(scene, small()).picture;
    scene.environment = sunny_sky();
    const Picture both = render_cpu(scene, small()).picture;
    scene.luminaires.clear();
    const Picture sky = render_cpu(scene, small()).picture;
    float largest = 0.0F;
    for (const float value : layer(both, "").values)
        largest = std::max(largest, value);
    for (std::size_t k = 0; k < layer(both, "").values.size(); ++k)
        EXPECT_NEAR(layer(both, "").values[k],
                    layer(lamps, "").values[k] + layer(sky, "").values[k], 1e-6F * largest);
}

// Proves that the picture holds the same light after several passes, towards an error.
TEST(Sky, IsTheSameAfterSeveralPasses) {
    Scene scene = test::uneven_scene();
    scene.environment = sunny_sky();
    RenderOptions options = small();
    const Picture one = render_cpu(scene, options).picture;
    options.error_rel = 1e-12;  // the lamp is faint beside this sky
    options.samples = 256;
    const Rendered many = render_cpu(scene, options);
    EXPECT_GT(many.report.passes, 1);
    EXPECT_LT(difference(layer(one, "environment"), layer(many.picture, "environment")), 1e-6);
}

}  // namespace
}  // namespace nearfield::render
