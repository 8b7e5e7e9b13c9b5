// SPDX-License-Identifier: Apache-2.0
// What goes wrong naively: receivers near and behind U, on S, far away and turned away; lamps of
// one texel, with dark windows. OpenGL gives what the CPU gives, and no NaN.
#include "formats/model/profile.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/gpu/samples_run.h"
#include "tests/support/lamps.h"
#include "tests/support/receivers.h"
#include "tests/support/z_test.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render::gpu {
namespace {

using model::Sampler;

class SamplesHardTest : public GlTest {};

constexpr Sampler kSamplers[] = {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                 Sampler::Systematic, Sampler::Cells};

SurfacePoint point_of(const model::Receiver& receiver) {
    const model::ReceiverF rounded = support::as_float(receiver);
    SurfacePoint point;
    point.position_world_m = rounded.position_m;
    point.normal = rounded.normal;
    point.material = 0;
    return point;
}

SamplesCase make_case(const Slab& slab, Sampler sampler, std::vector<SurfacePoint> points) {
    SamplesCase samples;
    samples.needs.sampler = sampler;
    samples.needs.sequence = model::default_sequence(sampler);
    samples.needs.has_color = slab.channels == 3;
    samples.needs.has_shadows = false;
    samples.needs.has_gloss = false;
    samples.slabs.push_back(make_test_slab(slab));
    samples.size_px = {static_cast<int>(points.size()), 1};
    samples.points = std::move(points);
    samples.brdf = lambert();
    samples.query.size_px = samples.size_px;
    samples.query.sets = make_sets(16, 1);
    return samples;
}

// All kinds of receivers at one height, behind U and at it too.
std::vector<SurfacePoint> points_at(const Slab& slab, double height_per_delta) {
    std::vector<SurfacePoint> points;
    for (const std::uint64_t seed : {11, 12, 13})
        for (const support::HardReceiver& hard :
             support::hard_receivers(slab, height_per_delta, seed))
            points.push_back(point_of(hard.receiver));
    for (const double behind : {-1.0, -1.0000001, -1.5, -30.0}) {
        model::Receiver receiver;
        receiver.position_m = {0.01, -0.02, behind * slab.delta_m};
        points.push_back(point_of(receiver));
    }
    return points;
}

std::vector<Slab> hard_lamps() {
    const Profile bspline = model::make_profile("bspline");
    std::vector<Slab> lamps = {support::random_lamp(bspline, Weighting::Irradiance, 3),
                               support::random_lamp(bspline, Weighting::Radiance, 4)};
    support::LampShape one;
    one.texels = {1, 1};
    one.dark_fraction = 0.0;
    lamps.push_back(support::random_lamp(bspline, Weighting::Irradiance, 5, one));
    one.grid = {1, 1};
    lamps.push_back(support::random_lamp(bspline, Weighting::Irradiance, 5, one));
    Slab single = lamps[0];  // one texel lit, the last column's
    std::fill(single.coeffs.begin(), single.coeffs.end(), 0.0F);
    for (int m = 0; m < single.image_count(); ++m)
        single.coeffs[single.image_offset(0, m) +
                      static_cast<std::size_t>(single.texels.x * 11 - 1)] = 3.0F;
    lamps.push_back(single);
    Slab dark = single;
    std::fill(dark.coeffs.begin(), dark.coeffs.end(), 0.0F);
    lamps.push_back(dark);
    // Windows of 1e-11 of their image's light: one texel outshines all others.
    support::LampShape flat;
    flat.decades = 1;
    Slab faint = support::random_lamp(bspline, Weighting::Irradiance, 6, flat);
    for (int m = 0; m < faint.image_count(); ++m)
        faint.coeffs[faint.image_offset(0, m)] = 3e15F;
    lamps.push_back(faint);
    return lamps;
}

// As printed Pdis places a sample in its texel by a difference of whole positions: near S, where it
// sees less than 1e-5 of a texel, what is left is rounding.
bool is_rounding(Sampler sampler, double height) {
    return sampler == Sampler::Pdis && std::abs(height) < 1e-5;
}

TEST_F(SamplesHardTest, ReceiversAndLampsGetTheCpusLight) {
    const std::vector<Slab> lamps = hard_lamps();
    std::size_t pixels = 0, different = 0;
    for (const Sampler sampler : kSamplers) {
        LightSamples drawing = make_light_samples(device(), make_case(lamps[0], sampler, {}).needs);
        for (std::size_t k = 0; k < lamps.size(); ++k)
            for (const double height : support::kHardHeights) {
                const SamplesCase samples =
                    make_case(lamps[k], sampler, points_at(lamps[k], height));
                const Difference found =
                    difference(light_by_gl(device(), drawing, samples), light_by_cpu(samples));
                EXPECT_TRUE(found.is_finite)
                    << "lamp " << k << ", " << name_of(sampler) << " at " << height;
                if (is_rounding(sampler, height))
                    continue;
                pixels += found.pixels;
                different += found.different;
                if (found.different > 0)
                    RecordProperty(fmt::format("lamp_{}_{}_{}", k, name_of(sampler), height),
                                   fmt::format("{:.1e}", found.worst));
            }
    }
    RecordProperty("pixels", std::to_string(pixels));
    RecordProperty("different", std::to_string(different));
    EXPECT_GT(pixels, 1000U);
    EXPECT_LE(static_cast<double>(different), 1e-3 * static_cast<double>(pixels));
}

// Windows that tables do not resolve are drawn from by their texels.
TEST_F(SamplesHardTest, DarkWindowsAreSummedByTexels) {
    const Slab faint = hard_lamps().back();
    for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells}) {
        const SamplesCase samples = make_case(faint, sampler, lit_points(faint, {40, 20}, 5));
        const std::vector<PixelLight> expected = light_by_cpu(samples);
        const std::vector<PixelLight> found = light_by_gl(device(), samples);
        // Those that do not see the texel that outshines all others.
        std::vector<PixelLight> dark_found, dark_expected;
        for (std::size_t k = 0; k < expected.size(); ++k)
            if (expected[k].irradiance.g < 1e3F) {
                dark_found.push_back(found[k]);
                dark_expected.push_back(expected[k]);
            }
        const Difference dark = difference(dark_found, dark_expected);
        EXPECT_GT(dark.pixels, 100U);
        EXPECT_EQ(dark.different, 0U);
        EXPECT_TRUE(dark.is_finite);
    }
}

// The mean over many seeds against the exact sum, at receivers of every height: what a formula
// wrong on both sides would miss.
TEST_F(SamplesHardTest, SystematicIsUnbiased) {
    const Slab slab =
        support::random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 3);
    constexpr int kReceivers = 24, kRuns = 1024;
    const std::vector<SurfacePoint> receivers = lit_points(slab, {kReceivers, 1}, 41);
    // A column a receiver; its rows are runs, since shifts are random from pixel to pixel.
    std::vector<SurfacePoint> points;
    for (int run = 0; run < kRuns; ++run)
        points.insert(points.end(), receivers.begin(), receivers.end());
    for (const int count : {1, 16}) {
        SamplesCase samples = make_case(slab, Sampler::Systematic, points);
        samples.size_px = samples.query.size_px = {kReceivers, kRuns};
        samples.query.sets = {count, 1};
        const std::vector<PixelLight> found = light_by_gl(device(), samples);
        double largest = 0.0;
        for (std::size_t r = 0; r < kReceivers; ++r) {
            const glm::dvec3 position_m(receivers[r].position_world_m);
            const double truth =
                model::irradiance(slab, {position_m, glm::dvec3(receivers[r].normal)}).g;
            double sum = 0.0, squares = 0.0;
            for (std::size_t run = 0; run < kRuns; ++run) {
                const auto value = static_cast<double>(found[run * kReceivers + r].irradiance.g);
                sum += value;
                squares += value * value;
            }
            const double mean = sum / kRuns;
            const double variance = squares / kRuns - mean * mean;
            if (truth == 0.0) {
                EXPECT_EQ(mean, 0.0);
                continue;
            }
            largest = std::max(largest, std::abs(mean - truth) / std::sqrt(variance / kRuns));
        }
        RecordProperty("largest_z_1e-3", std::to_string(1e3 * largest));
        EXPECT_LT(largest, support::sidak_z_limit(2 * kReceivers)) << count;
    }
}

}  // namespace
}  // namespace nearfield::render::gpu
