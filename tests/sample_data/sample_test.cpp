// SPDX-License-Identifier: Apache-2.0
// The committed sample headlight_small: made again, and measured again.
#include "tests/sample_data/small_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace nearfield::sample_data {
namespace {

using support::small_options;

const std::string kSample = NEARFIELD_SOURCE_DIR "/sample_data/headlight_small.lightfield.exr";
const std::string kTruth = NEARFIELD_SOURCE_DIR "/sample_data/headlight_small.truth.json";

glm::dvec3 vector(const nlohmann::json& array) {
    return {array.at(0).get<double>(), array.at(1).get<double>(), array.at(2).get<double>()};
}

void expect_near(glm::dvec3 got, glm::dvec3 expected, double relative) {
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(got[c], expected[c], relative * std::abs(expected[c]) + 1e-12)
            << "channel " << c;
    }
}

TEST(SmallSample, IsWhatSimulateMakes) {
    // Proves that file and program belong together: geometry equal, coefficients to solver
    // tolerance of the brightest.
    constexpr float kTolerance =
        1e-5F;  // libm and compilers differ in last bits; the solver stops at 1e-7
    const LightField stored = read_lightfield(kSample);
    const LightField made = simulate_headlight(small_options(), {}).lightfield;
    const Slab &a = stored.slabs.at(0), &b = made.slabs.at(0);
    EXPECT_EQ(a.grid, b.grid);
    EXPECT_EQ(a.texels, b.texels);
    EXPECT_EQ(a.delta_m, b.delta_m);
    EXPECT_EQ(a.s_min_m, b.s_min_m);
    EXPECT_EQ(a.pitch_m, b.pitch_m);
    EXPECT_EQ(stored.provenance.options, made.provenance.options);
    ASSERT_EQ(a.coeffs.size(), b.coeffs.size());
    const float brightest = *std::max_element(b.coeffs.begin(), b.coeffs.end());
    for (std::size_t k = 0; k < a.coeffs.size(); ++k) {
        ASSERT_NEAR(a.coeffs[k], b.coeffs[k], kTolerance * brightest) << "coefficient " << k;
    }
}

TEST(SmallSample, GivesItsTruth) {
    // The model against stored brute force, and the formula against its stored values.
    constexpr double kTolerance = 1e-6;
    const LightField stored = read_lightfield(kSample);
    const Headlight headlight = make_headlight(small_options().seed);
    const double delta_m = stored.slabs.front().delta_m;
    nlohmann::json truth;
    std::ifstream(kTruth) >> truth;
    expect_near(model::flux(stored), vector(truth.at("flux_lm").at("lightfield")), kTolerance);
    expect_near(flux(headlight), vector(truth.at("flux_lm").at("formula")), kTolerance);
    ASSERT_EQ(truth.at("irradiance_lx").size(), 50U);
    for (const nlohmann::json& point : truth.at("irradiance_lx")) {
        model::Receiver receiver{vector(point.at("position_m")), vector(point.at("normal"))};
        expect_near(model::irradiance(stored, receiver), vector(point.at("lightfield")),
                    kTolerance);
        receiver.position_m.z += delta_m;
        expect_near(irradiance(headlight, receiver), vector(point.at("formula")), kTolerance);
    }
    for (const nlohmann::json& direction : truth.at("intensity_cd")) {
        const glm::dvec3 d = vector(direction.at("direction"));
        expect_near(model::intensity(stored, d), vector(direction.at("lightfield")), kTolerance);
        expect_near(intensity(headlight, d), vector(direction.at("formula")), kTolerance);
    }
}

}  // namespace
}  // namespace nearfield::sample_data
