// SPDX-License-Identifier: Apache-2.0
#include "acquire/gcode_stage.h"

#include "tests/devices/test_lab.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nearfield::devices {
namespace {

using acquire::DeviceLost;
using acquire::GcodeStage;
using testing::HasSubstr;

class Stage : public testing::Test {
  protected:
    Stage() { lab_.stage.speed_up = 50; }

    static glm::dvec2 move(GcodeStage& stage, glm::dvec2 to_mm) {
        return stage.move_to(to_mm, 3000, 0.02, never);
    }

    VirtualLab lab_{test_bench(), test_mounting(), true};
};

TEST_F(Stage, HomesAndMovesTheFilter) {
    GcodeStage stage("/dev/ttyUSB0", never);
    EXPECT_EQ(stage.version(), "Grbl 1.1h");
    EXPECT_EQ(stage.status().state, "Idle");
    for (const glm::ivec2 position : {glm::ivec2(0, 0), {4, 3}, {2, 1}}) {
        const glm::dvec2 target_mm = kFirst_mm + kPitch_mm * glm::dvec2(position);
        EXPECT_LT(glm::length(move(stage, target_mm) - target_mm), 0.001);
        EXPECT_EQ(lab_.state.stage().filter, position);
    }
}

TEST_F(Stage, OpensAgainWhateverItDidBefore) {
    for (int k = 0; k < 3; ++k) {
        GcodeStage stage("/dev/ttyUSB0", never);
        EXPECT_EQ(stage.status().position_mm, glm::dvec2(-1));
        move(stage, {-50, -50});
    }
}

TEST_F(Stage, TargetsBeyondItsTravelAreRefused) {
    {
        GcodeStage stage("/dev/ttyUSB0", never);
        EXPECT_THAT(complaint<Error>([&] { move(stage, {-301, -5}); }), HasSubstr("within 300 mm"));
        // Within its length, but on the other side of the switch: the controller's own limit.
        EXPECT_THAT(complaint<Error>([&] { move(stage, {20, -5}); }), HasSubstr("ALARM:2"));
        // Locked until somebody homes it.
        EXPECT_THAT(complaint<Error>([&] { move(stage, {-20, -5}); }), HasSubstr("error:9"));
    }
    GcodeStage again("/dev/ttyUSB0", never);
    move(again, {-20, -5});
}

TEST_F(Stage, SaysThatItDoesNotFindItsSwitch) {
    lab_.stage.faults.fails_homing = true;
    EXPECT_THAT(complaint<Error>([] { GcodeStage("/dev/ttyUSB0", never); }),
                HasSubstr("homing did not find the switch"));
}

TEST_F(Stage, SaysThatItHitASwitch) {
    GcodeStage stage("/dev/ttyUSB0", never);
    lab_.stage.faults.switch_at_mm = -60;
    EXPECT_THAT(complaint<Error>([&] {
                    move(stage, {-100, -5});
                }),
                HasSubstr("ALARM:1 (a limit switch was hit"));
}

TEST_F(Stage, ReadsBackWhereItStands) {
    GcodeStage stage("/dev/ttyUSB0", never);
    lab_.stage.faults.lost_steps_mm = 0.5;
    EXPECT_THAT(complaint<Error>([&] { move(stage, {-50, -5}); }), HasSubstr("-50.500, -5.000"));
}

TEST_F(Stage, CtrlCStopsAMove) {
    GcodeStage stage("/dev/ttyUSB0", never);
    lab_.stage.faults.is_stuck = true;
    int looks = 0;
    EXPECT_THROW(stage.move_to({-50, -5}, 3000, 0.02, [&looks] { return ++looks > 4; }),
                 acquire::Stopped);
    EXPECT_EQ(stage.status().state, "Hold");
}

TEST_F(Stage, SilentItIsLost) {
    GcodeStage stage("/dev/ttyUSB0", never);
    lab_.stage.faults.is_silent = true;
    EXPECT_THAT(complaint<DeviceLost>([&] { stage.status(); }), HasSubstr("does not answer"));
}

TEST_F(Stage, UnpluggedItIsLostAndPluggedInItHomesAgain) {
    {
        GcodeStage stage("/dev/ttyUSB0", never);
        lab_.stage.unplug();
        EXPECT_THAT(complaint<DeviceLost>([&] { stage.status(); }), HasSubstr("/dev/ttyUSB0"));
    }
    lab_.stage.plug_in();
    GcodeStage again("/dev/ttyUSB0", never);
    EXPECT_EQ(again.status().position_mm, glm::dvec2(-1));
    move(again, {-50, -50});
}

TEST_F(Stage, TwoProgramsDoNotShareALine) {
    const GcodeStage stage("/dev/ttyUSB0", never);
    EXPECT_THAT(complaint<Error>([] { GcodeStage("/dev/ttyUSB0", never); }),
                HasSubstr("another has it"));
}

TEST_F(Stage, ALineThatIsNotThereIsLost) {
    EXPECT_THROW(GcodeStage("/dev/ttyUSB7", never), DeviceLost);
}

TEST(StageStatus, IsReadInAllItsForms) {
    const auto status =
        acquire::gcode_status_from("<Hold:0|MPos:-1.500,2.250,0.000|Bf:15,128>", "");
    EXPECT_EQ(status.state, "Hold");
    EXPECT_EQ(status.position_mm, glm::dvec2(-1.5, 2.25));
    for (const char* wrong :
         {"", "<>", "<Idle>", "<Idle|MPos:>", "<Idle|MPos:1>", "Idle|MPos:1,2", "<Idle|MPos:a,b>"})
        EXPECT_THROW(acquire::gcode_status_from(wrong, ""), Error) << wrong;
}

}  // namespace
}  // namespace nearfield::devices
