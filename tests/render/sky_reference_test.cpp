// SPDX-License-Identifier: Apache-2.0
// The reference: samples of sky and BRDF with a ray each.
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::render {
namespace {

using test::constant_sky, test::for_each_surface, test::layer, test::metal, test::reference,
    test::small, test::sunny_sky, test::under;

// Proves that the reference's sigma is its error: z over pixels of two runs with other seeds is of
// unit width, and its mean of both halves is the filtered diffuse light within the harmonics'
// bound.
TEST(Sky, ReferenceKnowsItsNoise) {
    const Scene scene = under(sunny_sky(), metal(shared::kBrdfGgx, 0.0F, {0.4F, 0.4F}));
    RenderOptions options = small();
    options.environment.method = EnvironmentMethod::Reference;
    options.samples = 256;
    const Picture a = render_cpu(scene, options).picture;
    options.seed = 2;
    const Picture b = render_cpu(scene, options).picture;
    double squares = 0.0;
    int count = 0;
    for_each_surface(a, [&](std::size_t k) {
        const auto y = [&](const Picture& p) {
            const std::vector<float>& v = layer(p, "").values;
            return 0.2126 * static_cast<double>(v[3 * k]) +
                   0.7152 * static_cast<double>(v[3 * k + 1]) +
                   0.0722 * static_cast<double>(v[3 * k + 2]);
        };
        const double sigma = std::hypot(static_cast<double>(layer(a, "sigma").values[k]),
                                        static_cast<double>(layer(b, "sigma").values[k]));
        ASSERT_GT(sigma, 0.0);
        squares += std::pow((y(a) - y(b)) / sigma, 2);
        ++count;
    });
    // Student's t of 6 degrees of freedom: variance 1.5, and some 200 pixels.
    EXPECT_GT(squares / count, 0.7);
    EXPECT_LT(squares / count, 2.5);
}

// Proves that an occluder hides the sky from the reference, and shadows=off shows it again.
TEST(Sky, ReferenceTracesVisibility) {
    Scene scene = under(constant_sky(glm::vec3(1.0F)));
    test::add_blocker(scene, "roof", {0, 0, 2.0}, {40.0F, 40.0F});
    const Rendered dark = reference(scene, 64);
    for_each_surface(dark.picture, [&](std::size_t k) {
        EXPECT_LT(layer(dark.picture, "environment").values[3 * k], 0.06F);
    });
    EXPECT_GT(dark.report.shadow_rays, 0U);
    const Rendered open = reference(scene, 64, false);
    EXPECT_EQ(open.report.shadow_rays, 0U);
    for_each_surface(open.picture, [&](std::size_t k) {
        EXPECT_GT(layer(open.picture, "environment").values[3 * k], 0.45F);
    });
}

}  // namespace
}  // namespace nearfield::render
