// SPDX-License-Identifier: Apache-2.0
// How many filtered samples pixels draw.
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>

namespace nearfield::render {
namespace {

using test::metal, test::reference, test::rms_of_mean, test::small, test::under, test::with_ball;

Rendered with_error(const Scene& scene, double error_rel, int most, int samples_per_pixel = 1) {
    RenderOptions options = small();
    options.samples_per_pixel = samples_per_pixel;
    options.environment.error_rel = error_rel;
    options.environment.samples = most;
    return render_cpu(scene, options);
}

// Proves that what does not vary asks for the fewest samples, that without an error all are drawn,
// and that what is no lobe draws none.
TEST(SkyCount, AsksForFewWhereLightIsEven) {
    const shared::Brdf phong = metal(shared::kBrdfPhong, 30.0F, {});
    const Scene even = under(test::constant_sky(glm::vec3(2.0F)), phong);
    const std::uint64_t all = with_error(even, 0.0, 64).report.sky_samples;
    EXPECT_GT(all, 0U);
    EXPECT_EQ(with_error(even, 0.01, 64).report.sky_samples, all / 8);
    EXPECT_EQ(with_error(under(test::sunny_sky()), 0.01, 64).report.sky_samples, 0U);
}

// Proves that smaller errors draw more samples and err less, and that rough lobes, over which light
// varies more, draw more than smooth ones.
TEST(SkyCount, FollowsErrorAndRoughness) {
    const Scene scene = under(test::soft_sky(), metal(shared::kBrdfPhong, 30.0F, {}));
    const Picture truth = reference(scene, 1024, false).picture;
    const Rendered rough = with_error(scene, 0.1, 512), fine = with_error(scene, 0.01, 512);
    std::cout << "0.1: " << rms_of_mean(rough.picture, truth)
              << ", 0.01: " << rms_of_mean(fine.picture, truth) << "\n";
    EXPECT_GT(fine.report.sky_samples, 3 * rough.report.sky_samples);
    EXPECT_LT(rms_of_mean(fine.picture, truth), 0.7 * rms_of_mean(rough.picture, truth));
    const Scene smooth = under(test::soft_sky(), metal(shared::kBrdfPhong, 3000.0F, {}));
    EXPECT_LT(with_error(smooth, 0.01, 512).report.sky_samples, fine.report.sky_samples / 2);
}

// Proves that camera samples of a pixel share the work where the surface turns within it, and do
// not where it is flat.
TEST(SkyCount, CurvedPixelsShareTheWork) {
    const shared::Brdf brdf = metal(shared::kBrdfPhong, 300.0F, {});
    const Scene flat = under(test::soft_sky(), brdf);
    Scene curved = with_ball(flat);
    curved.instances.erase(curved.instances.begin());
    const auto drawn = [&](const Scene& scene, int samples_per_pixel) {
        return static_cast<double>(
            with_error(scene, 0.01, 4096, samples_per_pixel).report.sky_samples);
    };
    EXPECT_NEAR(drawn(flat, 4) / drawn(flat, 1), 4.0, 0.2);
    EXPECT_LT(drawn(curved, 4) / drawn(curved, 1), 3.0);
}

}  // namespace
}  // namespace nearfield::render
