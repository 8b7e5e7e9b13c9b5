// SPDX-License-Identifier: Apache-2.0
// The sum on coarser images: which level it takes, that levels keep the light, and its bias on the
// reference lamp against the exact sum in double (which sum_test.cpp and reference_lamp_test.cpp
// prove).
#include "formats/model/mip_sum.h"

#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "tests/support/lamps.h"
#include "tests/support/receivers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::model {
namespace {

using support::as_double;
using support::as_float;
using support::LampShape;
using support::random_lamp;
using support::reference_lamp;
using support::reference_receivers;

Slab odd_lamp(Weighting weighting, int channels) {
    LampShape shape;
    shape.texels = {37, 22};
    shape.channels = channels;
    return random_lamp(make_profile("bspline"), weighting, 7, shape);
}

// Proves that q = 0 is the exact sum, to the last bit, with its shares of images.
TEST(MipSum, IsTheExactSumAtQZero) {
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        const Slab slab = odd_lamp(weighting, 3);
        const PreparedSlab prepared = prepare(slab);
        const PreparedMips mips = prepare_mips(slab);
        const auto images = static_cast<std::size_t>(slab.image_count());
        std::vector<ReceiverF> receivers;
        for (const float height_m : {-0.1F, 0.0F, 0.3F, 10.0F})
            receivers.push_back({{0.01F, -0.02F, height_m}, {0.0F, 0.6F, -0.8F}});
        std::vector<glm::vec3> exact(receivers.size()), by_mips(receivers.size());
        std::vector<float> exact_y(images * receivers.size()), by_mips_y(exact_y.size());
        const std::uint64_t cost = irradiance(prepared, receivers, exact, exact_y);
        EXPECT_EQ(irradiance(mips, 0, receivers, by_mips, by_mips_y), cost);
        EXPECT_EQ(by_mips, exact);
        EXPECT_EQ(by_mips_y, exact_y);
    }
}

// Proves that no level gains or loses light, also where sizes are odd; in flux and, where the whole
// of S is seen through wide basis functions, texel by texel: the mean of four.
TEST(MipSum, LevelsKeepTheFluxAndTheTexelsPlaces) {
    const Slab slab = odd_lamp(Weighting::Irradiance, 3);
    const PreparedMips mips = prepare_mips(slab);
    ASSERT_EQ(mips.levels.size(), 7U);  // 37, 19, 10, 5, 3, 2, 1
    const glm::dvec3 light = flux(slab);
    glm::dvec2 texel_m = slab.texel_m();
    for (const PreparedSlab& level : mips.levels) {
        EXPECT_LE(glm::length(flux(level.slab) / light - 1.0), 1e-6);
        // A texel lies where its four were: from the same corner, twice as wide.
        EXPECT_EQ(level.slab.s_min_m, slab.s_min_m);
        EXPECT_LE(glm::length(level.slab.texel_m() - texel_m), 1e-15);
        texel_m *= 2.0;
    }
    EXPECT_EQ(mips.levels.back().slab.texels, glm::ivec2(1));
}

// Proves the rule: at most q texels, more than q / 2, the finest such level; counted here from the
// rays through the ends of a basis function's support.
TEST(MipSum, TakesTheFinestLevelWhoseWindowSpansQTexels) {
    const PreparedMips mips = prepare_mips(reference_lamp());
    const Slab& slab = mips.levels[0].slab;
    const auto window_texels = [&](const ReceiverF& receiver, int level) {
        const double z_m = static_cast<double>(receiver.position_m.z);
        const double half_m = 1.5 * slab.pitch_m.x;
        const auto s_m = [&](double u_m) {  // s on the ray from u to p
            return u_m + (static_cast<double>(receiver.position_m.x) - u_m) * slab.delta_m /
                             (slab.delta_m + z_m);
        };
        return std::abs(s_m(half_m) - s_m(-half_m)) / (slab.texel_m().x * std::exp2(level));
    };
    for (const float height_m : {-0.15F, -0.02F, -1e-6F, 0.0F, 0.01F, 0.2F, 1.0F, 6.0F, 1e5F})
        for (const int q : {1, 2, 3, 8, 12, 16, 100}) {
            const ReceiverF receiver{{0.3F, 0.0F, height_m}, {0, 0, -1}};
            const int level = level_for(mips, receiver, q);
            EXPECT_LE(window_texels(receiver, level), q) << height_m << ", " << q;
            if (level > 0) {
                EXPECT_GT(window_texels(receiver, level), 0.5 * q) << height_m << ", " << q;
            }
        }
    // Behind U and just above it, where windows are wider than S.
    EXPECT_EQ(level_for(mips, {{0, 0, -1.0F}, {0, 0, -1}}, 8), 0);
    EXPECT_EQ(level_for(mips, {{0, 0, -0.1999999F}, {0, 0, -1}}, 8), 5);  // 256 texels in 8
    EXPECT_EQ(level_for(mips, {{0, 0, 1.0F}, {0, 0, -1}}, 0), 0);
}

struct Bias {
    double rms = 0, texels = 0;
    std::vector<double> error_per_difference;  // rising
    double share_within(double limit) const {
        const auto end = std::ranges::upper_bound(error_per_difference, limit);
        return static_cast<double>(end - error_per_difference.begin()) /
               static_cast<double>(error_per_difference.size());
    }
};

// What the 300 receivers truly get.
struct Truth {
    std::vector<ReceiverF> receivers;
    std::vector<double> light;
};

Truth truth_of(const PreparedMips& mips) {
    Truth truth;
    for (const Receiver& receiver : reference_receivers()) {
        truth.receivers.push_back(as_float(receiver));
        truth.light.push_back(irradiance(mips.levels[0].slab, as_double(truth.receivers.back())).x);
    }
    return truth;
}

// Errors over the receivers whose light exceeds 1e-3 of the brightest's.
Bias bias_on(const PreparedMips& mips, const Truth& truth, int q) {
    const auto& [receivers, light] = truth;
    const double least = 1e-3 * *std::ranges::max_element(light);
    Bias bias;
    double squares = 0.0, count = 0.0;
    for (std::size_t k = 0; k < light.size(); ++k) {
        glm::vec3 at_q(0.0F), at_2q(0.0F);
        const std::uint64_t cost = irradiance(mips, q, {&receivers[k], 1}, {&at_q, 1});
        irradiance(mips, 2 * q, {&receivers[k], 1}, {&at_2q, 1});
        bias.texels += static_cast<double>(cost) / 2.0 / static_cast<double>(light.size());
        if (!(light[k] > least))
            continue;
        const double error = std::abs(static_cast<double>(at_q.x) - light[k]);
        const double difference = std::abs(static_cast<double>(at_q.x - at_2q.x));
        squares += error * error / (light[k] * light[k]);
        count += 1.0;
        // Float's own rounding is not bias.
        if (error > 1e-5 * light[k])
            bias.error_per_difference.push_back(error / difference);
    }
    bias.rms = std::sqrt(squares / count);
    std::ranges::sort(bias.error_per_difference);
    return bias;
}

// Proves bias and cost that the header states, and by what part |E_q - E_2q| bounds the error. One
// lamp: another's fine structure decides its own figures.
TEST(MipSum, BiasOnTheReferenceLampIsAsStated) {
    const PreparedMips mips = prepare_mips(reference_lamp());
    const Truth truth = truth_of(mips);
    struct Stated {
        int q;
        double rms, texels, within;  // texels: of windows with their dark borders skipped
    };
    for (const Stated& stated : {Stated{16, 0.016, 11400, 0.999}, Stated{12, 0.035, 6950, 0.99},
                                 Stated{8, 0.081, 3340, 0.99}, Stated{4, 0.452, 1105, 0.65}}) {
        const Bias bias = bias_on(mips, truth, stated.q);
        EXPECT_NEAR(bias.rms / stated.rms, 1.0, 0.02) << stated.q;
        EXPECT_NEAR(bias.texels / stated.texels, 1.0, 0.01) << stated.q;
        EXPECT_GE(bias.share_within(kBiasPerDifference), stated.within) << stated.q;
        // Without the factor it would be no bound, but for the level below which all is exact.
        if (stated.q <= 8) {
            EXPECT_LT(bias.share_within(1.0), 0.1) << stated.q;
        }
        const std::string q = std::to_string(stated.q);
        RecordProperty("q" + q + "_rms_1e-6", std::to_string(bias.rms * 1e6));
        RecordProperty("q" + q + "_texels", std::to_string(bias.texels));
    }
    PreparedMips bilinear = mips;
    for (PreparedSlab& level : bilinear.levels) {
        level.slab.profile = make_profile("bilinear");
        level = prepare(std::move(level.slab));
    }
    EXPECT_GE(bias_on(bilinear, truth_of(bilinear), 8).share_within(kBiasPerDifference), 0.95);
}

// Proves that radiance weighting has no more bias than irradiance weighting, though its coarse
// texels are wider than one node integrates to 1e-4.
TEST(MipSum, BiasIsNoLargerWithRadianceWeighting) {
    Slab slab = reference_lamp();
    slab.weighting = Weighting::Radiance;
    const PreparedMips mips = prepare_mips(std::move(slab));
    const Truth truth = truth_of(mips);
    EXPECT_LE(bias_on(mips, truth, 16).rms, 0.0165);
    EXPECT_LE(bias_on(mips, truth, 8).rms, 0.083);
    // 0.3 m away texels of level 2 are 0.026 wide in tangents: pieces in double count no
    // multiply-adds.
    const ReceiverF near{{0.0F, 0.0F, 0.3F}, {0.0F, 0.0F, -1.0F}};
    glm::vec3 result(0.0F);
    EXPECT_EQ(level_for(mips, near, 4), 2);
    EXPECT_GT(irradiance(mips, 4, {&near, 1}, {&result, 1}), 0U);
}

}  // namespace
}  // namespace nearfield::model
