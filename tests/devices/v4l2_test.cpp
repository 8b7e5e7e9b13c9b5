// SPDX-License-Identifier: Apache-2.0
#include "acquire/v4l2_camera.h"
#include "acquire/v4l2_device.h"
#include "tests/devices/large_frames.h"
#include "tests/devices/test_lab.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nearfield::devices {
namespace {

using acquire::Bench;
using acquire::DeviceBusy;
using acquire::DeviceLost;
using acquire::IncompleteFrame;
using acquire::Patience;
using acquire::until_free;
using testing::AllOf;
using testing::HasSubstr;

class V4l2 : public testing::Test {
  protected:
    static Bench open(const capture::CameraPlan& plan = {}) {
        Bench bench = acquire::open_v4l2("/dev/video0");
        bench.camera->configure(plan);
        bench.camera->set_exposure(20000);
        return bench;
    }

    VirtualLab lab_{test_bench(), test_mounting(), true};
};

TEST_F(V4l2, IsFoundByName) {
    const auto found = acquire::find_v4l2_cameras();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].id, "/dev/video0");
    EXPECT_EQ(found[0].protocol, "V4L2");
    EXPECT_EQ(found[0].model, "nearfield virtual bench");
}

TEST_F(V4l2, AFrameIsTheSensorsOwn) {
    const Bench bench = open();
    lab_.state.set_lamp(true, 12);
    const acquire::Exposed exposed = bench.camera->expose(never);
    EXPECT_EQ(exposed.frame.size_px, kSensorPx);
    EXPECT_EQ(exposed.frame.bits, 12);
    EXPECT_EQ(exposed.pixel_format, "Mono12");
    EXPECT_EQ(exposed.frame.values, test_frame({0, 20000, 0, 0, lab_.state.stage()}));
}

// The other formats hold the sensor's 12 bits shifted.
TEST_F(V4l2, FormatsAreNegotiated) {
    for (const auto& [name, bits] : {std::pair{"Mono8", 8}, {"Mono10", 10}, {"Mono16", 16}}) {
        capture::CameraPlan plan;
        plan.pixel_format = name;
        const Bench bench = open(plan);
        lab_.state.set_shot(1);
        const acquire::Exposed exposed = bench.camera->expose(never);
        EXPECT_EQ(exposed.frame.bits, bits);
        const std::vector<std::uint16_t> truth = test_frame({0, 20000, 0, 0, lab_.state.stage()});
        for (std::size_t k = 0; k < truth.size(); k += 100)
            EXPECT_EQ(exposed.frame.values[k],
                      bits < 12 ? truth[k] >> (12 - bits) : truth[k] << (bits - 12));
    }
}

TEST_F(V4l2, WhatItDoesNotOfferIsRefused) {
    capture::CameraPlan plan;
    plan.pixel_format = "BayerRG12";
    EXPECT_THAT(complaint<Error>([&] { open(plan); }), HasSubstr("one of 'Y12 '"));
    plan = {};
    plan.region_size_px = {32, 32};
    EXPECT_THAT(complaint<Error>([&] { open(plan); }), HasSubstr("width, px"));
    plan = {};
    plan.gain_db = 3;
    EXPECT_THAT(complaint<Error>([&] { open(plan); }), HasSubstr("camera.controls"));
    plan = {};
    plan.controls = {{"gian", 3}};
    EXPECT_THAT(complaint<Error>([&] { open(plan); }), HasSubstr("gain"));
    plan.controls = {{"gain", 300}};
    EXPECT_THAT(complaint<Error>([&] { open(plan); }), HasSubstr("0 ... 24"));
}

TEST_F(V4l2, ExposureAndGainAreApplied) {
    capture::CameraPlan plan;
    plan.controls = {{"gain", 6}};
    const Bench bench = open(plan);
    EXPECT_EQ(acquire::V4l2Device("/dev/video0").value("auto_exposure"), V4L2_EXPOSURE_MANUAL);
    EXPECT_EQ(bench.camera->set_exposure(1234), 1200);  // steps of 100 us
    EXPECT_THAT(complaint<Error>([&] { bench.camera->set_exposure(2e7); }),
                HasSubstr("1 ... 100000"));
    bench.camera->set_exposure(5000);
    lab_.state.set_lamp(true, 12);
    EXPECT_EQ(bench.camera->expose(never).frame.values,
              test_frame({0, 5000, 6, 0, lab_.state.stage()}));
}

TEST_F(V4l2, PollThatSaysReadyWithNothingThereIsUsual) {
    const Bench bench = open();
    lab_.v4l2.faults.empty_polls = 30;
    for (int k = 0; k < 3; ++k)
        EXPECT_EQ(bench.camera->expose(never).frame.size_px, kSensorPx);
}

TEST_F(V4l2, FramesExposedBeforeTheyWereAskedForAreDropped) {
    const Bench bench = open();
    lab_.v4l2.faults.stale_frames = 3;
    EXPECT_EQ(bench.camera->expose(never).frame_id, 3U);
}

TEST_F(V4l2, BrokenAndShortFramesAreIncomplete) {
    const Bench bench = open();
    lab_.v4l2.faults.broken_frames = 1;
    EXPECT_THAT(complaint<IncompleteFrame>([&] { bench.camera->expose(never); }),
                HasSubstr("error flag"));
    lab_.v4l2.faults.short_frames = 1;
    EXPECT_THAT(complaint<IncompleteFrame>([&] { bench.camera->expose(never); }),
                HasSubstr("6144 bytes"));
    EXPECT_EQ(bench.camera->expose(never).frame.size_px, kSensorPx);
}

TEST_F(V4l2, CtrlCDoesNotWaitForASilentCamera) {
    const Bench bench = open();
    lab_.v4l2.faults.is_silent = true;
    int looks = 0;
    EXPECT_THROW(bench.camera->expose([&looks] { return ++looks > 2; }), acquire::Stopped);
}

TEST_F(V4l2, UnpluggedItIsLostAndPluggedInItWorksAgain) {
    {
        const Bench bench = open();
        lab_.v4l2.faults.is_gone = true;
        EXPECT_THAT(complaint<DeviceLost>([&] { bench.camera->expose(never); }),
                    HasSubstr("No such device"));
    }
    lab_.v4l2.faults.is_gone = false;
    EXPECT_EQ(open().camera->expose(never).frame.size_px, kSensorPx);
}

// Another program streams from it when we come, and lets go when it is told that we wait.
TEST_F(V4l2, ACameraThatAnotherProgramStillHasIsWaitedFor) {
    auto other = std::make_unique<Bench>(open());
    const Bench bench = acquire::open_v4l2("/dev/video0");
    const auto configure = [&bench] { bench.camera->configure({}); };
    EXPECT_THAT(complaint<DeviceBusy>(configure), HasSubstr("Device or resource busy"));
    std::vector<std::string> said;
    until_free(configure, Patience(acquire::kBusyPatience_s, never, [&](const std::string& remark) {
                   said.push_back(remark);
                   other.reset();
               }));
    EXPECT_EQ(bench.camera->expose(never).frame.size_px, kSensorPx);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_THAT(said[0], AllOf(HasSubstr("/dev/video0"), HasSubstr("waiting up to 10 s")));
}

TEST_F(V4l2, ABusyCameraIsNotWaitedForEndlessly) {
    const Bench other = open();
    const Bench bench = acquire::open_v4l2("/dev/video0");
    const auto configure = [&bench] { bench.camera->configure({}); };
    const auto say_nothing = [](const std::string&) {};
    EXPECT_THAT(complaint<DeviceBusy>([&] {
                    until_free(configure, {0.1, never, say_nothing});
                }),
                HasSubstr("free within 0.1 s"));
    EXPECT_THROW(until_free(configure, {60, [] { return true; }, say_nothing}), acquire::Stopped);
    EXPECT_EQ(other.camera->expose(never).frame.size_px, kSensorPx);  // undisturbed
}

TEST_F(V4l2, TheCamerasOwnControlsAreAPersonsWork) {
    const Bench bench = open();
    ASSERT_NE(bench.stage, nullptr);
    capture::Shot shot;
    shot.number = 41;
    shot.kind = capture::ShotKind::Target;
    shot.view = 2;
    bench.stage->arrange(shot, never);
    const gige::Stage stage = lab_.state.stage();
    EXPECT_EQ(stage.subject, gige::Subject::Target);
    EXPECT_EQ(stage.target_view, 2);
    EXPECT_EQ(stage.shot, 42U);
}

TEST(V4l2Names, AreThoseOfV4l2Ctl) {
    EXPECT_EQ(acquire::v4l2_control_name("Exposure Time, Absolute"), "exposure_time_absolute");
    EXPECT_EQ(acquire::v4l2_control_name("White Balance, Automatic"), "white_balance_automatic");
}

// Frames that cost nothing but their bytes, as fast as they come; the machine may be busy.
TEST(V4l2Throughput, IsSaid) {
    const VirtualLab lab(large_bench(), test_mounting(), true);
    RecordProperty("far_end_ms", std::to_string(1000 * far_end_s()));
    RecordProperty("frames_per_s",
                   std::to_string(large_frames_per_s(acquire::open_v4l2("/dev/video0"))));
}

}  // namespace
}  // namespace nearfield::devices
