// SPDX-License-Identifier: Apache-2.0
// Proves that an ordinary client drives the camera over real sockets: Aravis, as Debian has it.
#include "tests/sample_data/gige_client.h"

#include <algorithm>
#include <string>

namespace nearfield::gige {
namespace {

constexpr glm::ivec2 kSensorPx(256, 192);

// Asks for frames one by one.
void start_triggered(Client& client) {
    client.set("AcquisitionMode", "Continuous");
    arv_camera_set_trigger(client.camera.get(), "Software", client.failure.out());
    ASSERT_EQ(client.failure.text(), "");
    client.open_stream();
    arv_camera_start_acquisition(client.camera.get(), client.failure.out());
    ASSERT_EQ(client.failure.text(), "");
}

std::optional<Received> trigger(Client& client, unsigned patience_ms = 10000) {
    arv_camera_software_trigger(client.camera.get(), client.failure.out());
    EXPECT_EQ(client.failure.text(), "");
    return client.next_frame(patience_ms);
}

Exposure exposure_of(std::uint64_t frame_number, double exposure_us = 10000) {
    Exposure exposure;
    exposure.frame_number = frame_number;
    exposure.exposure_us = exposure_us;
    return exposure;
}

TEST(GigeWire, IsFoundAndDescribesItself) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    arv_update_device_list();
    std::string address;
    for (unsigned k = 0; k < arv_get_n_devices(); ++k)
        if (arv_get_device_serial_nbr(k) == options.serial)
            address = arv_get_device_address(k);
    EXPECT_EQ(address, options.address) << "by broadcast";

    Client client(options.address);
    ASSERT_NE(client.camera, nullptr) << client.failure.text();
    EXPECT_STREQ(arv_camera_get_vendor_name(client.camera.get(), nullptr), "nearfield");
    EXPECT_EQ(arv_camera_get_device_serial_number(client.camera.get(), nullptr), options.serial);
    int width = 0, height = 0;
    arv_camera_get_sensor_size(client.camera.get(), &width, &height, nullptr);
    EXPECT_EQ(glm::ivec2(width, height), kSensorPx);
    double least = 0, most = 0;
    arv_camera_get_exposure_time_bounds(client.camera.get(), &least, &most, nullptr);
    EXPECT_EQ(std::pair(least, most), std::pair(10.0, 1e7));
    EXPECT_EQ(arv_camera_get_float(client.camera.get(), "DeviceTemperature", nullptr), 36.5);
    EXPECT_EQ(arv_camera_get_float(client.camera.get(), "BlackLevel", nullptr), 64);
}

TEST(GigeWire, ItsLabIsMovedOnTheSameWire) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("LabFilterX", 3);
    client.set("LabFilterY", 5);
    EXPECT_EQ(arv_camera_get_float(client.camera.get(), "LabPhotometer", nullptr), 153);
    arv_camera_set_boolean(client.camera.get(), "LabLampOn", FALSE, client.failure.out());
    EXPECT_EQ(arv_camera_get_float(client.camera.get(), "LabPhotometer", nullptr), 0.5);
    client.set("LabSubject", "Target");
    EXPECT_STREQ(arv_camera_get_string(client.camera.get(), "LabSubject", nullptr), "Target");
    const double before_s = arv_camera_get_float(client.camera.get(), "LabTime", nullptr);
    EXPECT_GT(arv_camera_get_float(client.camera.get(), "LabTime", nullptr), before_s);
    arv_camera_set_integer(client.camera.get(), "LabFilterX", 9, client.failure.out());
    EXPECT_NE(client.failure.text(), "") << "there are 9 columns";
}

class EveryFormat : public testing::TestWithParam<FormatInfo> {};

TEST_P(EveryFormat, GivesOneRightFramePerTrigger) {
    const CameraOptions options = quick_options();
    Lab lab = test_lab(kSensorPx);
    lab.is_bayer = GetParam().is_bayer;
    const Camera camera(options, lab);
    Client client(options.address);
    ASSERT_NE(client.camera, nullptr) << client.failure.text();
    client.set("PixelFormat", GetParam().name);
    arv_camera_set_region(client.camera.get(), 16, 32, 200, 100, client.failure.out());
    ASSERT_EQ(client.failure.text(), "");
    start_triggered(client);
    for (unsigned k = 0; k < 3; ++k) {
        const auto frame = trigger(client);
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->status, ARV_BUFFER_STATUS_SUCCESS);
        EXPECT_EQ(frame->block_id, k + 1);
        EXPECT_EQ(frame->size_px, glm::ivec2(200, 100));
        EXPECT_EQ(frame->offset_px, glm::ivec2(16, 32));
        EXPECT_EQ(frame->values, expected_values(*frame, GetParam().format, exposure_of(k)));
    }
    EXPECT_FALSE(client.next_frame(100)) << "nothing without a trigger";
}

INSTANTIATE_TEST_SUITE_P(GigePixels, EveryFormat, testing::ValuesIn(kFormats), [](const auto& one) {
    return std::string(one.param.name);
});

TEST(GigeWire, TheWholeRegionCanBeMovedBackAndForth) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    for (const auto& [x, y, width, height] :
         {std::array{16, 32, 200, 100}, {0, 0, 256, 192}, {250, 190, 6, 2}, {0, 0, 256, 192}}) {
        arv_camera_set_region(client.camera.get(), x, y, width, height, client.failure.out());
        EXPECT_EQ(client.failure.text(), "") << x << " " << y;
    }
}

TEST(GigeWire, PacketsThatGetLostAreSentAgain) {
    CameraOptions options = quick_options();
    options.faults.drop_share = 0.02;
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("PixelFormat", "Mono16");
    arv_camera_gv_set_packet_size_adjustment(client.camera.get(),
                                             ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    client.set("GevSCPSPacketSize", 576);  // 182 packets a frame
    start_triggered(client);
    for (unsigned k = 0; k < 40; ++k) {
        const auto frame = trigger(client);
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->status, ARV_BUFFER_STATUS_SUCCESS) << "frame " << k;
        ASSERT_EQ(frame->values, expected_values(*frame, PixelFormat::Mono16, exposure_of(k)));
    }
    const Statistics seen = camera.statistics();
    EXPECT_NEAR(static_cast<double>(seen.dropped_packets), 0.02 * 40 * 182, 48);  // 4 sigma
    EXPECT_GE(seen.resent_packets, seen.dropped_packets);
}

TEST(GigeWire, WithoutResendLostPacketsSpoilFrames) {
    CameraOptions options = quick_options();
    options.faults.drop_share = 0.2;
    options.faults.no_resend = true;
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("GevSCPSPacketSize", 576);
    start_triggered(client);
    g_object_set(client.stream.get(), "frame-retention", 50000, nullptr);
    const auto frame = trigger(client);
    ASSERT_TRUE(frame);
    EXPECT_NE(frame->status, ARV_BUFFER_STATUS_SUCCESS);
    EXPECT_EQ(camera.statistics().resent_packets, 0U);
}

TEST(GigeWire, ASecondMasterIsDenied) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    Client first(options.address), second(options.address);
    ASSERT_NE(first.camera, nullptr);
    ASSERT_NE(second.camera, nullptr) << second.failure.text();
    EXPECT_TRUE(
        arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(first.camera.get()))));
    EXPECT_FALSE(
        arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(second.camera.get()))));
    arv_camera_set_exposure_time(second.camera.get(), 500, second.failure.out());
    EXPECT_NE(second.failure.text().find("access-denied"), std::string::npos)
        << second.failure.text();
    EXPECT_EQ(arv_camera_get_exposure_time(second.camera.get(), nullptr), 10000) << "it may read";
    first.camera.reset();
    Client third(options.address);
    third.set("ExposureTime", 500.0);
}

TEST(GigeWire, AStartGivesAsManyFramesAsItsModeSays) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("AcquisitionFrameRate", 200.0);
    client.open_stream();
    std::uint64_t block_id = 0;
    const auto expect_frames = [&](const char* mode, int count) {
        client.set("AcquisitionMode", mode);
        client.run("AcquisitionStart");
        for (int k = 0; k < count; ++k) {
            const auto frame = client.next_frame();
            ASSERT_TRUE(frame) << mode << " " << k;
            EXPECT_EQ(frame->status, ARV_BUFFER_STATUS_SUCCESS);
            EXPECT_EQ(frame->block_id, ++block_id);
        }
        EXPECT_FALSE(client.next_frame(100)) << mode << " sends no more";
        client.run("AcquisitionStop");
    };
    client.set("AcquisitionFrameCount", 3);
    expect_frames("SingleFrame", 1);
    expect_frames("MultiFrame", 3);
    expect_frames("SingleFrame", 1);
    client.set("AcquisitionMode", "Continuous");
    client.run("AcquisitionStart");
    std::uint64_t before_ns = 0;
    for (int k = 0; k < 10; ++k) {
        const auto frame = client.next_frame();
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->block_id, ++block_id);
        EXPECT_GT(frame->timestamp_ns, before_ns);
        before_ns = frame->timestamp_ns;
    }
    client.run("AcquisitionStop");
}

TEST(GigeWire, AFrameTakesItsExposureAndReadout) {
    CameraOptions options = quick_options();
    options.fast = false;
    options.readout_us = 20000;
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("ExposureTime", 150000.0);
    start_triggered(client);
    const gint64 start_us = g_get_monotonic_time();
    ASSERT_TRUE(trigger(client));
    EXPECT_GE(g_get_monotonic_time() - start_us, 170000) << "it cannot come earlier";
}

TEST(GigeWire, StoppingDropsTheFrameThatIsBeingExposed) {
    CameraOptions options = quick_options();
    options.fast = false;
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("ExposureTime", 1e7);
    start_triggered(client);
    EXPECT_FALSE(trigger(client, 100));
    client.run("AcquisitionStop");
    client.set("ExposureTime", 100.0);
    client.run("AcquisitionStart");
    const auto frame = trigger(client);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->values.at(0) >> 4U, 100 >> 8U) << "Mono8 of 12 bits";
    EXPECT_EQ(frame->values, expected_values(*frame, PixelFormat::Mono8, exposure_of(1, 100)));
}

// The exposure times of frames after one was set in their midst, as pixel (0, 0) has them.
std::vector<int> applied_exposures(const CameraOptions& options) {
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("PixelFormat", "Mono12");
    client.set("ExposureTime", 1000.0);
    start_triggered(client);
    std::vector<int> applied;
    for (int k = 0; k < 6; ++k) {
        if (k == 2)
            client.set("ExposureTime", 2000.0);
        const auto frame = trigger(client);
        applied.push_back(frame && !frame->values.empty() ? frame->values[0] : -1);
    }
    EXPECT_EQ(arv_camera_get_exposure_time(client.camera.get(), nullptr), 2000)
        << "what is read back is what was set";
    return applied;
}

TEST(GigeWire, ExposureTakesEffectAtOnceOrAsLateAsAsked) {
    CameraOptions options = quick_options();
    EXPECT_EQ(applied_exposures(options), (std::vector{1000, 1000, 2000, 2000, 2000, 2000}));
    options.exposure_latency_frames = 2;
    EXPECT_EQ(applied_exposures(options), (std::vector{1000, 1000, 1000, 1000, 2000, 2000}));
}

TEST(GigeWire, ExposureCanBeLiedAbout) {
    CameraOptions options = quick_options();
    options.faults.clamp_exposure_us = 1500;
    EXPECT_EQ(applied_exposures(options), (std::vector{1000, 1000, 1500, 1500, 1500, 1500}));
    options.faults = {};
    options.faults.ignore_exposure = true;
    EXPECT_EQ(applied_exposures(options), (std::vector{1000, 1000, 1000, 1000, 1000, 1000}));
}

TEST(GigeWire, FramesOfAShotAreCounted) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    start_triggered(client);
    for (const int shot : {7, 7, 8}) {
        client.set("LabShot", shot);
        for (unsigned k = 0; k < 2; ++k) {
            const auto frame = trigger(client);
            ASSERT_TRUE(frame);
            EXPECT_EQ(frame->values, expected_values(*frame, PixelFormat::Mono8, exposure_of(k)));
        }
    }
}

TEST(GigeWire, ACameraThatDiesInAFrameCanBeOpenedAfterItsRestart) {
    CameraOptions options = quick_options();
    options.faults.die_after = 2;
    auto camera = std::make_unique<Camera>(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("GevSCPSPacketSize", 576);
    start_triggered(client);
    g_object_set(client.stream.get(), "frame-retention", 50000, nullptr);
    for (int k = 0; k < 2; ++k) {
        const auto frame = trigger(client);
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->status, ARV_BUFFER_STATUS_SUCCESS);
    }
    const auto broken = trigger(client, 500);
    EXPECT_TRUE(!broken || broken->status != ARV_BUFFER_STATUS_SUCCESS);
    EXPECT_FALSE(camera->running());
    camera.reset();
    camera = std::make_unique<Camera>(quick_options(), test_lab(kSensorPx));
    Client again(options.address);
    ASSERT_NE(again.camera, nullptr) << again.failure.text();
    start_triggered(again);
    const auto frame = trigger(again);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->values, expected_values(*frame, PixelFormat::Mono8, exposure_of(0)));
}

TEST(GigeWire, ACameraThatStallsStillAnswers) {
    CameraOptions options = quick_options();
    options.faults.stall_after = 1;
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    start_triggered(client);
    EXPECT_TRUE(trigger(client));
    EXPECT_FALSE(trigger(client, 200));
    client.set("ExposureTime", 500.0);
    EXPECT_TRUE(camera.running());
}

TEST(GigeWire, APortInUseIsAClearError) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    try {
        const Camera second(options, test_lab(kSensorPx));
        FAIL() << "two cameras on a port";
    } catch (const std::exception& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find(options.address + ":3956"), std::string::npos) << text;
        EXPECT_NE(text.find("in use"), std::string::npos) << text;
    }
}

TEST(GigeWire, ThePacketSizeIsFoundByTestPackets) {
    const CameraOptions options = quick_options();
    const Camera camera(options, test_lab(kSensorPx));
    Client client(options.address);
    client.set("GevSCPSPacketSize", 576);
    const guint found = arv_camera_gv_auto_packet_size(client.camera.get(), client.failure.out());
    EXPECT_EQ(client.failure.text(), "");
    EXPECT_GT(found, 8000U) << "up to what bisection leaves of 9000";
}

}  // namespace
}  // namespace nearfield::gige
