// SPDX-License-Identifier: Apache-2.0
#include "acquire/session.h"

#include "acquire/aravis_camera.h"
#include "acquire/instrument_stage.h"
#include "acquire/v4l2_camera.h"
#include "tests/devices/test_lab.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <utility>

namespace nearfield::devices {
namespace {

// Light by exposure and position, and noise by shot and frame, so that no two frames are equal.
std::vector<std::uint16_t> linear_frame(const gige::Exposure& exposure) {
    std::vector<std::uint16_t> values(static_cast<std::size_t>(kSensorPx.x * kSensorPx.y));
    const double light = exposure.stage.lamp_on ? exposure.exposure_us / 20 : 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::size_t noise = (k + 5 * exposure.stage.shot + 3 * exposure.frame_number) % 7;
        values[k] = static_cast<std::uint16_t>(
            100 + light * (2 + exposure.stage.filter.x + static_cast<int>(k % 3)) +
            static_cast<double>(noise));
    }
    return values;
}

gige::Lab linear_bench() {
    gige::Lab lab = test_bench();
    lab.expose = linear_frame;
    return lab;
}

capture::Plan plan_of(const std::string& camera) {
    capture::Plan plan;
    plan.camera.device = camera;
    plan.stage = capture::StageKind::Camera;
    plan.grid = {3, 2};
    plan.pitch_m = 1e-3 * kPitch_mm;
    plan.basis = "bspline";
    plan.darks = 1;
    plan.bracket.exposures_us = {2000, 6000};
    plan.instruments.stage.emplace();
    plan.instruments.stage->device = "/dev/ttyUSB0";
    plan.instruments.stage->first_position_mm = kFirst_mm;
    plan.instruments.stage->feed_mm_per_min = 3000;
    plan.instruments.luxmeter.emplace();
    plan.instruments.luxmeter->device = "NFLUX01";
    plan.instruments.supply.emplace();
    plan.instruments.supply->device = "NFPSU01";
    plan.instruments.supply->voltage_v = 12;
    plan.instruments.supply->current_limit_a = 6;
    plan.instruments.supply->warm_window_s = 0.1;
    return plan;
}

// A capture among all devices. `unplug` is called before the shot in its middle, `plug_in` before
// the second try to open what was lost.
class DeviceSession : public testing::Test {
  protected:
    DeviceSession() { lab_.stage.speed_up = 50; }

    std::map<int, std::string> capture_with(const std::string& camera,
                                            const std::function<void()>& unplug,
                                            const std::function<void()>& plug_in) {
        const std::string folder = "device_session_capture";
        std::filesystem::remove_all(folder);
        capture::CaptureHeader header;
        header.plan = plan_of(camera);
        capture::CaptureWriter writer = capture::CaptureWriter::create(folder, header);
        acquire::SessionOptions options;
        int opened = 0, shots = 0;
        options.open = [&] {
            if (++opened == 3)
                plug_in();
            acquire::Bench bench = camera.starts_with("/dev/") ? acquire::open_v4l2(camera)
                                                               : acquire::open_aravis(camera);
            bench.stage = acquire::instrument_stage(*header.plan, std::move(bench.stage), never);
            return bench;
        };
        options.say = [&](const std::string& remark) {
            told_.push_back(remark);
            if (when_told_)
                std::exchange(when_told_, nullptr)();
        };
        options.progress = [&](double, const std::string&) {
            if (++shots == kUnpluggedAt)
                unplug();
        };
        const acquire::SessionResult result =
            run_session(writer, capture::read_capture(folder), options);
        reconnects_ = result.reconnects;
        std::map<int, std::string> hashes;
        for (const auto& [number, frame] : capture::read_capture(folder).frames)
            hashes[number] = frame.xxh128;
        return hashes;
    }

    // Every device comes back, and the capture is the one that nothing happened to.
    void expect_survives(const std::string& camera,
                         const std::function<void()>& unplug,
                         const std::function<void()>& plug_in) {
        const auto whole = capture_with(
            camera, [] {}, [] {});
        EXPECT_EQ(whole.size(), 2U + 2 * 3 * 2);
        EXPECT_EQ(reconnects_, 0);
        EXPECT_EQ(capture_with(camera, unplug, plug_in), whole);
        EXPECT_EQ(reconnects_, 1);
    }

    static constexpr int kUnpluggedAt = 8;
    std::function<void()> when_told_;
    std::vector<std::string> told_;
    int reconnects_ = 0;
    VirtualLab lab_{linear_bench(), test_mounting(), true};
};

TEST_F(DeviceSession, GoesOnWhenTheLuxmeterComesBack) {
    expect_survives(
        "/dev/video0", [&] { lab_.luxmeter_plug.unplug(); }, [&] { lab_.luxmeter_plug.plug_in(); });
}

TEST_F(DeviceSession, GoesOnWhenTheSupplyComesBack) {
    expect_survives(
        "/dev/video0", [&] { lab_.supply_plug.unplug(); }, [&] { lab_.supply_plug.plug_in(); });
}

TEST_F(DeviceSession, GoesOnWhenTheStageComesBack) {
    expect_survives(
        "/dev/video0", [&] { lab_.stage.unplug(); }, [&] { lab_.stage.plug_in(); });
}

TEST_F(DeviceSession, GoesOnWhenAV4l2CameraComesBack) {
    expect_survives(
        "/dev/video0", [&] { lab_.v4l2.faults.is_gone = true; },
        [&] { lab_.v4l2.faults.is_gone = false; });
}

// As after a kill: the dead program's buffers are still there.
TEST_F(DeviceSession, BeginsWhenAnotherProgramHasLetGoOfTheCamera) {
    const auto nothing = [] {};
    const auto whole = capture_with("/dev/video0", nothing, nothing);
    EXPECT_EQ(told_, std::vector<std::string>());
    acquire::Bench other = acquire::open_v4l2("/dev/video0");
    other.camera->configure({});
    when_told_ = [&] { other = {}; };
    EXPECT_EQ(capture_with("/dev/video0", nothing, nothing), whole);
    ASSERT_EQ(told_.size(), 1U);
    EXPECT_EQ(told_[0].substr(0, 13), "device busy: ");
}

TEST_F(DeviceSession, GoesOnWhenAUsb3VisionCameraComesBack) {
    expect_survives(
        "NFU3V01", [&] { lab_.u3v_plug.unplug(); }, [&] { lab_.u3v_plug.plug_in(); });
}

}  // namespace
}  // namespace nearfield::devices
