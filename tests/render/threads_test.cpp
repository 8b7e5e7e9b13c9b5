// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/light_sums.h"
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <vector>

namespace nearfield::render {
namespace {

using test::layer;
using test::pose;
using test::small;
using test::uneven_scene;

/// A picture whose every kind of light is on: two lamps, penumbrae, gloss, color.
Scene glossy_scene() {
    Scene scene = uneven_scene();
    scene.materials[0].metallic = 0.5F;
    scene.materials[0].roughness = 0.4F;
    scene.luminaires.push_back(scene.luminaires[0]);
    scene.luminaires[1].world_from_luminaire = pose({0.9, -0.4, 0.8}, {-0.8, 0.2, -0.5});
    return scene;
}

void expect_same_bits(const Rendered& one, const Rendered& other) {
    ASSERT_EQ(one.picture.layers.size(), other.picture.layers.size());
    for (std::size_t i = 0; i < one.picture.layers.size(); ++i)
        EXPECT_EQ(one.picture.layers[i].values, other.picture.layers[i].values)
            << one.picture.layers[i].name;
    EXPECT_EQ(one.report.shadow_rays, other.report.shadow_rays);
    EXPECT_EQ(one.report.multiply_adds, other.report.multiply_adds);
}

// Proves that scheduling never shows: for every sampler, with a coarser sum and towards an error,
// equal bits for 1, 2 and all threads, and other bits for another seed.
TEST(Threads, TheirNumberDoesNotChangeABit) {
    const Scene scene = glossy_scene();
    std::vector<RenderOptions> all(9, small(24));
    using model::Sampler;
    const Sampler samplers[] = {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                Sampler::Systematic, Sampler::Cells};
    for (std::size_t i = 0; i < std::size(samplers); ++i)
        all[i].sampler = samplers[i];
    all[6].samples_per_pixel = 4;
    all[7].q = 2;
    all[8].error_rel = 0.05;
    for (RenderOptions& options : all) {
        SCOPED_TRACE(options.sampler ? model::name_of(*options.sampler) : "sum");
        options.threads = 1;
        const Rendered one = render_cpu(scene, options);
        EXPECT_GT(one.report.sampling.mean_rel, 0.0);
        for (const int threads : {2, 0}) {
            options.threads = threads;
            expect_same_bits(one, render_cpu(scene, options));
        }
        options.seed = 2;
        EXPECT_NE(layer(one.picture, "").values,
                  layer(render_cpu(scene, options).picture, "").values);
    }
}

// Proves that summing light for many hits at once changes no bit of any of them, and that
// multiply-adds are counted where they are done.
TEST(LightSums, OfManyHitsAreThoseOfEach) {
    const Lamps lamps = load_lamps(uneven_scene());
    std::vector<Hit> hits(7);
    for (std::size_t k = 0; k < hits.size(); ++k) {
        hits[k].position_world_m = {0.3 * static_cast<double>(k) - 0.9, 0.2, k == 4 ? 3.0 : 0.0};
        hits[k].shading_normal = {0, 0, 1};
    }
    LightSums all, one;
    sum_light(lamps.lamps[0], 0, hits, all);
    std::uint64_t multiply_adds = 0;
    for (std::size_t k = 0; k < hits.size(); ++k) {
        sum_light(lamps.lamps[0], 0, {&hits[k], 1}, one);
        EXPECT_EQ(all.irradiance[k], one.irradiance[0]) << k;
        EXPECT_EQ(all.total_y[k], one.total_y[0]) << k;
        EXPECT_EQ(k == 4, one.multiply_adds == 0U) << k;  // behind the lamp
        multiply_adds += one.multiply_adds;
    }
    EXPECT_EQ(all.multiply_adds, multiply_adds);
}

}  // namespace
}  // namespace nearfield::render
