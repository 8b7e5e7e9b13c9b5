// SPDX-License-Identifier: Apache-2.0
// Mixing, reading and developing of rendered light, on frames made by hand.
#include "app/viewer/light.h"

#include "app/viewer/develop.h"
#include "app/viewer/view.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::viewer {
namespace {

constexpr glm::ivec2 kSize(4, 3);

std::shared_ptr<const LampLight> light_of(int lamp, double dim, float value) {
    LampLight light;
    light.lamp = lamp;
    light.dim = dim;
    for (int k = 0; k < kSize.x * kSize.y; ++k) {
        const float at = value * static_cast<float>(k + 1);
        light.radiance.insert(light.radiance.end(), {at, 2.0F * at, 3.0F * at});
        light.irradiance.insert(light.irradiance.end(), {4.0F * at, 4.0F * at, 4.0F * at});
        light.sigma.push_back(0.1F * at);
    }
    return std::make_shared<const LampLight>(light);
}

Frame two_lamps() {
    Frame frame;
    frame.size_px = kSize;
    frame.camera = look_at({0, 0, 0}, {0, 0, 1}, 0.9).camera;
    frame.lamps = {light_of(7, 0.5, 1.0F), light_of(9, 1.0, 0.25F)};
    frame.depth_m.assign(12, 2.0F);
    frame.depth_m[0] = 0.0F;
    return frame;
}

Document document_with(double dim, glm::vec3 tint, bool is_second_on) {
    Document document;
    document.scene = std::make_shared<const Scene>();
    EditedLamp first{7, {}}, second{9, {}};
    first.luminaire.dim = dim;
    first.luminaire.tint = tint;
    second.luminaire.on = is_second_on;
    document.lamps = {first, second};
    return document;
}

TEST(ViewerLight, AsRenderedItIsTheSumBitByBit) {
    const Frame frame = two_lamps();
    const Mixed mixed = mix(frame, gains_of(frame, document_with(0.5, glm::vec3(1.0F), true)));
    for (std::size_t k = 0; k < mixed.radiance.size(); ++k)
        EXPECT_EQ(mixed.radiance[k], frame.lamps[0]->radiance[k] + frame.lamps[1]->radiance[k]);
}

TEST(ViewerLight, DimTintAndSwitchAreFactors) {
    const Frame frame = two_lamps();
    const glm::vec3 tint(1.0F, 0.5F, 0.0F);
    const Mixed mixed = mix(frame, gains_of(frame, document_with(1.5, tint, false)));
    for (std::size_t k = 0; k < 12; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_FLOAT_EQ(mixed.radiance[3 * k + c],
                            3.0F * tint[static_cast<int>(c)] * frame.lamps[0]->radiance[3 * k + c]);
            EXPECT_FLOAT_EQ(mixed.irradiance[3 * k + c], 3.0F * tint[static_cast<int>(c)] *
                                                             frame.lamps[0]->irradiance[3 * k + c]);
        }
    EXPECT_FLOAT_EQ(mixed.sigma[11], 3.0F * frame.lamps[0]->sigma[11]);
}

TEST(ViewerLight, OneLampAloneAndLampsThatAreGone) {
    const Frame frame = two_lamps();
    Document document = document_with(0.5, glm::vec3(1.0F), true);
    const Mixed alone = mix(frame, gains_of(frame, document, 9));
    EXPECT_EQ(alone.radiance, frame.lamps[1]->radiance);
    document.lamps.pop_back();
    EXPECT_EQ(mix(frame, gains_of(frame, document)).radiance, frame.lamps[0]->radiance);
}

TEST(ViewerLight, SigmasAddInSquares) {
    const Frame frame = two_lamps();
    const Mixed mixed = mix(frame, gains_of(frame, document_with(0.5, glm::vec3(1.0F), true)));
    EXPECT_FLOAT_EQ(mixed.sigma[3], std::hypot(0.4F, 0.1F));
}

TEST(ViewerLight, ReadingsAreWhereThePixelIs) {
    const Frame frame = two_lamps();
    const Mixed mixed = mix(frame, gains_of(frame, document_with(0.5, glm::vec3(1.0F), false)));
    const Reading reading = reading_at(frame, mixed, {3, 2});
    EXPECT_NEAR(reading.irradiance_y, 48.0, 1e-4);
    EXPECT_NEAR(reading.position_world_m.z, 2.0, 1e-9);  // depth is along the axis
    const auto at = projected(frame.camera, kSize, reading.position_world_m);
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->x, 3.5, 1e-9);
    EXPECT_NEAR(at->y, 2.5, 1e-9);
    EXPECT_EQ(reading_at(frame, mixed, {0, 0}).depth_m, 0.0);
}

TEST(ViewerLight, RegionsLeaveOutWhatIsNotSeen) {
    const Frame frame = two_lamps();
    const Mixed mixed = mix(frame, gains_of(frame, document_with(0.5, glm::vec3(1.0F), false)));
    const RegionStatistics found = statistics_of(frame, mixed, {1, 1}, {0, 0});
    EXPECT_EQ(found.pixels, 3U);  // of four; k = 1, 4, 5: 4 (k + 1) lx
    EXPECT_NEAR(found.least, 8.0, 1e-5);
    EXPECT_NEAR(found.largest, 24.0, 1e-5);
    EXPECT_NEAR(found.mean, 52.0 / 3.0, 1e-5);
    EXPECT_NEAR(found.uniformity, 8.0 * 3.0 / 52.0, 1e-6);
}

TEST(ViewerDevelop, PictureIsTheToneMappersBitByBit) {
    const Frame frame = two_lamps();
    const Mixed mixed = mix(frame, gains_of(frame, document_with(0.5, glm::vec3(1.0F), true)));
    const Developed developed = develop(frame, mixed, {});
    const render::Display display =
        render::display({kSize, {{"", {"R", "G", "B"}, mixed.radiance}}, {}}, {});
    EXPECT_EQ(developed.exposure_ev, display.exposure_ev);
    for (std::size_t k = 0; k < 12; ++k)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ(developed.rgba[4 * k + c], display.srgb[3 * k + c]);
}

TEST(ViewerDevelop, ScaleRisesAndEndsWhereItSays) {
    EXPECT_EQ(scale_position(0.0, 1.0, 100.0), 0.0);
    EXPECT_EQ(scale_position(1.0, 1.0, 100.0), 0.0);
    EXPECT_NEAR(scale_position(10.0, 1.0, 100.0), 0.5, 1e-12);
    EXPECT_EQ(scale_position(1e6, 1.0, 100.0), 1.0);
    EXPECT_NE(scale_color(0.3), scale_color(0.7));
}

TEST(ViewerDevelop, IsoluxLinesRunWhereALevelIsPassed) {
    const Frame frame = two_lamps();
    const Mixed mixed = mix(frame, gains_of(frame, document_with(0.5, glm::vec3(1.0F), false)));
    Look look;
    look.shown = Shown::Lux;
    look.isolux.fill(22.0);  // between k = 4 (20 lx) and k = 5 (24 lx)
    look.has_isolux = true;
    const Developed with = develop(frame, mixed, look);
    look.has_isolux = false;
    const Developed without = develop(frame, mixed, look);
    const auto differs = [&](std::size_t k) {
        return with.rgba[4 * k] != without.rgba[4 * k] ||
               with.rgba[4 * k + 1] != without.rgba[4 * k + 1] ||
               with.rgba[4 * k + 2] != without.rgba[4 * k + 2];
    };
    EXPECT_TRUE(differs(4));   // its right neighbor is above
    EXPECT_TRUE(differs(1));   // the pixel below is above
    EXPECT_FALSE(differs(8));  // all around are above
    EXPECT_FALSE(differs(7));
}

TEST(ViewerDevelop, SplitShowsBothSides) {
    Developed left{{2, 1}, {10, 10, 10, 255, 20, 20, 20, 255}, 0.0};
    Developed right{{4, 1}, std::vector<unsigned char>(16, 99), 0.0};
    const Developed both = beside(left, right, 0.75);
    EXPECT_EQ(both.rgba[0], 10);
    EXPECT_EQ(both.rgba[4], 10);
    EXPECT_EQ(both.rgba[8], 20);    // the left one's second pixel is as wide as two
    EXPECT_EQ(both.rgba[12], 255);  // the line
    EXPECT_EQ(beside(left, right, 0.0).rgba[4], 99);
}

TEST(ViewerDevelop, DifferenceOfEqualsIsNothing) {
    const Frame frame = two_lamps();
    const Mixed mixed = mix(frame, gains_of(frame, document_with(0.5, glm::vec3(1.0F), true)));
    EXPECT_EQ(difference_of(mixed, mixed).lab, 0.0);
    Mixed brighter = mixed;
    for (float& value : brighter.radiance)
        value *= 1.1F;
    EXPECT_NEAR(difference_of(brighter, mixed).rms_rel, 0.1, 1e-5);
}

}  // namespace
}  // namespace nearfield::viewer
