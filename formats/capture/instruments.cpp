// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/instruments.h"

#include "formats/capture/plan_fields.h"
#include "formats/files/error.h"

#include <fmt/format.h>

namespace nearfield::capture {
namespace {

constexpr double kLongest_mm = 1e4, kLongest_s = 86400;

int direction_from(const JsonField& field) {
    const int direction = field.integer(-1, 1);
    if (direction == 0)
        throw Error{"bad value", field.where(), "1 or -1", "0"};
    return direction;
}

GcodeStagePlan stage_from(const JsonField& field) {
    field.only({"device", "first_position_mm", "direction", "feed_mm_per_min", "tolerance_mm"});
    GcodeStagePlan stage;
    stage.device = field.at("device").text();
    const std::vector<JsonField> first = field.at("first_position_mm").elements(2);
    stage.first_position_mm = {number_within(first[0], -kLongest_mm, kLongest_mm),
                               number_within(first[1], -kLongest_mm, kLongest_mm)};
    if (field.has("direction")) {
        const std::vector<JsonField> direction = field.at("direction").elements(2);
        stage.direction = {direction_from(direction[0]), direction_from(direction[1])};
    }
    stage.feed_mm_per_min =
        optional_number(field, "feed_mm_per_min", stage.feed_mm_per_min, 1, 1e5);
    stage.tolerance_mm = optional_number(field, "tolerance_mm", stage.tolerance_mm, 1e-4, 10);
    return stage;
}

LuxmeterPlan luxmeter_from(const JsonField& field) {
    field.only({"device", "query", "lx_per_unit"});
    LuxmeterPlan luxmeter;
    luxmeter.device = field.at("device").text();
    if (field.has("query"))
        luxmeter.query = field.at("query").text();
    luxmeter.lx_per_unit = optional_number(field, "lx_per_unit", 1, 1e-12, 1e12);
    return luxmeter;
}

SupplyPlan supply_from(const JsonField& field) {
    field.only({"device", "voltage_v", "current_limit_a", "warm_limit_rel", "warm_window_s",
                "warm_most_s"});
    SupplyPlan supply;
    supply.device = field.at("device").text();
    supply.voltage_v = number_within(field.at("voltage_v"), 0.1, 1000);
    supply.current_limit_a = number_within(field.at("current_limit_a"), 1e-3, 1000);
    supply.warm_limit_rel =
        optional_number(field, "warm_limit_rel", supply.warm_limit_rel, 1e-6, 1);
    supply.warm_window_s =
        optional_number(field, "warm_window_s", supply.warm_window_s, 0.1, kLongest_s);
    supply.warm_most_s =
        optional_number(field, "warm_most_s", supply.warm_most_s, supply.warm_window_s, kLongest_s);
    return supply;
}

Json json_of(const GcodeStagePlan& stage) {
    return {{"device", stage.device},
            {"first_position_mm", {stage.first_position_mm.x, stage.first_position_mm.y}},
            {"direction", {stage.direction.x, stage.direction.y}},
            {"feed_mm_per_min", stage.feed_mm_per_min},
            {"tolerance_mm", stage.tolerance_mm}};
}

Json json_of(const LuxmeterPlan& luxmeter) {
    return {{"device", luxmeter.device},
            {"query", luxmeter.query},
            {"lx_per_unit", luxmeter.lx_per_unit}};
}

Json json_of(const SupplyPlan& supply) {
    return {{"device", supply.device},
            {"voltage_v", supply.voltage_v},
            {"current_limit_a", supply.current_limit_a},
            {"warm_limit_rel", supply.warm_limit_rel},
            {"warm_window_s", supply.warm_window_s},
            {"warm_most_s", supply.warm_most_s}};
}

}  // namespace

InstrumentsPlan instruments_from(const JsonField& field) {
    field.only({"stage", "luxmeter", "supply"});
    InstrumentsPlan instruments;
    if (field.has("stage"))
        instruments.stage = stage_from(field.at("stage"));
    if (field.has("luxmeter"))
        instruments.luxmeter = luxmeter_from(field.at("luxmeter"));
    if (field.has("supply"))
        instruments.supply = supply_from(field.at("supply"));
    return instruments;
}

Json json_of(const InstrumentsPlan& instruments) {
    Json json = Json::object();
    if (instruments.stage)
        json["stage"] = json_of(*instruments.stage);
    if (instruments.luxmeter)
        json["luxmeter"] = json_of(*instruments.luxmeter);
    if (instruments.supply)
        json["supply"] = json_of(*instruments.supply);
    return json;
}

}  // namespace nearfield::capture
