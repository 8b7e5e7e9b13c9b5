// SPDX-License-Identifier: Apache-2.0
// The windowed sum by OpenGL against the sum in double, which tests/model proves against an oracle
// of its own, at the very receivers in float.
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "sample_data/reference_lamp.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/gpu/sum_run.h"
#include "tests/support/lamps.h"
#include "tests/support/receivers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::render::gpu {
namespace {

using support::all_profiles;
using support::as_double;
using support::as_float;
using support::hard_receivers;
using support::HardReceiver;
using support::kHardHeights;
using support::LampShape;
using support::random_lamp;

// What light_sum.h states, and of which light: float's sums end where planes all but miss U.
constexpr double kStated = 1e-4;
constexpr double kOfLargest = 1e-3;

constexpr Weighting kWeightings[] = {Weighting::Irradiance, Weighting::Radiance};

class LightSum : public GlTest {
  protected:
    std::vector<glm::vec4> irradiance(const Slab& slab,
                                      std::span<const model::ReceiverF> receivers) {
        std::vector<SumSlab> slabs;
        slabs.push_back(upload_sum_slab(device(), model::prepare(slab), slab.channels == 3, {}));
        return run_sum(device(), programs_, slabs, receivers).irradiance;
    }

    // Returns the largest relative error.
    double expect_close(const Slab& slab,
                        std::span<const model::ReceiverF> receivers,
                        const std::string& where) {
        const std::vector<glm::vec4> got = irradiance(slab, receivers);
        std::vector<glm::dvec3> expected;
        double largest = 0.0, worst = 0.0;
        for (const model::ReceiverF& receiver : receivers) {
            expected.push_back(model::irradiance(slab, as_double(receiver)));
            largest = std::max(largest, model::luminance(expected.back()));
        }
        for (std::size_t k = 0; k < receivers.size(); ++k) {
            EXPECT_EQ(got[k].a, 0.0F) << where;  // nothing is left over
            for (int c = 0; c < 3; ++c) {
                EXPECT_TRUE(std::isfinite(got[k][c]) && got[k][c] >= 0.0F)
                    << where << ": " << got[k][c];
                if (expected[k][c] > kOfLargest * largest)
                    worst = std::max(worst, std::abs(got[k][c] / expected[k][c] - 1.0));
            }
        }
        EXPECT_LE(worst, kStated) << where;
        return worst;
    }

    LightSumPrograms programs_;
};

std::vector<model::ReceiverF> receivers_at(const Slab& slab, double height_per_delta) {
    std::vector<model::ReceiverF> receivers;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        for (const HardReceiver& hard : hard_receivers(slab, height_per_delta, seed))
            receivers.push_back(as_float(hard.receiver));
    return receivers;
}

TEST_F(LightSum, IsCloseForEveryProfileWeightingHeightAndKindOfReceiver) {
    std::uint64_t seed = 300;
    for (const Weighting weighting : kWeightings) {
        double worst = 0.0;
        for (const Profile& profile : all_profiles()) {
            LampShape shape;
            shape.channels = ++seed % 2 == 0 ? 3 : 1;
            const Slab slab = random_lamp(profile, weighting, seed, shape);
            for (const double height : kHardHeights)
                worst =
                    std::max(worst, expect_close(slab, receivers_at(slab, height),
                                                 profile.name + " at " + std::to_string(height)));
        }
        RecordProperty(weighting == Weighting::Irradiance ? "irradiance_1e-9" : "radiance_1e-9",
                       std::to_string(1e9 * worst));
    }
}

TEST_F(LightSum, IsCloseOnTheReferenceLamp) {
    const Slab slab = sample_data::make_reference_lamp().slabs[0];
    std::vector<model::ReceiverF> receivers;
    for (const model::Receiver& receiver : sample_data::reference_receivers())
        receivers.push_back(as_float(receiver));
    RecordProperty("1e-9", std::to_string(1e9 * expect_close(slab, receivers, "reference lamp")));
}

// One image, one texel, widths that no quad divides, one row or column.
TEST_F(LightSum, IsCloseForOddShapes) {
    const glm::ivec2 grids[] = {{1, 1}, {1, 4}, {5, 1}, {2, 3}};
    const glm::ivec2 texel_counts[] = {{1, 1}, {1, 9}, {17, 1}, {3, 2}, {65, 48}};
    std::uint64_t seed = 900;
    for (const glm::ivec2 grid : grids)
        for (const glm::ivec2 texels : texel_counts) {
            LampShape shape;
            shape.grid = grid;
            shape.texels = texels;
            shape.dark_fraction = 0.0;
            ++seed;
            const Slab slab = random_lamp(model::make_profile(seed % 2 == 0 ? "bspline" : "box"),
                                          kWeightings[seed / 2 % 2], seed, shape);
            for (const double height : {-0.9, 0.0, 1.0})
                expect_close(slab, receivers_at(slab, height),
                             "case " + std::to_string(seed) + " at " + std::to_string(height));
        }
}

TEST_F(LightSum, IsCloseWhereLittleIsLit) {
    const auto lit_where = [](const auto& is_lit) {
        LampShape shape;
        shape.dark_fraction = 0.0;
        Slab slab = random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 4, shape);
        for (std::size_t k = 0; k < slab.coeffs.size(); ++k)
            if (!is_lit(static_cast<int>(k % slab.texel_count()) % slab.texels.x,
                        static_cast<int>(k % slab.texel_count()) / slab.texels.x))
                slab.coeffs[k] = 0.0F;
        return slab;
    };
    const auto expect = [&](const std::string& what, const Slab& slab) {
        for (const double height : {-0.5, 0.0, 0.3, 30.0})
            expect_close(slab, receivers_at(slab, height), what + " at " + std::to_string(height));
    };
    expect("all dark", lit_where([](int, int) { return false; }));
    expect("one texel", lit_where([](int i, int j) { return i == 11 && j == 9; }));
    expect("one row", lit_where([](int, int j) { return j == 10; }));
    expect("one column", lit_where([](int i, int) { return i == 12; }));
    expect("the last column", lit_where([](int i, int) { return i == 23; }));
}

TEST_F(LightSum, IsZeroBehindUAndFiniteAtU) {
    for (const Weighting weighting : kWeightings) {
        const Slab slab = random_lamp(model::make_profile("bspline"), weighting, 52);
        const auto delta_m = static_cast<float>(slab.delta_m);
        std::vector<model::ReceiverF> behind, at;
        for (const glm::vec3 normal :
             {glm::vec3(0, 0, -1), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0)}) {
            for (const float far : {1e-6F, 0.1F, 1.0F, 1e6F})
                behind.push_back({{0.01F, 0.0F, -delta_m * (1.0F + far)}, normal});
            for (const float z_m : {-delta_m, std::nextafter(-delta_m, 0.0F)})
                at.push_back({{0.01F, 0.0F, z_m}, normal});
        }
        for (const glm::vec4 light : irradiance(slab, behind))
            EXPECT_EQ(light, glm::vec4(0.0F));
        for (const glm::vec4 light : irradiance(slab, at))
            EXPECT_TRUE(std::isfinite(light.x) && light.x >= 0.0F) << light.x;
    }
}

// Windows so large that no dispatch may do them at once: llvmpipe would end loops early, and other
// drivers take too long.
TEST_F(LightSum, DoesInManyDispatchesWhatOneMayNot) {
    LampShape shape;
    shape.grid = {3, 9};
    shape.texels = {250, 260};
    shape.decades = 1;
    shape.pitch_m = {0.05, 0.03};
    const Slab slab = random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 8, shape);
    std::vector<model::ReceiverF> receivers;
    for (const glm::vec3 normal : {glm::vec3(0, 0, -1), glm::vec3(0, 0.8, -0.6)})
        for (const float x_m : {-0.03F, 0.02F})
            receivers.push_back({{x_m, 0.01F, -0.17F}, normal});
    expect_close(slab, receivers, "large windows");
}

}  // namespace
}  // namespace nearfield::render::gpu
