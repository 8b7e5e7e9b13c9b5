// SPDX-License-Identifier: Apache-2.0
// Glossy lobes by samples of lamp and lobe: OpenGL against the CPU's renderer.
#include "formats/model/profile.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/gpu/samples_run.h"
#include "tests/support/lamps.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace nearfield::render::gpu {
namespace {

using model::Sampler;

class SamplesGlossTest : public GlTest {};

shared::Brdf ggx(float alpha) {
    shared::Brdf brdf = lambert();
    brdf.kind = shared::kBrdfGgx;
    brdf.specular = {0.9F, 0.7F, 0.4F};
    brdf.alpha = {alpha, 0.5F * alpha};
    return brdf;
}

SamplesCase make_case(Sampler sampler, const shared::Brdf& brdf) {
    const Slab slab =
        support::random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 3);
    SamplesCase samples;
    samples.needs.sampler = sampler;
    samples.needs.sequence = model::default_sequence(sampler);
    samples.needs.has_color = false;
    samples.needs.has_shadows = false;
    samples.slabs.push_back(make_test_slab(slab));
    glm::dmat4 aside(1.0);
    aside[3] = glm::dvec4(0.05, 0.01, -0.02, 1.0);
    samples.slabs.push_back(make_test_slab(
        support::random_lamp(model::make_profile("bilinear"), Weighting::Irradiance, 5), aside));
    samples.size_px = samples.query.size_px = {32, 24};
    samples.points = lit_points(slab, samples.size_px, 23);
    samples.brdf = brdf;
    samples.eye_m = {0.1F, 0.1F, -0.5F};
    samples.query.sets = make_sets(32, 1);
    return samples;
}

TEST_F(SamplesGlossTest, LobesReflectTheCpusLight) {
    shared::Brdf phong = lambert();
    phong.specular = {0.3F, 0.4F, 0.5F};
    phong.exponent = 200.0F;
    for (const Sampler sampler : {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                  Sampler::Systematic, Sampler::Cells}) {
        LightSamples drawing = make_light_samples(device(), make_case(sampler, phong).needs);
        for (const shared::Brdf& brdf : {phong, ggx(0.4F), ggx(0.05F)}) {
            const SamplesCase samples = make_case(sampler, brdf);
            const Difference found =
                difference(light_by_gl(device(), drawing, samples), light_by_cpu(samples));
            const std::string numbers = fmt::format(
                "kind {}, alpha {}, {}: {} of {} pixels differ, median {:.1e}, worst {:.1e}, "
                "variance {:.1e}",
                brdf.kind, brdf.alpha.x, name_of(sampler), found.different, found.pixels,
                found.median, found.worst, found.worst_variance);
            RecordProperty("numbers", numbers);
            EXPECT_TRUE(found.is_finite) << numbers;
            EXPECT_GT(found.pixels, 50U) << numbers;
            EXPECT_LE(static_cast<double>(found.different),
                      1e-3 * static_cast<double>(found.pixels))
                << numbers;
        }
    }
}

// The lobes' light alone is what the diffuse part leaves of the whole, and adds no irradiance.
TEST_F(SamplesGlossTest, GlossAloneIsTheWholeWithoutTheDiffusePart) {
    SamplesCase samples = make_case(Sampler::Systematic, ggx(0.2F));
    const std::vector<PixelLight> whole = light_by_gl(device(), samples);
    samples.needs.gloss_only = true;
    const std::vector<PixelLight> lobe = light_by_gl(device(), samples);
    samples.needs.gloss_only = samples.needs.has_gloss = false;
    const std::vector<PixelLight> diffuse = light_by_gl(device(), samples);
    int lit = 0;
    for (std::size_t k = 0; k < whole.size(); ++k) {
        EXPECT_EQ(lobe[k].irradiance, glm::vec3(0.0F));
        lit += lobe[k].radiance.g > 0.0F ? 1 : 0;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(lobe[k].radiance[c], whole[k].radiance[c] - diffuse[k].radiance[c],
                        1e-5F * whole[k].radiance[c]);
    }
    EXPECT_GT(lit, 300);
}

}  // namespace
}  // namespace nearfield::render::gpu
