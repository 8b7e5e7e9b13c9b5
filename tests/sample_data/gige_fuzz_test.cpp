// SPDX-License-Identifier: Apache-2.0
// Proves that no datagram crashes the camera, makes it answer nonsense, or gets it into a state in
// which it could not send a frame. Run it under AddressSanitizer.
#include "sample_data/gige/udp_socket.h"
#include "tests/sample_data/gige_commands.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace nearfield::gige {
namespace {

std::vector<Bytes> good_commands() {
    std::vector<Bytes> list = {
        command(0x0002),
        command(0x0004, {0x0200, 0x7F000001, 0, 0, 0, 0}),
        command(0x0040, {1, 2, 3}, false),
        command(kReadReg, {address::kWidth, address::kHeight, address::kControlPrivilege}),
        command(kReadMem, {0x200, 512}),
        command(kReadMem, {address::kPhotometer, 8}),
        command(kReadMem, {address::kXml, 536}),
        command(kWriteReg, {address::kControlPrivilege, 2}),
        command(kWriteReg, {address::kPacketSize, 0x800005DC}),
        command(kWriteMem, {address::kUserDefinedName, 0x41424344, 0, 0, 0}),
        command(kWriteMem, {address::kExposureTime, 0x40C38800, 0})};
    for (std::uint32_t at = address::kWidth; at < address::kShot + 4; at += 4)
        list.push_back(command(kWriteReg, {at, at % 3}));
    return list;
}

void expect_answer_is_well_formed(const Answer& reply, const Bytes& asked) {
    if (reply.datagram.empty())
        return;
    ASSERT_GE(reply.datagram.size(), 8U);
    ASSERT_LE(reply.datagram.size(), 576U - 28U);
    EXPECT_EQ(number(reply.datagram, 4, 2), reply.datagram.size() - 8);
    EXPECT_EQ(number(reply.datagram, 2, 2), (number(asked, 2, 2) + 1) % 65536);
    EXPECT_EQ(number(reply.datagram, 6, 2), number(asked, 6, 2));
}

void expect_a_frame_could_be_sent(const Device& device) {
    const Settings now = device.settings();
    ASSERT_TRUE(format_info(static_cast<std::uint32_t>(now.format)));
    ASSERT_GT(now.size_px.x, 0);
    ASSERT_GT(now.size_px.y, 0);
    ASSERT_LE(now.offset_px.x + now.size_px.x, 64);
    ASSERT_LE(now.offset_px.y + now.size_px.y, 48);
    ASSERT_TRUE(now.exposure_us >= 10 && now.exposure_us <= 1e7);
    ASSERT_TRUE(now.frame_rate_hz >= 0.01);
    ASSERT_GE(now.packet_bytes, 220U);
    ASSERT_LE(now.packet_bytes, 9000U);
    ASSERT_LT(now.stage.filter.x, 9);
    ASSERT_LT(now.stage.filter.y, 7);
    ASSERT_LT(now.stage.target_view, 3);
}

TEST(GigeFuzz, NoDatagramDoesHarm) {
    const std::vector<Bytes> good = good_commands();
    Bench bench;
    std::uint64_t answered = 0;
    for (std::uint64_t seed = 0; seed < 20 * test::fuzz_count(); ++seed) {
        const Bytes& original = good[seed % good.size()];
        const std::string mutated =
            test::mutate(std::string(original.begin(), original.end()), seed);
        const Bytes asked(mutated.begin(), mutated.end());
        if (!bench.control.holder)
            bench.take_control();
        const Answer reply = bench.ask(asked, bench.master);
        answered += reply.datagram.empty() ? 0 : 1;
        expect_answer_is_well_formed(reply, asked);
        expect_a_frame_could_be_sent(bench.device);
        if (HasFatalFailure())
            FAIL() << "seed " << seed;
    }
    EXPECT_GT(answered, test::fuzz_count()) << "the test reaches the commands";
}

// With its threads and sockets, while it sends frames.
TEST(GigeFuzz, NoDatagramEndsALiveCamera) {
    const std::vector<Bytes> good = good_commands();
    CameraOptions options;
    options.port = 0;
    options.fast = true;
    const Camera camera(options, test_lab({64, 48}));
    const Peer there{0x7F000001, camera.port()};
    const UdpSocket client(0x7F000001, 0, "cannot open the client"),
        receiver(0x7F000001, 0, "cannot open the receiver");
    for (const Bytes& start : {command(kWriteReg, {0x0A00, 2}),
                               command(kWriteReg, {0x0D18, 0x7F000001, 0x0D00, receiver.port()}),
                               command(kWriteMem, {address::kFrameRate, 0x408F4000, 0}),  // 1000 Hz
                               command(kWriteReg, {address::kAcquisitionStart, 1})})
        client.send(start, there);
    for (std::uint64_t seed = 0; seed < test::fuzz_count(); ++seed) {
        const Bytes& original = seed % 4 == 0 ? good[2] : good[seed % good.size()];
        const std::string mutated =
            test::mutate(std::string(original.begin(), original.end()), seed);
        client.send(Bytes(mutated.begin(), mutated.end()), there);
        while (client.receive() || receiver.receive()) {
        }
    }
    bool answered = false;
    for (int k = 0; k < 10000 && !answered; ++k) {
        client.send(command(0x0002, {}, true, 0x7777), there);  // full sockets drop datagrams
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        while (const auto got = client.receive())
            answered = answered || number(got->first, 6, 2) == 0x7777;
    }
    EXPECT_TRUE(answered);
    EXPECT_TRUE(camera.running());
    camera.check();
}

}  // namespace
}  // namespace nearfield::gige
