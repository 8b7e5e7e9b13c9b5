// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/plan_fields.h"
#include "formats/capture/plan_words.h"
#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::capture {
namespace {

double exposure_of(const JsonField& series) {
    return optional_number(series, "exposure_us", 0, 0.1, kLongest_us);
}

}  // namespace

double number_within(const JsonField& field, double least, double most) {
    const double value = field.number();
    if (!(value >= least && value <= most))
        throw Error{"bad value", field.where(), fmt::format("{} ... {}", least, most),
                    fmt::format("{}", value)};
    return value;
}

double optional_number(
    const JsonField& object, const std::string& key, double value, double least, double most) {
    return object.has(key) ? number_within(object.at(key), least, most) : value;
}

std::vector<double> exposures_from(const JsonField& field) {
    std::vector<double> exposures_us;
    for (const JsonField& exposure : field.elements()) {
        exposures_us.push_back(number_within(exposure, 0.1, kLongest_us));
        if (exposures_us.size() > 1 &&
            !(exposures_us.back() > exposures_us[exposures_us.size() - 2]))
            throw Error{"bad value", exposure.where(), "exposures in ascending order",
                        fmt::format("{} after {}", exposures_us.back(),
                                    exposures_us[exposures_us.size() - 2])};
    }
    if (exposures_us.empty())
        throw Error{"bad value", field.where(), "at least one exposure", "none"};
    return exposures_us;
}

void read_flats(const JsonField& field, Plan& plan) {
    field.only({"count", "exposure_us", "exposures_us"});
    plan.flats = field.at("count").integer(0, kMostFrames);
    if (field.has("exposure_us") && field.has("exposures_us"))
        throw Error{"bad value", field.where(), "exposure_us or exposures_us", "both"};
    if (field.has("exposures_us"))
        plan.flat_exposures_us = exposures_from(field.at("exposures_us"));
    else if (field.has("exposure_us"))
        plan.flat_exposures_us = {exposure_of(field)};
}

void read_targets(const JsonField& field, Plan& plan) {
    field.only({"board", "count", "views", "exposure_us"});
    if (field.has("count") == field.has("views"))
        throw Error{"bad value", field.where(), "count or views",
                    field.has("count") ? "both" : "neither"};
    if (field.has("count"))
        plan.views.assign(static_cast<std::size_t>(field.at("count").integer(0, kMostFrames)),
                          TargetPlane::Free);
    else
        for (const JsonField& view : field.at("views").elements())
            plan.views.push_back(meaning_of(kTargetPlanes, view));
    if (plan.views.size() > kMostFrames)
        throw Error{"bad value", field.where() + ".views",
                    fmt::format("at most {} views", kMostFrames),
                    fmt::format("{}", plan.views.size())};
    if (field.has("board"))
        plan.board = board_from(field.at("board"));
    plan.target_exposure_us = exposure_of(field);
}

void read_filter_views(const JsonField& field, Plan& plan) {
    field.only({"positions", "exposure_us"});
    if (plan.grid.x == 0)
        throw Error{"bad value", field.where(), "a filter", "none"};
    std::vector<glm::ivec2>& positions = plan.filter_views.positions;
    for (const JsonField& position : field.at("positions").elements()) {
        const std::vector<JsonField> place = position.elements(2);
        positions.emplace_back(place[0].integer(0, plan.grid.x - 1),
                               place[1].integer(0, plan.grid.y - 1));
        if (std::find(positions.begin(), positions.end() - 1, positions.back()) !=
            positions.end() - 1)
            throw Error{"bad value", position.where(), "every position at most once",
                        fmt::format("{} {} again", positions.back().x, positions.back().y)};
    }
    plan.filter_views.exposure_us = exposure_of(field);
}

}  // namespace nearfield::capture
