// SPDX-License-Identifier: Apache-2.0
// OpenGL draws the samples that the CPU draws: the same random numbers, densities and sets. What is
// shared (formats/shared) is checked by the samplers' own tests (tests/model); here every pixel is
// compared. Rounding moves a sample across a texel's or an image's edge now and then.
#include "formats/model/profile.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/gpu/samples_run.h"
#include "tests/support/lamps.h"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

namespace nearfield::render::gpu {
namespace {

using model::Sampler;
using model::Sequence;
using model::Shift;

class SamplesTest : public GlTest {
  protected:
    void expect_same(const SamplesCase& samples, const std::string& what) {
        const Difference found = difference(light_by_gl(device(), samples), light_by_cpu(samples));
        const std::string numbers = fmt::format(
            "{}: {} of {} pixels differ, median {:.1e}, worst {:.1e}, variance {:.1e}", what,
            found.different, found.pixels, found.median, found.worst, found.worst_variance);
        RecordProperty(what, numbers);
        EXPECT_TRUE(found.is_finite) << numbers;
        EXPECT_GT(found.pixels, 10U) << numbers;
        EXPECT_LE(static_cast<double>(found.different), 1e-3 * static_cast<double>(found.pixels))
            << numbers;
        // Sets' differences are 1e-2 of their values and more (difference()); these agree to 1e-4.
        EXPECT_LT(found.worst_variance, 0.05) << numbers;
    }
};

SamplesCase make_case(const Slab& slab, Sampler sampler, int count) {
    SamplesCase samples;
    samples.needs.sampler = sampler;
    samples.needs.sequence = model::default_sequence(sampler);
    samples.needs.has_color = slab.channels == 3;
    samples.needs.has_shadows = false;
    samples.needs.has_gloss = false;
    samples.slabs.push_back(make_test_slab(slab));
    samples.size_px = {52, 41};  // no whole number of groups
    samples.points = lit_points(slab, samples.size_px, 17);
    samples.brdf = lambert();
    samples.query.size_px = samples.size_px;
    samples.query.sets = make_sets(count, 1);
    samples.query.first_set = 12;
    samples.query.seed = 5;
    samples.query.dim = 0.7F;
    return samples;
}

Slab lamp(const std::string& profile,
          Weighting weighting,
          std::uint64_t seed,
          const support::LampShape& shape = {}) {
    return support::random_lamp(model::make_profile(profile), weighting, seed, shape);
}

constexpr Sampler kSamplers[] = {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                 Sampler::Systematic, Sampler::Cells};

TEST_F(SamplesTest, EverySamplerDrawsTheCpusSamples) {
    const Slab slab = lamp("bspline", Weighting::Irradiance, 3);
    for (const Sampler sampler : kSamplers)
        for (const int count : {1, 16, 64})
            expect_same(make_case(slab, sampler, count),
                        fmt::format("{}, {} samples", name_of(sampler), count));
}

TEST_F(SamplesTest, EverySequenceAndShiftIsTheCpus) {
    const Slab slab = lamp("bspline", Weighting::Irradiance, 4);
    for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells})
        for (const Sequence sequence :
             {Sequence::Halton, Sequence::R2, Sequence::Fibonacci, Sequence::Sobol}) {
            SamplesCase samples = make_case(slab, sampler, 18);  // sets of 5, 5, 4, 4
            samples.needs.sequence = sequence;
            expect_same(samples, name_of(sampler) + ", " + name_of(sequence));
        }
    for (const Shift shift :
         {Shift::Constant, Shift::Random, Shift::BlueNoise, Shift::Interleaved}) {
        SamplesCase samples = make_case(slab, Sampler::Systematic, 18);
        samples.needs.shift = shift;
        expect_same(samples, name_of(shift));
    }
}

TEST_F(SamplesTest, ColorIsThatOfTheTexels) {
    support::LampShape shape;
    shape.channels = 3;
    const Slab slab = lamp("bspline", Weighting::Irradiance, 6, shape);
    for (const Sampler sampler : kSamplers)
        expect_same(make_case(slab, sampler, 64), "color, " + name_of(sampler));
}

TEST_F(SamplesTest, RadianceWeightingAndEveryProfile) {
    for (const Profile& profile : support::all_profiles()) {
        const Slab slab = support::random_lamp(profile, Weighting::Radiance, 7);
        for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells})
            expect_same(make_case(slab, sampler, 16), profile.name + ", " + name_of(sampler));
    }
}

TEST_F(SamplesTest, PdisHasItsLimitOfSamples) {
    SamplesCase samples = make_case(lamp("bspline", Weighting::Irradiance, 3), Sampler::Pdis, 256);
    samples.query.k_max = 5;
    expect_same(samples, "k_max 5");
}

// One stratified coordinate across both slabs, of which one is turned, mirrored and smaller.
TEST_F(SamplesTest, SlabsShareTheirSamples) {
    support::LampShape small;
    small.grid = {3, 4};
    small.texels = {17, 31};
    glm::dmat4 turned(glm::dmat3(support::rotation_about({0.0, 1.0, 0.0}, 0.15)));
    turned[3] = glm::dvec4(-0.05, 0.02, 0.01, 1.0);
    turned = turned * glm::scale(glm::dmat4(1.0), glm::dvec3(-0.8, 0.8, 0.8));
    for (const Sampler sampler : kSamplers) {
        SamplesCase samples = make_case(lamp("bspline", Weighting::Irradiance, 8), sampler, 64);
        samples.slabs.push_back(
            make_test_slab(lamp("bilinear", Weighting::Radiance, 9, small), turned));
        for (float& c : samples.slabs[1].sampling.prepared.slab.coeffs)
            c *= 0.1F;
        samples.slabs[1].sampling =
            model::prepare_sampling(samples.slabs[1].sampling.prepared.slab);
        expect_same(samples, "two slabs, " + name_of(sampler));
    }
}

TEST_F(SamplesTest, BandsMakeOneFrame) {
    SamplesCase samples = make_case(lamp("bspline", Weighting::Irradiance, 3), Sampler::Cells, 16);
    samples.most_energies = 1;  // 8 rows
    expect_same(samples, "bands");
}

}  // namespace
}  // namespace nearfield::render::gpu
