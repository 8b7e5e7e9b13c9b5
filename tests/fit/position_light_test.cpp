// SPDX-License-Identifier: Apache-2.0
// The light of a position, pixel by pixel, and the lamp's drift.
#include "fit/position_light.h"

#include "tests/fit/straight_bench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::fit {
namespace {

struct Taken {
    explicit Taken(const StraightBench& bench)
        : capture(take_capture(bench, "position_light")),
          rig(straight_rig(bench)),
          maps(straight_maps(bench)) {}

    Measurement measurement() const { return {"position_light", capture, rig, maps}; }

    capture::Capture capture;
    rig::Rig rig;
    rig::Maps maps;
};

PositionFrames middle_of(const capture::Capture& capture) {
    for (const PositionFrames& position : positions_of(capture))
        if (position.position == glm::ivec2(2, 2))
            return position;
    return {};
}

constexpr std::size_t kPixel = 18 * 48 + 30;

// Proves that positions come row by row with all their exposures, and the plate's frames apart.
TEST(PositionLight, PositionsHaveTheirFrames) {
    StraightBench bench;
    bench.left_out = {{1, 0}};
    const Taken taken(bench);
    const std::vector<PositionFrames> positions = positions_of(taken.capture);
    ASSERT_EQ(positions.size(), 19U);
    EXPECT_EQ(positions[1].position, glm::ivec2(2, 0));
    for (const PositionFrames& position : positions)
        EXPECT_EQ(position.frames.size(), 2U);
    EXPECT_EQ(blocked_frames(taken.capture).frames.size(), 2U);
}

// Proves that a bad pixel is bridged by its neighbors: this bench's light is a straight line.
TEST(PositionLight, ABadPixelIsBridged) {
    Taken taken({});
    const MergedImage whole = position_light(taken.measurement(), middle_of(taken.capture),
                                             LampDrift(taken.measurement()));
    taken.maps.is_bad[kPixel] = 1.0F;
    const MergedImage bridged = position_light(taken.measurement(), middle_of(taken.capture),
                                               LampDrift(taken.measurement()));
    EXPECT_NEAR(bridged.light_dn_per_s[kPixel] / whole.light_dn_per_s[kPixel], 1.0, 2e-3);
    EXPECT_TRUE(std::isfinite(bridged.variance[kPixel]));
    EXPECT_EQ(bridged.bad_count, 1U);
    EXPECT_EQ(bridged.light_dn_per_s[kPixel + 100], whole.light_dn_per_s[kPixel + 100]);
}

// Proves that what is saturated in all exposures is unknown, not bright: light rises along x.
TEST(PositionLight, SaturatedPixelsAreUnknown) {
    StraightBench bench;
    bench.exposures_us = {385000, 770000};
    bench.drift_every = 0;  // looks would be saturated, too
    const Taken taken(bench);
    const MergedImage image = position_light(taken.measurement(), middle_of(taken.capture),
                                             LampDrift(taken.measurement()));
    ASSERT_GT(image.saturated_count, 0U);
    ASSERT_LT(image.saturated_count, image.variance.size());
    EXPECT_TRUE(std::isinf(image.variance[18 * 48 + 47]));
    EXPECT_TRUE(std::isfinite(image.variance[18 * 48]));
}

// Proves that the factor runs from look to look along time, and that all light is that of the
// first look.
TEST(PositionLight, TheLampsDriftIsFollowed) {
    StraightBench bench;
    bench.lamp_rise_rel = 0.05;
    const Taken taken(bench);
    const LampDrift drift(taken.measurement());
    EXPECT_EQ(drift.looks(), 4);
    double first = 0, worst = 0;
    const double count = static_cast<double>(capture::shots_of(*taken.capture.header.plan).size());
    for (const auto& [number, frame] : taken.capture.frames) {
        const double light = 1 + 0.05 * number / count;
        if (frame.shot.kind == capture::ShotKind::Reference && first == 0)
            first = light;
        // After the last look nothing is known of the lamp.
        if (first > 0 && frame.shot.position.y < 3)
            worst = std::max(worst, std::abs(drift.factor(frame) * first / light - 1));
    }
    EXPECT_LT(worst, 1e-3);  // frames are rounded to a DN of some 400
}

// Proves that a session without a look is taken as it is.
TEST(PositionLight, WithoutALookNothingIsKnownOfDrift) {
    const Taken taken({});
    capture::FrameRecord stranger = taken.capture.frames.begin()->second;
    stranger.session = 7;
    EXPECT_EQ(LampDrift(taken.measurement()).factor(stranger), 1.0);
}

}  // namespace
}  // namespace nearfield::fit
