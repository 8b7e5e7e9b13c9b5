// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/plan.h"

#include "formats/capture/words.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::capture {
namespace {

constexpr double kLongest_us = 600e6;  // ten minutes: a slip of the pen beyond
constexpr int kMostFrames = 1000;      // of one kind at one place

constexpr Words<StageKind, 2> kStages{
    {{"manual", StageKind::Manual}, {"camera", StageKind::Camera}}};

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

int optional_integer(
    const JsonField& object, const std::string& key, int value, int least, int most) {
    return object.has(key) ? object.at(key).integer(least, most) : value;
}

CameraPlan camera_from(const JsonField& field) {
    field.only(
        {"device", "pixel_format", "region_px", "gain_db", "packet_size_bytes", "byte_swap"});
    CameraPlan camera;
    if (field.has("device"))
        camera.device = field.at("device").text();
    if (field.has("pixel_format"))
        camera.pixel_format = field.at("pixel_format").text();
    if (field.has("region_px")) {
        const std::vector<JsonField> region = field.at("region_px").elements(4);
        const auto pixel = [&](std::size_t k) { return region[k].integer(k < 2 ? 0 : 1, 65535); };
        camera.region_min_px = {pixel(0), pixel(1)};
        camera.region_size_px = {pixel(2), pixel(3)};
    }
    camera.gain_db = optional_number(field, "gain_db", 0, -60, 60);
    camera.packet_size_bytes = optional_integer(field, "packet_size_bytes", 0, 0, 65535);
    if (field.has("byte_swap"))
        camera.is_byte_swapped = field.at("byte_swap").boolean();
    return camera;
}

void read_filter(const JsonField& field, Plan& plan) {
    field.only({"columns", "rows", "pitch_m", "basis"});
    constexpr int kMostColumns = 512;
    plan.grid = {field.at("columns").integer(1, kMostColumns),
                 field.at("rows").integer(1, kMostColumns)};
    const std::vector<JsonField> pitch = field.at("pitch_m").elements(2);
    plan.pitch_m = {number_within(pitch[0], 1e-6, 10), number_within(pitch[1], 1e-6, 10)};
    plan.basis = field.at("basis").text();
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

BracketPlan bracket_from(const JsonField& plan) {
    BracketPlan bracket;
    bracket.is_auto = !plan.has("exposures_us");
    if (!bracket.is_auto)
        bracket.exposures_us = exposures_from(plan.at("exposures_us"));
    if (!plan.has("bracket"))
        return bracket;
    const JsonField field = plan.at("bracket");
    field.only({"least_us", "most_us", "darkest_share"});
    bracket.least_us = optional_number(field, "least_us", bracket.least_us, 0.1, kLongest_us);
    bracket.most_us =
        optional_number(field, "most_us", bracket.most_us, bracket.least_us, kLongest_us);
    bracket.darkest_share = optional_number(field, "darkest_share", bracket.darkest_share, 1e-9, 1);
    return bracket;
}

// Count and exposure of a kind of shot: {"count": 4, "exposure_us": 2000}.
void read_series(const JsonField& plan, const std::string& key, int& count, double& exposure_us) {
    if (!plan.has(key))
        return;
    const JsonField field = plan.at(key);
    field.only({"count", "exposure_us"});
    count = field.at("count").integer(0, kMostFrames);
    exposure_us = optional_number(field, "exposure_us", 0, 0.1, kLongest_us);
}

std::vector<Shot> lights_of(const Plan& plan) {
    std::vector<Shot> shots;
    const std::vector<double>& exposures_us = plan.bracket.exposures_us;
    const double middle_us = exposures_us[exposures_us.size() / 2];
    for (int k = 0; k < plan.grid.x * plan.grid.y; ++k) {
        if (plan.drift_every > 0 && k % plan.drift_every == 0)
            shots.push_back(
                {0, ShotKind::Reference, plan.grid / 2, -1, middle_us, k / plan.drift_every});
        const int row = k / plan.grid.x, step = k % plan.grid.x;
        const glm::ivec2 position{row % 2 == 0 ? step : plan.grid.x - 1 - step, row};
        for (const double exposure_us : exposures_us)
            for (int repeat = 0; repeat < plan.repeats; ++repeat)
                shots.push_back({0, ShotKind::Light, position, -1, exposure_us, repeat});
    }
    return shots;
}

constexpr Words<ShotKind, 5> kShotKinds{{{"target", ShotKind::Target},
                                         {"flat", ShotKind::Flat},
                                         {"dark", ShotKind::Dark},
                                         {"light", ShotKind::Light},
                                         {"reference", ShotKind::Reference}}};

// A slip of the pen (512 x 512 positions, 1000 repeats) is refused before it fills memory and disk.
void check_frame_count(const Plan& plan, const std::string& where) {
    constexpr double kMostShots = 1e6;
    const auto exposures = static_cast<double>(plan.bracket.exposures_us.size());
    const double shots =
        exposures * (static_cast<double>(plan.grid.x) * plan.grid.y * plan.repeats + plan.darks);
    if (shots > kMostShots)
        throw Error{"plan too large", where, fmt::format("at most {:g} frames", kMostShots),
                    fmt::format("{:g}", shots)};
}

}  // namespace

std::string word_of(ShotKind kind) {
    return word_for(kShotKinds, kind);
}

ShotKind shot_kind_from(const JsonField& word) {
    return meaning_of(kShotKinds, word);
}

std::string name_of(const Shot& shot) {
    std::string name = word_of(shot.kind);
    if (shot.view >= 0)
        name += fmt::format("_v{:03}", shot.view);
    if (shot.position.x >= 0)
        name += fmt::format("_x{:03}_y{:03}", shot.position.x, shot.position.y);
    return name + fmt::format("_{:.4g}us_r{:03}", shot.exposure_us, shot.repeat);
}

Plan plan_from(const JsonField& document) {
    const int version = document.at("nearfield_plan").integer(0, 1 << 30);
    if (version != kPlanVersion)
        throw Error{"cannot read plan", document.where() + ".nearfield_plan",
                    fmt::format("version {}", kPlanVersion), fmt::format("{}", version)};
    document.only({"nearfield_plan", "camera", "stage", "filter", "exposures_us", "bracket",
                   "repeats", "darks_per_exposure", "flats", "targets", "drift",
                   "exposure_ratio_limit_rel", "settle_s"});
    Plan plan;
    if (document.has("camera"))
        plan.camera = camera_from(document.at("camera"));
    plan.stage = meaning_of(kStages, document.at("stage"));
    read_filter(document.at("filter"), plan);
    plan.bracket = bracket_from(document);
    plan.repeats = optional_integer(document, "repeats", plan.repeats, 1, kMostFrames);
    plan.darks = optional_integer(document, "darks_per_exposure", plan.darks, 0, kMostFrames);
    read_series(document, "flats", plan.flats, plan.flat_exposure_us);
    read_series(document, "targets", plan.target_views, plan.target_exposure_us);
    if (document.has("drift")) {
        const JsonField drift = document.at("drift");
        drift.only({"every", "limit_rel"});
        plan.drift_every = drift.at("every").integer(0, 1 << 20);
        plan.drift_limit_rel = optional_number(drift, "limit_rel", plan.drift_limit_rel, 1e-6, 10);
    }
    plan.ratio_limit_rel =
        optional_number(document, "exposure_ratio_limit_rel", plan.ratio_limit_rel, 1e-6, 10);
    plan.settle_s = optional_number(document, "settle_s", 0, 0, 3600);
    check_frame_count(plan, document.where());
    return plan;
}

Plan read_plan(const std::string& path) {
    return plan_from({parse_json(read_file(path), path), path});
}

Json json_of(const Plan& plan) {
    Json document = {{"nearfield_plan", kPlanVersion},
                     {"camera",
                      {{"device", plan.camera.device},
                       {"pixel_format", plan.camera.pixel_format},
                       {"gain_db", plan.camera.gain_db},
                       {"packet_size_bytes", plan.camera.packet_size_bytes},
                       {"byte_swap", plan.camera.is_byte_swapped}}},
                     {"stage", word_for(kStages, plan.stage)},
                     {"filter",
                      {{"columns", plan.grid.x},
                       {"rows", plan.grid.y},
                       {"pitch_m", {plan.pitch_m.x, plan.pitch_m.y}},
                       {"basis", plan.basis}}},
                     {"repeats", plan.repeats},
                     {"darks_per_exposure", plan.darks},
                     {"drift", {{"every", plan.drift_every}, {"limit_rel", plan.drift_limit_rel}}},
                     {"exposure_ratio_limit_rel", plan.ratio_limit_rel},
                     {"settle_s", plan.settle_s}};
    const auto series = [](int count, double exposure_us) {
        Json value = {{"count", count}};
        if (exposure_us > 0)
            value["exposure_us"] = exposure_us;
        return value;
    };
    document["flats"] = series(plan.flats, plan.flat_exposure_us);
    document["targets"] = series(plan.target_views, plan.target_exposure_us);
    if (plan.camera.region_size_px.x > 0)
        document["camera"]["region_px"] = {plan.camera.region_min_px.x, plan.camera.region_min_px.y,
                                           plan.camera.region_size_px.x,
                                           plan.camera.region_size_px.y};
    if (!plan.bracket.exposures_us.empty())
        document["exposures_us"] = plan.bracket.exposures_us;
    document["bracket"] = {{"least_us", plan.bracket.least_us},
                           {"most_us", plan.bracket.most_us},
                           {"darkest_share", plan.bracket.darkest_share}};
    return document;
}

std::vector<Shot> shots_of(const Plan& plan) {
    std::vector<Shot> shots;
    const std::vector<double>& exposures_us = plan.bracket.exposures_us;
    const double middle_us = exposures_us.at(exposures_us.size() / 2);
    const auto exposure_or_middle = [middle_us](double exposure_us) {
        return exposure_us > 0 ? exposure_us : middle_us;
    };
    shots.reserve(static_cast<std::size_t>(plan.target_views));
    for (int view = 0; view < plan.target_views; ++view)
        shots.push_back({0, ShotKind::Target, glm::ivec2(-1), view,
                         exposure_or_middle(plan.target_exposure_us), 0});
    for (int repeat = 0; repeat < plan.flats; ++repeat)
        shots.push_back({0, ShotKind::Flat, glm::ivec2(-1), -1,
                         exposure_or_middle(plan.flat_exposure_us), repeat});
    std::vector<double> dark_exposures_us = exposures_us;
    for (const auto& [count, exposure_us] : {std::pair{plan.target_views, plan.target_exposure_us},
                                             std::pair{plan.flats, plan.flat_exposure_us}})
        if (count > 0 && exposure_us > 0 &&
            std::find(dark_exposures_us.begin(), dark_exposures_us.end(), exposure_us) ==
                dark_exposures_us.end())
            dark_exposures_us.push_back(exposure_us);
    for (const double exposure_us : dark_exposures_us)
        for (int repeat = 0; repeat < plan.darks; ++repeat)
            shots.push_back({0, ShotKind::Dark, glm::ivec2(-1), -1, exposure_us, repeat});
    const std::vector<Shot> lights = lights_of(plan);
    shots.insert(shots.end(), lights.begin(), lights.end());
    for (std::size_t k = 0; k < shots.size(); ++k)
        shots[k].number = static_cast<int>(k);
    return shots;
}

double estimate_time_s(const Plan& plan, const std::vector<Shot>& shots, double overhead_s) {
    double time_s = 0;
    glm::ivec2 position{-1};
    for (const Shot& shot : shots) {
        time_s += shot.exposure_us * 1e-6 + overhead_s;
        if (shot.position != position)
            time_s += plan.settle_s;
        position = shot.position;
    }
    return time_s;
}

std::vector<double> bracket_of(const BracketPlan& plan,
                               double brightest_per_us,
                               double low,
                               double high) {
    // A pixel is well exposed over a range of high / low in exposure; steps of its root put two
    // exposures into it wherever it lies.
    const double step = std::sqrt(high / low);
    const double shortest_us = high / brightest_per_us / step;
    // Where all is equally bright, two exposures still differ, so that their ratio can be checked.
    const double longest_us = std::max(low / (brightest_per_us * plan.darkest_share) * step,
                                       shortest_us * std::sqrt(step));
    if (shortest_us < plan.least_us || longest_us > plan.most_us)
        throw Error{
            "no bracket exposes every pixel well twice",
            fmt::format(
                "brightest pixel saturates after {:.3g} us, darkest of interest is {:g} of it",
                1 / brightest_per_us, plan.darkest_share),
            fmt::format("exposures within {:g} ... {:g} us", plan.least_us, plan.most_us),
            fmt::format("{:.3g} ... {:.3g} us needed", shortest_us, longest_us)};
    const int steps = std::max(
        1, static_cast<int>(std::ceil(std::log(longest_us / shortest_us) / std::log(step) - 1e-9)));
    std::vector<double> exposures_us;
    for (int k = 0; k <= steps; ++k)
        exposures_us.push_back(shortest_us *
                               std::pow(longest_us / shortest_us, static_cast<double>(k) / steps));
    return exposures_us;
}

}  // namespace nearfield::capture
