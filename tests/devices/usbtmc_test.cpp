// SPDX-License-Identifier: Apache-2.0
#include "acquire/usbtmc.h"

#include "tests/devices/test_lab.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nearfield::devices {
namespace {

using acquire::DeviceLost;
using acquire::Usbtmc;
using testing::AllOf;
using testing::HasSubstr;

class UsbInstrument : public testing::Test {
  protected:
    void SetUp() override { lab_.state.set_lamp(true, 12); }

    VirtualLab lab_{test_bench(), test_mounting(), true};
};

TEST_F(UsbInstrument, AllAreFound) {
    const auto found = acquire::find_instruments();
    ASSERT_EQ(found.size(), 2U);
    EXPECT_EQ(found[0].id, "NFLUX01");
    EXPECT_EQ(found[0].vendor, "nearfield");
    EXPECT_EQ(found[0].model, "VLUX");
    EXPECT_EQ(found[1].id, "NFPSU01");
    EXPECT_EQ(found[1].address, "usb 001:004");
}

TEST_F(UsbInstrument, OpensBySerialAndByNumbers) {
    EXPECT_EQ(Usbtmc("NFLUX01").identity(), "NEARFIELD,VLUX,NFLUX01,1");
    EXPECT_EQ(Usbtmc("cafe:0102").identity(), "NEARFIELD,VPSU,NFPSU01,1");
    EXPECT_THAT(complaint<DeviceLost>([] { Usbtmc("NFLUX02"); }),
                AllOf(HasSubstr("NFLUX01"), HasSubstr("NFPSU01")));
}

TEST_F(UsbInstrument, ReadsNumbers) {
    Usbtmc meter("NFLUX01");
    EXPECT_EQ(meter.number("MEAS:ILL?"), 123.5);
    EXPECT_THAT(complaint<Error>([&] { meter.number("*IDN?"); }), HasSubstr("a number"));
}

TEST_F(UsbInstrument, SaysWhatItRefuses) {
    Usbtmc meter("NFLUX01");
    meter.check_errors();
    meter.write("RANGE 7");
    EXPECT_THAT(complaint<Error>([&] { meter.check_errors(); }), HasSubstr("RANGE 7"));
    meter.check_errors();  // told once
}

TEST_F(UsbInstrument, AnswersInManySmallPieces) {
    lab_.luxmeter.faults.splits = true;
    Usbtmc meter("NFLUX01");
    EXPECT_EQ(meter.identity(), "NEARFIELD,VLUX,NFLUX01,1");
    EXPECT_EQ(meter.number("MEAS:ILL?"), 123.5);
}

TEST_F(UsbInstrument, ConfusedItIsClearedAndAskedAgain) {
    Usbtmc meter("NFLUX01");
    lab_.luxmeter.faults.wrong_tags = 1;
    EXPECT_EQ(meter.number("MEAS:ILL?"), 123.5);
    lab_.luxmeter.faults.stalled_answers = 1;
    EXPECT_EQ(meter.number("MEAS:ILL?"), 123.5);
    lab_.luxmeter.faults.silent_answers = 1;
    EXPECT_EQ(meter.number("MEAS:ILL?"), 123.5);
    lab_.luxmeter.faults.endless_answers = 2;  // asked again, the same: lost, and why
    EXPECT_THAT(complaint<DeviceLost>([&] { meter.query("MEAS:ILL?"); }),
                HasSubstr("an answer of 4294967295 bytes"));
}

TEST_F(UsbInstrument, SilentItIsLost) {
    Usbtmc meter("NFLUX01");
    lab_.luxmeter.faults.is_mute = true;
    EXPECT_THAT(complaint<DeviceLost>([&] { meter.query("MEAS:ILL?"); }),
                HasSubstr("does not answer"));
}

TEST_F(UsbInstrument, UnpluggedItIsLostAndPluggedInItWorksAgain) {
    {
        Usbtmc meter("NFLUX01");
        lab_.luxmeter_plug.unplug();
        EXPECT_THAT(complaint<DeviceLost>([&] { meter.query("MEAS:ILL?"); }), HasSubstr("NFLUX01"));
        EXPECT_THROW(Usbtmc("NFLUX01"), DeviceLost);
    }
    lab_.luxmeter_plug.plug_in();
    EXPECT_EQ(Usbtmc("NFLUX01").number("MEAS:ILL?"), 123.5);
}

}  // namespace
}  // namespace nearfield::devices
