// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/instruments.h"

#include "formats/capture/plan.h"
#include "formats/capture/records.h"
#include "formats/files/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace nearfield::capture {
namespace {

constexpr const char* kInstruments = R"({
  "stage": {"device": "/dev/ttyUSB0", "first_position_mm": [-150, -20], "direction": [1, -1],
            "feed_mm_per_min": 900, "tolerance_mm": 0.05},
  "luxmeter": {"device": "NFLUX01", "query": "READ?", "lx_per_unit": 1000},
  "supply": {"device": "1234:5678", "voltage_v": 13.2, "current_limit_a": 6,
             "warm_limit_rel": 0.001, "warm_window_s": 30, "warm_most_s": 600}
})";

InstrumentsPlan instruments_of(const std::string& text) {
    const Json document = parse_json(text, "plan.json");
    return instruments_from({document, "plan.json.instruments"});
}

std::string with(const std::string& old_text, const std::string& new_text) {
    std::string text = kInstruments;
    text.replace(text.find(old_text), old_text.size(), new_text);
    return text;
}

TEST(Instruments, AreRead) {
    const InstrumentsPlan instruments = instruments_of(kInstruments);
    EXPECT_EQ(instruments.stage->device, "/dev/ttyUSB0");
    EXPECT_EQ(instruments.stage->first_position_mm, glm::dvec2(-150, -20));
    EXPECT_EQ(instruments.stage->direction, glm::ivec2(1, -1));
    EXPECT_EQ(instruments.luxmeter->query, "READ?");
    EXPECT_EQ(instruments.luxmeter->lx_per_unit, 1000);
    EXPECT_EQ(instruments.supply->voltage_v, 13.2);
    EXPECT_EQ(instruments.supply->warm_window_s, 30);
    EXPECT_TRUE(instruments_of("{}").empty());
}

TEST(Instruments, SurviveTheirOwnText) {
    const Json once = json_of(instruments_of(kInstruments));
    EXPECT_EQ(once, json_of(instruments_of(once.dump())));
    EXPECT_EQ(once, parse_json(kInstruments, ""));
}

TEST(Instruments, AreRefusedWhereTheyAreWrong) {
    const auto complaint = [](const std::string& text) -> std::string {
        try {
            instruments_of(text);
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_THAT(complaint(with("[1, -1]", "[1, 0]")), testing::HasSubstr("direction[1]"));
    EXPECT_THAT(complaint(with("\"tolerance_mm\"", "\"tolerance\"")),
                testing::HasSubstr("'tolerance'"));
    EXPECT_THAT(complaint(with("\"voltage_v\": 13.2, ", "")), testing::HasSubstr("voltage_v"));
    EXPECT_THAT(complaint(with("\"warm_most_s\": 600", "\"warm_most_s\": 6")),
                testing::HasSubstr("warm_most_s"));
    EXPECT_THAT(complaint(R"({"robot": {}})"), testing::HasSubstr("'robot'"));
}

TEST(Instruments, AreAPartOfThePlan) {
    const std::string text = R"({"nearfield_plan": 2, "stage": "manual", "exposures_us": [5],
        "camera": {"device": "/dev/video0", "controls": {"gain": 3, "gamma": -1}},
        "instruments": )" + std::string(kInstruments) +
                             "}";
    const Json document = parse_json(text, "plan.json");
    const Plan plan = plan_from({document, "plan.json"});
    EXPECT_TRUE(plan.instruments.stage.has_value());
    EXPECT_EQ(plan.camera.controls.at("gamma"), -1);
    const Json again = json_of(plan);
    EXPECT_EQ(again["instruments"], document["instruments"]);
    EXPECT_EQ(again["camera"]["controls"], document["camera"]["controls"]);
}

TEST(InstrumentReadings, SurviveTheLog) {
    FrameRecord frame;
    frame.file = "frames/a.png";
    frame.size_px = {4, 3};
    frame.lamp_voltage_v = 12.01;
    frame.lamp_current_a = 4.5;
    frame.stage_mm = glm::dvec2(-150, 3.25);
    const Json line = json_of(frame);
    const FrameRecord again = frame_from({line, "log"});
    EXPECT_EQ(again.lamp_voltage_v, frame.lamp_voltage_v);
    EXPECT_EQ(again.lamp_current_a, frame.lamp_current_a);
    EXPECT_EQ(again.stage_mm, frame.stage_mm);
    SessionRecord session;
    session.instruments = {"stage: Grbl 1.1h", "luxmeter: A,B,C,D"};
    const Json session_line = json_of(session);
    EXPECT_EQ(session_from({session_line, "log"}).instruments, session.instruments);
}

// As version 1 wrote them.
TEST(InstrumentReadings, AreNotInOldCaptures) {
    Json line = json_of(SessionRecord{});
    line.erase("instruments");
    EXPECT_TRUE(session_from({line, "log"}).instruments.empty());
    FrameRecord frame;
    frame.file = "frames/a.png";
    frame.size_px = {4, 3};
    const Json old = json_of(frame);
    EXPECT_FALSE(old.contains("stage_mm") || old.contains("lamp_voltage_v"));
    EXPECT_FALSE(frame_from({old, "log"}).stage_mm.has_value());
}

}  // namespace
}  // namespace nearfield::capture
