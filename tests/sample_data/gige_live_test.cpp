// SPDX-License-Identifier: Apache-2.0
// Proves what a camera with its threads and sockets does where no ordinary client would wait for
// it.
#include "formats/files/error.h"
#include "sample_data/gige/udp_socket.h"
#include "tests/sample_data/gige_commands.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>

namespace nearfield::gige {
namespace {

constexpr std::uint32_t kLoopback = 0x7F000001;

CameraOptions any_port() {
    CameraOptions options;
    options.port = 0;
    options.fast = true;
    return options;
}

// True as soon as `done` is, false if it is not for ten seconds.
bool wait_until(const std::function<bool()>& done) {
    for (int k = 0; k < 10000 && !done(); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return done();
}

struct Running {
    explicit Running(const CameraOptions& options, const Lab& lab = test_lab({64, 48}))
        : camera(options, lab) {
        for (const Bytes& start : starting_commands(socket.port()))
            socket.send(start, {kLoopback, camera.port()});
    }
    Camera camera;
    UdpSocket socket{kLoopback, 0, "cannot open the client"};
};

TEST(GigeLive, WhatTheLabThrowsEndsTheCamera) {
    Lab lab = test_lab({64, 48});
    lab.expose = [](const Exposure&) -> std::vector<std::uint16_t> {
        throw std::runtime_error("no such position");
    };
    const Running running(any_port(), lab);
    EXPECT_TRUE(wait_until([&] { return !running.camera.running(); }));
    EXPECT_THROW(running.camera.check(), std::runtime_error);
}

TEST(GigeLive, APictureOfTheWrongSizeEndsTheCamera) {
    Lab lab = test_lab({64, 48});
    lab.expose = [](const Exposure&) { return std::vector<std::uint16_t>(std::size_t{63} * 48); };
    const Running running(any_port(), lab);
    EXPECT_TRUE(wait_until([&] { return !running.camera.running(); }));
    EXPECT_THROW(running.camera.check(), Error);
}

TEST(GigeLive, DiesInTheMidstOfTheFrameThatItWasTold) {
    CameraOptions options = any_port();
    options.faults.die_after = 3;
    const Running running(options);
    EXPECT_TRUE(wait_until([&] { return !running.camera.running(); }));
    EXPECT_EQ(running.camera.statistics().frames, 3U);
    EXPECT_NO_THROW(running.camera.check());
}

TEST(GigeLive, CountsWhatItSends) {
    const Running running(any_port());
    ASSERT_TRUE(wait_until([&] { return running.camera.statistics().frames >= 10; }));
    const Statistics seen = running.camera.statistics();
    EXPECT_EQ(seen.packets, 3 * seen.frames) << "leader, one of data, trailer";
    EXPECT_EQ(seen.bytes, std::size_t{64} * 48 * seen.frames);
    EXPECT_EQ(seen.commands, 4U);
    EXPECT_EQ(seen.refused_commands, 0U);
}

TEST(GigeLive, SendsAgainWhatItStillHasAndSaysWhatIsGone) {
    const Running running(any_port());
    const auto seen = [&] { return running.camera.statistics(); };
    ASSERT_TRUE(wait_until([&] { return seen().frames >= 20; }));
    const Peer there{kLoopback, running.camera.port()};
    running.socket.send(command(0x0040, {1, 0, 0xFFFFFF}, false), there);
    EXPECT_TRUE(wait_until([&] { return seen().resent_packets == 3; })) << "leader, data, trailer";
    running.socket.send(command(0x0040, {60000, 0, 0}, false), there);
    EXPECT_TRUE(wait_until([&] { return seen().unavailable_packets == 1; }));
}

// The shortest time in which a link of some speed can carry what was sent.
TEST(GigeLive, KeepsTheLinksPace) {
    CameraOptions options = any_port();
    options.link_mbit_s = 8;
    const Running running(options);
    ASSERT_TRUE(wait_until([&] { return running.camera.statistics().frames >= 50; }));
    const Statistics seen = running.camera.statistics();
    EXPECT_GE(seen.sending_s, static_cast<double>(seen.bytes) / 1e6 - 0.001);
}

TEST(GigeLive, OptionsOutOfRangeAreRefusedByName) {
    const auto refusal = [](const CameraOptions& options, const Lab& lab) -> std::string {
        try {
            const Camera camera(options, lab);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    CameraOptions options = any_port();
    options.address = "localhost";
    EXPECT_NE(refusal(options, test_lab({64, 48})).find("IPv4"), std::string::npos);
    options.address = "192.0.2.1";  // for documentation alone: nobody's
    EXPECT_NE(refusal(options, test_lab({64, 48})).find("UDP 192.0.2.1"), std::string::npos);
    EXPECT_NE(refusal(any_port(), test_lab({63, 48})).find("63 x 48"), std::string::npos);
    options = any_port();
    options.faults.drop_share = 1.5;
    EXPECT_NE(refusal(options, test_lab({64, 48})).find("1.5"), std::string::npos);
    options = any_port();
    options.serial = "0123456789ABCDEF";
    EXPECT_NE(refusal(options, test_lab({64, 48})).find("15 characters"), std::string::npos);
}

}  // namespace
}  // namespace nearfield::gige
