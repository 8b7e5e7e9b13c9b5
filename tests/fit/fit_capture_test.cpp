// SPDX-License-Identifier: Apache-2.0
// From frames to a light field on a bench that is known exactly, and what is refused.
#include "fit/fit_capture.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "tests/fit/straight_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nearfield::fit {
namespace {

using testing::HasSubstr;

CaptureFitOptions coarse() {
    CaptureFitOptions options;
    options.texels = glm::ivec2(12, 9);
    options.lambda = 1e-6;
    return options;
}

struct Fitted {
    CaptureFit fit;
    double flux_rel = 0;  // against the lamp on the same extent
};

Fitted fitted(const StraightBench& bench, const CaptureFitOptions& options = coarse()) {
    const capture::Capture capture = take_capture(bench, "fit_capture");
    const rig::Rig rig = straight_rig(bench);
    const rig::Maps maps = straight_maps(bench);
    Fitted result;
    result.fit = fit_capture({"fit_capture", capture, rig, maps}, options);
    const Slab& slab = result.fit.lightfield.slabs.front();
    const LightField lamp = straight_lamp(bench);
    const Slab& whole = lamp.slabs.front();
    const glm::dvec2 seen = slab.s_max_m - slab.s_min_m, all = whole.s_max_m - whole.s_min_m;
    // The lamp's slope is odd about the middle, as is the extent.
    const double share = seen.x * seen.y / (all.x * all.y);
    result.flux_rel = model::luminance(model::flux(result.fit.lightfield)) /
                          (share * model::luminance(model::flux(lamp))) -
                      1;
    return result;
}

// Proves the whole way: exposures, geometry, filter, scale. Frames are rounded to a DN of 400.
TEST(FitCapture, FindsALampThatTheBasisHolds) {
    const Fitted result = fitted({});
    EXPECT_NEAR(result.flux_rel, 0, 2e-3);
    const LightField lamp = straight_lamp({});
    for (const glm::dvec2 at : {glm::dvec2(0, 0), glm::dvec2(0.2, -0.1), glm::dvec2(-0.3, 0.2)}) {
        const model::Receiver receiver{glm::dvec3(at, 2.0), {0, 0, -1}};
        EXPECT_NEAR(model::luminance(model::irradiance(result.fit.lightfield, receiver)) /
                        model::luminance(model::irradiance(lamp, receiver)),
                    1.0, 0.02)
            << at.x << " " << at.y;
    }
}

// Proves that light beside the filter is taken off where it was measured, and how much it would be.
TEST(FitCapture, TakesOffLightBesideTheFilter) {
    StraightBench bench;
    bench.beside_lx = 10;
    const Fitted with = fitted(bench);
    EXPECT_NEAR(with.flux_rel, 0, 3e-3);
    ASSERT_EQ(with.fit.beside_filter.size(), 1U);
    EXPECT_NEAR(with.fit.beside_filter[0].mean_lx, 10 / 0.5, 0.2);  // as through a peak of 1
    bench.has_blocked_frames = false;
    EXPECT_GT(fitted(bench).flux_rel, 0.02);
}

// Proves that the lamp's drift is followed by looks at the reference: 5 % left alone are 2.5 %.
TEST(FitCapture, FollowsTheLampsDrift) {
    StraightBench bench;
    bench.lamp_rise_rel = 0.05;
    const Fitted result = fitted(bench);
    EXPECT_GT(result.fit.drift_rel, 0.03);
    // The first look comes after the plate's frames, at a part of the rise.
    EXPECT_NEAR(result.flux_rel, 0, 5e-3);
}

// Proves that dark current is followed as the sensor warms, and light of the room is not let grow
// with it: either wrong way is more than 2 % of the flux.
TEST(FitCapture, FollowsDarkCurrentAndLeavesTheRoomAsItIs) {
    StraightBench bench;
    bench.current_dn_per_s = 400;
    bench.room_dn_per_s = 400;
    bench.sensor_rise_c = 7;
    EXPECT_NEAR(fitted(bench).flux_rel, 0, 3e-3);
}

// Proves what the page says of more positions: how well a half, two thirds, ... foretell the rest.
TEST(FitCapture, TellsWhatMorePositionsAreWorth) {
    const Fitted result = fitted({});
    const PositionShares& shares = result.fit.shares;
    ASSERT_EQ(shares.share.size(), 4U);
    EXPECT_EQ(shares.share.front(), 0.5);
    EXPECT_NEAR(shares.share.back(), 0.9, 1e-12);
    EXPECT_GT(shares.chi_square.back(), 0);
    EXPECT_LT(shares.chi_square.back(), 0.7 * shares.chi_square.front());
    EXPECT_GT(result.fit.capture_s, 20);  // a frame a second
}

// Proves that positions may be missing: they are counted, and the rest tells.
TEST(FitCapture, DoesWithoutAPosition) {
    StraightBench bench;
    bench.left_out = {{1, 0}, {4, 3}};
    const Fitted result = fitted(bench);
    EXPECT_EQ(result.fit.missing_positions, 2);
    EXPECT_NEAR(result.flux_rel, 0, 0.01);
}

// What a wrong measurement is told: part of the error's sentence and of its place.
template <typename Change>
void expect_refusal(const StraightBench& bench, const Change& change, const std::string& what) {
    const capture::Capture capture = take_capture(bench, "refused_capture");
    rig::Rig rig = straight_rig(bench);
    rig::Maps maps = straight_maps(bench);
    change(rig, maps);
    try {
        fit_capture({"refused_capture", capture, rig, maps}, coarse());
        FAIL() << "no error: " << what;
    } catch (const Error& error) {
        EXPECT_THAT(std::string(error.what()), HasSubstr(what));
    }
}

TEST(FitCapture, RefusesAnotherCapturesRig) {
    const auto is_wrong = [](const auto& change) {
        expect_refusal({}, change, "rig is not this capture's");
    };
    is_wrong([](rig::Rig& rig, rig::Maps&) { rig.lens->size_px.x += 2; });
    is_wrong([](rig::Rig& rig, rig::Maps&) { rig.radiometry->bits = 10; });
    is_wrong([](rig::Rig& rig, rig::Maps&) { rig.planes->grid = {4, 4}; });
    expect_refusal(
        {}, [](rig::Rig&, rig::Maps& maps) { maps.black_dn.pop_back(); }, "maps do not fit");
    expect_refusal(
        {}, [](rig::Rig& rig, rig::Maps&) { rig.planes.reset(); }, "the rig does not suffice");
}

TEST(FitCapture, RefusesTooFewPositions) {
    StraightBench bench;
    for (int k = 0; k < 17; ++k)
        bench.left_out.emplace_back(k % 5, k / 5);
    expect_refusal(
        bench, [](rig::Rig&, rig::Maps&) {}, "too few positions");
}

TEST(FitCapture, RefusesAFilterThatIsNotKnown) {
    expect_refusal(
        {}, [](rig::Rig& rig, rig::Maps&) { rig.radiometry->filter_profile.cells.clear(); },
        "the filter's profile is not known");
}

TEST(FitCapture, RefusesWhereAllIsSaturatedOrDark) {
    StraightBench bench;
    bench.brightness = 1e6;
    expect_refusal(
        bench, [](rig::Rig&, rig::Maps&) {}, "saturated");
    bench.brightness = 0;
    expect_refusal(
        bench, [](rig::Rig&, rig::Maps&) {}, "no light");
}

TEST(FitCapture, RefusesNumbersThatAreNone) {
    expect_refusal(
        {}, [](rig::Rig&, rig::Maps& maps) { maps.black_dn[700] = std::nanf(""); },
        "black_dn at pixel (28, 14)");
}

}  // namespace
}  // namespace nearfield::fit
