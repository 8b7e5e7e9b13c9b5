// SPDX-License-Identifier: Apache-2.0
// Proves what the camera answers to single datagrams, by the standard's numbers. Does not prove
// that sockets carry them: gige_wire_test.
#include "tests/sample_data/gige_commands.h"

#include <gtest/gtest.h>

#include <limits>

namespace nearfield::gige {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kInvalidParameter = 0x8002, kInvalidAddress = 0x8003,
                        kWriteProtect = 0x8004, kBadAlignment = 0x8005, kAccessDenied = 0x8006,
                        kInvalidHeader = 0x800E, kNotImplemented = 0x8001, kSilence = 0xFFFF;

std::string text_at(const Bytes& bytes, std::size_t at) {
    return reinterpret_cast<const char*>(&bytes.at(at));
}

TEST(GigeControl, DiscoveryTellsWhoItIs) {
    Bench bench;
    const Answer reply = bench.ask(command(0x0002), bench.other);
    ASSERT_EQ(reply.datagram.size(), 8U + 248U);
    EXPECT_EQ(number(reply.datagram, 0, 2), 0U);
    EXPECT_EQ(number(reply.datagram, 2, 2), 0x0003U);
    EXPECT_EQ(number(reply.datagram, 6, 2), 0x1234U);
    EXPECT_EQ(number(reply.datagram, 8 + 0x24, 4), 0x7F000001U);
    EXPECT_EQ(text_at(reply.datagram, 8 + 0x48), "nearfield");
    EXPECT_EQ(text_at(reply.datagram, 8 + 0xD8), "NF0001");
}

TEST(GigeControl, TheDescriptionIsWhereTheUrlSays) {
    Bench bench;
    const Answer url = bench.ask(command(kReadMem, {0x200, 512}), bench.master);
    unsigned at = 0, size = 0;
    ASSERT_EQ(
        std::sscanf(text_at(url.datagram, 12).c_str(), "Local:nearfield.xml;%x;%x", &at, &size), 2);
    std::string xml;
    for (std::uint32_t k = 0; k < size; k += 512) {
        const std::uint32_t count = std::min(512U, size - k);
        const Answer part = bench.ask(command(kReadMem, {at + k, count}), bench.master);
        ASSERT_EQ(part.datagram.size(), 12 + count);
        xml.append(part.datagram.begin() + 12, part.datagram.end());
    }
    EXPECT_EQ(xml.find("<?xml"), 0U);
    EXPECT_NE(xml.find("</RegisterDescription>"), std::string::npos);
    EXPECT_EQ(bench.status(command(kReadMem, {at + size, 4}), bench.master), kInvalidAddress);
}

TEST(GigeControl, FeaturesDoNotShareBytesUnlessTheySayWhichBits) {
    const std::vector<Feature> all = features(test_lab({64, 48}));
    for (const Feature& a : all)
        for (const Feature& b : all) {
            if (&a == &b || (a.is_masked() && b.is_masked() && a.address == b.address &&
                             (a.last_bit < b.first_bit || b.last_bit < a.first_bit)))
                continue;
            EXPECT_TRUE(a.address + a.bytes() <= b.address || b.address + b.bytes() <= a.address)
                << a.name << " and " << b.name;
        }
}

TEST(GigeControl, OnlyItsMasterMayWrite) {
    Bench bench;
    EXPECT_EQ(bench.write(address::kWidth, 32U), kAccessDenied) << "nobody has control";
    bench.take_control();
    EXPECT_EQ(bench.write(address::kWidth, 32U), 0U);
    EXPECT_EQ(bench.write(address::kWidth, 64U, bench.other), kAccessDenied);
    EXPECT_EQ(bench.write(0x0A00, 2U, bench.other), kAccessDenied);
    EXPECT_EQ(bench.status(command(kReadReg, {address::kWidth}), bench.other), 0U);
    EXPECT_EQ(bench.read(address::kWidth), 32U);
    EXPECT_EQ(bench.write(0x0A00, 0U), 0U);
    EXPECT_EQ(bench.write(0x0A00, 2U, bench.other), 0U);
    EXPECT_EQ(bench.write(address::kWidth, 64U), kAccessDenied);
}

TEST(GigeControl, ExclusiveControlHidesItsRegisters) {
    Bench bench;
    EXPECT_EQ(bench.write(0x0A00, 1U), 0U);
    EXPECT_EQ(bench.status(command(kReadReg, {address::kWidth}), bench.other), kAccessDenied);
    EXPECT_EQ(bench.status(command(0x0002), bench.other), 0U) << "discovery is always answered";
}

TEST(GigeControl, SilenceFreesControlAndStopsTheAcquisition) {
    Bench bench;
    bench.take_control();
    bench.write(address::kHeartbeatTimeout, 600U);
    bench.write(address::kAcquisitionStart, 1U);
    bench.now += 500ms;
    bench.read(0x0A00);  // any command of the master is a heartbeat
    bench.now += 500ms;
    bench.status(command(kReadReg, {0}), bench.other);  // others' are not
    expire_control(bench.device, bench.control, bench.now);
    EXPECT_TRUE(bench.device.acquisition.active);
    bench.now += 101ms;
    expire_control(bench.device, bench.control, bench.now);
    EXPECT_FALSE(bench.device.acquisition.active);
    EXPECT_EQ(bench.read(0x0A00), 0U);
    EXPECT_EQ(bench.write(0x0A00, 2U, bench.other), 0U);
}

TEST(GigeControl, RefusesWhatIsOutOfRangeAndKeepsTheOldValue) {
    Bench bench;
    bench.take_control();
    EXPECT_EQ(bench.write(address::kWidth, 33U), kInvalidParameter) << "odd";
    EXPECT_EQ(bench.write(address::kWidth, 66U), kInvalidParameter) << "wider than the sensor";
    EXPECT_EQ(bench.write(address::kWidth, 0U), kInvalidParameter);
    EXPECT_EQ(bench.write(address::kOffsetX, 2U), kInvalidParameter) << "region leaves the sensor";
    EXPECT_EQ(bench.write(address::kPixelFormat, 0x01080009U), kInvalidParameter)
        << "a Bayer format";
    EXPECT_EQ(bench.write(address::kPacketSize, 9004U), kInvalidParameter);
    EXPECT_EQ(bench.write(address::kExposureTime, 9.99), kInvalidParameter);
    EXPECT_EQ(bench.write(address::kExposureTime, std::numeric_limits<double>::quiet_NaN()),
              kInvalidParameter);
    EXPECT_EQ(bench.write(address::kExposureTime, 7U), kInvalidParameter) << "half of a register";
    EXPECT_EQ(bench.write(address::kFilterX, 9U), kInvalidParameter);
    EXPECT_EQ(bench.write(address::kTargetView, 3U), kInvalidParameter);
    EXPECT_EQ(bench.read(address::kWidth), 64U);
    EXPECT_EQ(bench.device.settings().exposure_us, 10000);
    EXPECT_EQ(bench.write(address::kWidth, 60U), 0U);
    EXPECT_EQ(bench.write(address::kOffsetX, 4U), 0U);
    EXPECT_EQ(bench.write(address::kWidth, 64U), kInvalidParameter);
    EXPECT_EQ(bench.read(address::kPayloadSize), 60U * 48U);
}

TEST(GigeControl, RefusesPlacesThatCannotBeWritten) {
    Bench bench;
    bench.take_control();
    EXPECT_EQ(bench.write(address::kPayloadSize, 1U), kWriteProtect);
    EXPECT_EQ(bench.write(0x0000, 1U), kWriteProtect);
    EXPECT_EQ(bench.write(0xA2FC, 1U), kWriteProtect);
    EXPECT_EQ(bench.write(0x10000, 1U), kWriteProtect);
    EXPECT_EQ(bench.write(0x9000, 1U), kInvalidAddress);
    EXPECT_EQ(bench.write(0xFFFFFFFC, 1U), kInvalidAddress);
    EXPECT_EQ(bench.write(address::kWidth + 2, 1U), kBadAlignment);
    EXPECT_EQ(bench.status(command(kReadMem, {0xFFFFFFFC, 8}), bench.master), kInvalidAddress);
    EXPECT_EQ(bench.status(command(kReadMem, {0x1, 4}), bench.master), kBadAlignment);
    EXPECT_EQ(bench.status(command(kReadMem, {0x0, 540}), bench.master), kInvalidParameter);
}

TEST(GigeControl, TheFramesLayoutIsFixedWhileTheyAreAcquired) {
    Bench bench;
    bench.take_control();
    bench.write(address::kAcquisitionStart, 1U);
    EXPECT_EQ(bench.write(address::kWidth, 32U), kAccessDenied);
    EXPECT_EQ(bench.write(address::kPixelFormat, 0x01100007U), kAccessDenied);
    EXPECT_EQ(bench.write(address::kPacketSize, 1500U), kAccessDenied);
    EXPECT_EQ(bench.write(address::kExposureTime, 500.0), 0U);
    bench.write(address::kAcquisitionStop, 1U);
    EXPECT_EQ(bench.write(address::kWidth, 32U), 0U);
    bench.write(address::kParamsLocked, 1U);
    EXPECT_EQ(bench.write(address::kWidth, 64U), kAccessDenied);
}

TEST(GigeControl, ATriggerNeedsATriggeredAcquisition) {
    Bench bench;
    bench.take_control();
    bench.write(address::kTriggerMode, 1U);
    EXPECT_EQ(bench.write(address::kTriggerSoftware, 1U), kAccessDenied);
    bench.write(address::kAcquisitionStart, 1U);
    EXPECT_EQ(bench.write(address::kTriggerSoftware, 1U), 0U);
    EXPECT_EQ(bench.write(address::kTriggerSoftware, 1U), 0U);
    EXPECT_EQ(bench.device.acquisition.triggers, 2U);
    bench.write(address::kAcquisitionStop, 1U);
    EXPECT_EQ(bench.device.acquisition.triggers, 0U);
}

TEST(GigeControl, ReadsAndWritesSeveralRegistersUpToTheFirstThatIsWrong) {
    Bench bench;
    bench.take_control();
    const Bytes widths =
        bench.ask(command(kReadReg, {address::kWidth, address::kHeight}), bench.master).datagram;
    EXPECT_EQ(number(widths, 8, 4), 64U);
    EXPECT_EQ(number(widths, 12, 4), 48U);
    const Bytes written =
        bench
            .ask(
                command(kWriteReg, {address::kWidth, 32, address::kHeight, 3, address::kHeight, 8}),
                bench.master)
            .datagram;
    EXPECT_EQ(number(written, 0, 2), kInvalidParameter);
    EXPECT_EQ(number(written, 10, 2), 1U) << "one was written";
    EXPECT_EQ(bench.read(address::kWidth), 32U);
    EXPECT_EQ(bench.read(address::kHeight), 48U);
    EXPECT_EQ(bench.status(command(kWriteMem, {address::kWidth, 16, 3}), bench.master),
              kInvalidParameter);
    EXPECT_EQ(bench.read(address::kWidth), 32U) << "a block is written as a whole or not at all";
}

TEST(GigeControl, DropsOrRefusesWhatIsNoCommand) {
    Bench bench;
    bench.take_control();
    EXPECT_EQ(bench.status({}, bench.master), kSilence);
    EXPECT_EQ(bench.status({0x42, 1, 0, 2, 0, 0, 0}, bench.master), kSilence);
    Bytes wrong_key = command(0x0002);
    wrong_key[0] = 0x43;
    EXPECT_EQ(bench.status(wrong_key, bench.master), kSilence);
    Bytes wrong_length = command(kReadReg, {0});
    wrong_length[5] = 8;
    EXPECT_EQ(bench.status(wrong_length, bench.master), kInvalidHeader);
    EXPECT_EQ(bench.status(command(kReadReg), bench.master), kInvalidHeader);
    EXPECT_EQ(bench.status(command(kWriteReg, {address::kWidth}), bench.master), kInvalidHeader);
    EXPECT_EQ(bench.status(command(kReadMem, {0}), bench.master), kInvalidHeader);
    EXPECT_EQ(bench.status(command(kWriteMem, {address::kWidth}), bench.master), kInvalidHeader);
    EXPECT_EQ(bench.status(command(0x00C0), bench.master), kNotImplemented);
    EXPECT_EQ(bench.status(command(kReadReg, {0}, false), bench.master), kSilence);
}

TEST(GigeControl, AnAddressCannotBeForcedOnIt) {
    Bench bench;
    EXPECT_EQ(bench.status(command(0x0004, {0x0200, 0x7F000001}), bench.master), kNotImplemented);
    EXPECT_EQ(bench.status(command(0x0004, {0x0200, 0x7F000002}), bench.master), kSilence)
        << "meant for another";
    EXPECT_EQ(bench.status(command(0x0004), bench.master), kSilence);
}

TEST(GigeControl, TheMastersMachineMayAskForPacketsAgain) {
    Bench bench;
    bench.take_control();
    const Bytes asked = command(0x0040, {7, 3, 0xFF000009}, false);
    const auto request = bench.ask(asked, bench.master).resend;
    ASSERT_TRUE(request);
    EXPECT_EQ(request->block_id, 7);
    EXPECT_EQ(request->first_packet, 3U);
    EXPECT_EQ(request->last_packet, 9U);
    EXPECT_TRUE(bench.ask(asked, bench.other).resend) << "another port, as its stream has";
    EXPECT_FALSE(bench.ask(asked, Peer{0x7F000002, 5000}).resend);
    EXPECT_FALSE(bench.ask(command(0x0040, {7, 3}, false), bench.master).resend);
}

TEST(GigeControl, RegistersShowTheLab) {
    Bench bench;
    bench.take_control();
    bench.write(address::kFilterX, 8U);
    bench.write(address::kFilterY, 6U);
    const auto real = [&](std::uint32_t at) {
        const Bytes bytes = bench.ask(command(kReadMem, {at, 8}), bench.master).datagram;
        return std::bit_cast<double>(std::uint64_t{number(bytes, 12, 4)} << 32U |
                                     number(bytes, 16, 4));
    };
    EXPECT_EQ(real(address::kPhotometer), 168);
    EXPECT_EQ(real(address::kLabTime), 12.5);
    EXPECT_EQ(real(address::kTemperature), 36.5);
    EXPECT_EQ(real(address::kBlackLevel), 64);
    bench.write(address::kTimestampControl, 2U);
    EXPECT_EQ(bench.read(0x0948), 2U);  // 12.5e9 = 2 * 2^32 + 3910065408 ns
    EXPECT_EQ(bench.read(0x094C), 3910065408U);
}

}  // namespace
}  // namespace nearfield::gige
