// SPDX-License-Identifier: Apache-2.0
#include "acquire/lamp_supply.h"
#include "formats/files/provenance.h"
#include "tests/devices/test_lab.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::devices {
namespace {

using acquire::LampSupply;
using acquire::SteadyCheck;
using testing::HasSubstr;

capture::SupplyPlan supply_plan() {
    capture::SupplyPlan plan;
    plan.device = "NFPSU01";
    plan.voltage_v = 12;
    plan.current_limit_a = 6;
    plan.warm_window_s = 0.1;
    plan.warm_most_s = 20;
    return plan;
}

Mounting with_warm_up(double warm_up_rel, double warm_up_s) {
    Mounting mounting = test_mounting();
    mounting.warm_up_rel = warm_up_rel;
    mounting.warm_up_s = warm_up_s;
    return mounting;
}

// An exponential's change over a window w at time t is a (e^((w - t) / tau) - e^(-t / tau)).
TEST(SteadyLamp, IsWaitedForAsLongAsItsDriftSays) {
    SteadyCheck check(0.002, 60);
    double time_s = 0;
    for (; !check.is_steady(); time_s += 3)
        check.add(time_s, 100 * (1 + 0.1 * std::exp(-time_s / 300)));
    const double expected_s = 300 * std::log(0.1 * (std::exp(60. / 300) - 1) / 0.002);
    EXPECT_NEAR(time_s, expected_s, 9);  // steps of 3 s, and the mean is not the final value
}

TEST(SteadyLamp, NeedsTheWholeWindow) {
    SteadyCheck check(0.01, 10);
    for (int k = 0; k < 10; ++k) {
        check.add(k, 5);
        EXPECT_FALSE(check.is_steady()) << k;
    }
    check.add(10, 5);
    EXPECT_TRUE(check.is_steady());
}

TEST(Supply, SwitchesTheLampAndReadsIt) {
    VirtualLab lab(test_bench(), test_mounting(), true);
    LampSupply supply(supply_plan());
    EXPECT_FALSE(lab.state.stage().lamp_on);
    supply.set_lamp(
        true, [&] { return supply.current_a(); }, never);
    EXPECT_TRUE(lab.state.stage().lamp_on);
    EXPECT_EQ(supply.voltage_v(), 12);
    EXPECT_EQ(supply.current_a(), 4.5);
    supply.set_lamp(
        false, [&] { return supply.current_a(); }, never);
    EXPECT_FALSE(lab.state.stage().lamp_on);
    EXPECT_EQ(supply.current_a(), 0);
}

TEST(Supply, LeavesTheLampOff) {
    VirtualLab lab(test_bench(), test_mounting(), true);
    LampSupply(supply_plan())
        .set_lamp(
            true, [] { return 1.0; }, never);
    EXPECT_FALSE(lab.state.stage().lamp_on);
}

TEST(Supply, WaitsUntilTheLampIsWarm) {
    VirtualLab lab(test_bench(), with_warm_up(0.2, 0.3), true);
    LampSupply supply(supply_plan());
    supply.set_lamp(
        true, [&] { return supply.current_a(); }, never);
    // A change of 0.2 % in a third of the time constant leaves 0.2 % / (e^(1/3) - 1).
    EXPECT_LT(supply.current_a(), 4.5 * (1 + 0.002 / (std::exp(1. / 3) - 1) + 1e-4));
}

// Nobody knows how long the lamp was dark while its supply was away. A lamp that stayed warm costs
// one window, a cold one the time that it needs.
TEST(Supply, WarmsTheLampUpAgainAfterItWasAway) {
    constexpr double kWarmUp_s = 0.3;
    VirtualLab lab(test_bench(), with_warm_up(0.2, kWarmUp_s), true);
    const capture::SupplyPlan plan = supply_plan();
    for (const bool is_unplugged : {false, true}) {
        LampSupply supply(plan);
        const double start_s = now_s();
        supply.set_lamp(
            true, [&] { return supply.current_a(); }, never);
        EXPECT_GE(now_s() - start_s, plan.warm_window_s);
        EXPECT_LT(supply.current_a(), 4.5 * (1 + 0.002 / (std::exp(1. / 3) - 1) + 1e-4));
        if (!is_unplugged) {
            lab.supply_plug.unplug();
            EXPECT_THROW(supply.current_a(), acquire::DeviceLost);
            lab.state.set_lamp(false, 0);  // the mains plug too
            lab.supply_plug.plug_in();
        }
    }
}

TEST(Supply, SaysThatALampDoesNotGetSteady) {
    VirtualLab lab(test_bench(), test_mounting(), true);
    capture::SupplyPlan plan = supply_plan();
    plan.warm_most_s = 0.5;
    LampSupply supply(plan);
    double reading = 1;
    EXPECT_THAT(complaint<Error>([&] {
                    supply.set_lamp(
                        true, [&reading] { return reading *= 1.05; }, never);
                }),
                HasSubstr("does not get steady"));
}

TEST(Supply, NamesALampThatDrawsTheLimit) {
    VirtualLab lab(test_bench(), test_mounting(), true);
    capture::SupplyPlan plan = supply_plan();
    plan.current_limit_a = 3;
    LampSupply supply(plan);
    EXPECT_THAT(complaint<Error>([&] {
                    supply.set_lamp(
                        true, [] { return 1.0; }, never);
                }),
                HasSubstr("limit's current"));
}

TEST(Supply, RefusesAVoltageThatItCannotGive) {
    VirtualLab lab(test_bench(), test_mounting(), true);
    capture::SupplyPlan plan = supply_plan();
    plan.voltage_v = 100;
    EXPECT_THAT(complaint<Error>([&] { LampSupply supply(plan); }), HasSubstr("VOLT 100"));
}

TEST(Supply, CtrlCEndsTheWarmUp) {
    VirtualLab lab(test_bench(), test_mounting(), true);
    capture::SupplyPlan plan = supply_plan();
    plan.warm_window_s = 1000;
    plan.warm_most_s = 2000;
    LampSupply supply(plan);
    int looks = 0;
    EXPECT_THROW(supply.set_lamp(
                     true, [] { return 1.0; }, [&looks] { return ++looks > 3; }),
                 acquire::Stopped);
}

}  // namespace
}  // namespace nearfield::devices
