// SPDX-License-Identifier: Apache-2.0
#include "acquire/aravis_camera.h"
#include "tests/devices/large_frames.h"
#include "tests/devices/test_lab.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nearfield::devices {
namespace {

using acquire::Bench;
using acquire::DeviceLost;
using testing::HasSubstr;

class Usb3Vision : public testing::Test {
  protected:
    static Bench open(const capture::CameraPlan& plan = {}) {
        Bench bench = acquire::open_aravis("NFU3V01");
        bench.camera->configure(plan);
        bench.camera->set_exposure(20000);
        return bench;
    }

    VirtualLab lab_{test_bench(), test_mounting(), true};
};

TEST_F(Usb3Vision, IsFound) {
    for (const acquire::FoundCamera& camera : acquire::find_cameras())
        if (camera.serial == "NFU3V01") {
            EXPECT_EQ(camera.protocol, "USB3Vision");
            EXPECT_EQ(camera.model, "VirtualBench");
            return;
        }
    FAIL() << "not found";
}

TEST_F(Usb3Vision, AFrameIsTheSensorsOwn) {
    const Bench bench = open();
    lab_.state.set_lamp(true, 12);
    for (std::uint64_t k = 0; k < 3; ++k) {
        const acquire::Exposed exposed = bench.camera->expose(never);
        EXPECT_EQ(exposed.pixel_format, "Mono12");
        EXPECT_EQ(exposed.frame.values, test_frame({k, 20000, 0, 0, lab_.state.stage()}));
    }
}

TEST_F(Usb3Vision, ARegionAndGainAreTaken) {
    capture::CameraPlan plan;
    plan.region_min_px = {8, 4};
    plan.region_size_px = {32, 20};
    plan.gain_db = 6;
    const Bench bench = open(plan);
    const acquire::Exposed exposed = bench.camera->expose(never);
    ASSERT_EQ(exposed.frame.size_px, plan.region_size_px);
    const std::vector<std::uint16_t> all = test_frame({0, 20000, 6, 0, lab_.state.stage()});
    EXPECT_EQ(exposed.frame.values[0], all[4 * 64 + 8]);
    EXPECT_EQ(exposed.frame.values.back(), all[23 * 64 + 39]);
}

TEST_F(Usb3Vision, ItsFeaturesAreAPersonsWork) {
    const Bench bench = open();
    ASSERT_NE(bench.stage, nullptr);
    capture::Shot shot;
    shot.number = 6;
    shot.kind = capture::ShotKind::Flat;
    bench.stage->arrange(shot, never);
    EXPECT_EQ(lab_.state.stage().subject, gige::Subject::Flat);
    EXPECT_EQ(lab_.state.stage().shot, 7U);
}

TEST_F(Usb3Vision, AShortFrameIsIncompleteAndTheNextIsWhole) {
    const Bench bench = open();
    lab_.u3v.faults.short_frames = 1;
    EXPECT_THROW(bench.camera->expose(never), acquire::IncompleteFrame);
    EXPECT_EQ(bench.camera->expose(never).frame.size_px, kSensorPx);
}

TEST_F(Usb3Vision, CtrlCDoesNotWaitForAFrameThatDoesNotCome) {
    const Bench bench = open();
    lab_.u3v.faults.is_frameless = true;
    int looks = 0;
    EXPECT_THROW(bench.camera->expose([&looks] { return ++looks > 2; }), acquire::Stopped);
}

// Aravis asks a few times, each with its time-out.
TEST_F(Usb3Vision, SilentItIsLost) {
    const Bench bench = open();
    lab_.u3v.faults.is_silent = true;
    EXPECT_THAT(complaint<Error>([&] { bench.camera->expose(never); }), HasSubstr("NFU3V01"));
    lab_.u3v.faults.is_silent = false;
}

TEST_F(Usb3Vision, UnpluggedItIsLostAndPluggedInItWorksAgain) {
    {
        const Bench bench = open();
        lab_.u3v_plug.unplug();
        EXPECT_THROW(bench.camera->expose(never), DeviceLost);
    }
    lab_.u3v_plug.plug_in();
    EXPECT_EQ(open().camera->expose(never).frame.size_px, kSensorPx);
}

// Frames that cost nothing but their bytes, as fast as they come; the machine may be busy.
TEST(Usb3VisionThroughput, IsSaid) {
    const VirtualLab lab(large_bench(), test_mounting(), true);
    RecordProperty("far_end_ms", std::to_string(1000 * far_end_s()));
    RecordProperty("frames_per_s",
                   std::to_string(large_frames_per_s(acquire::open_aravis("NFU3V01"))));
}

}  // namespace
}  // namespace nearfield::devices
