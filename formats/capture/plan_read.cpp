// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/plan_fields.h"
#include "formats/capture/plan_words.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace nearfield::capture {
namespace {

int optional_integer(
    const JsonField& object, const std::string& key, int value, int least, int most) {
    return object.has(key) ? object.at(key).integer(least, most) : value;
}

std::map<std::string, int> controls_from(const JsonField& field) {
    std::map<std::string, int> controls;
    for (const std::string& name : field.keys())
        controls[name] = field.at(name).integer(std::numeric_limits<int>::min(),
                                                std::numeric_limits<int>::max());
    return controls;
}

CameraPlan camera_from(const JsonField& field) {
    field.only({"device", "pixel_format", "region_px", "gain_db", "packet_size_bytes", "byte_swap",
                "controls", "rgb_from_raw"});
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
    if (field.has("controls"))
        camera.controls = controls_from(field.at("controls"));
    if (field.has("rgb_from_raw")) {
        const std::vector<JsonField> numbers = field.at("rgb_from_raw").elements(9);
        for (int k = 0; k < 9; ++k)
            camera.rgb_from_raw[k % 3][k / 3] =
                number_within(numbers[static_cast<std::size_t>(k)], -100, 100);
    }
    return camera;
}

void read_filter(const JsonField& field, Plan& plan) {
    field.only({"columns", "rows", "pitch_m", "basis", "peak"});
    constexpr int kMostColumns = 512;
    plan.grid = {field.at("columns").integer(1, kMostColumns),
                 field.at("rows").integer(1, kMostColumns)};
    const std::vector<JsonField> pitch = field.at("pitch_m").elements(2);
    plan.pitch_m = {number_within(pitch[0], 1e-6, 10), number_within(pitch[1], 1e-6, 10)};
    plan.basis = field.at("basis").text();
    if (!field.has("peak"))
        return;
    constexpr double kDarkest = 1e-4;
    const JsonField peak = field.at("peak");
    if (peak.is_list()) {
        const std::vector<JsonField> channels = peak.elements(3);
        for (int k = 0; k < 3; ++k)
            plan.filter_peak[k] = number_within(channels[static_cast<std::size_t>(k)], kDarkest, 1);
    } else {
        plan.filter_peak = glm::dvec3(number_within(peak, kDarkest, 1));
    }
}

// Without a filter there are no positions, hence no bracket: nothing is metered.
BracketPlan bracket_from(const JsonField& plan) {
    BracketPlan bracket;
    bracket.is_auto = !plan.has("exposures_us") && plan.has("filter");
    if (plan.has("exposures_us"))
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

ScreenPlan screen_from(const JsonField& field) {
    field.only({"factor"});
    ScreenPlan screen;
    for (const JsonField& point : field.at("factor").elements()) {
        const std::vector<JsonField> pair = point.elements(2);
        screen.angle_deg.push_back(number_within(pair[0], 0, 90));
        screen.factor.push_back(number_within(pair[1], 0.01, 10));
        const std::size_t count = screen.angle_deg.size();
        if (count == 1 && (screen.angle_deg[0] != 0 || screen.factor[0] != 1))
            throw Error{"bad value", point.where(), "a factor of 1 at 0 degrees",
                        fmt::format("{} at {}", screen.factor[0], screen.angle_deg[0])};
        if (count > 1 && !(screen.angle_deg[count - 1] > screen.angle_deg[count - 2]))
            throw Error{"bad value", pair[0].where(), "angles in ascending order",
                        fmt::format("{} after {}", screen.angle_deg[count - 1],
                                    screen.angle_deg[count - 2])};
    }
    return screen;
}

PhotometerPlan photometer_from(const JsonField& field, const Plan& plan) {
    field.only({"on_screen_board_m", "correction", "sigma_rel", "mismatch_rel"});
    const bool has_screen_view =
        std::find(plan.views.begin(), plan.views.end(), TargetPlane::Screen) != plan.views.end();
    if (!plan.board || !has_screen_view)
        throw Error{"bad value", field.where(),
                    "targets.board and a view on the screen, in whose coordinates it lies",
                    plan.board ? "no view on the screen" : "no board"};
    PhotometerPlan photometer;
    const std::vector<JsonField> place = field.at("on_screen_board_m").elements(2);
    photometer.on_screen_board_m = {number_within(place[0], -100, 100),
                                    number_within(place[1], -100, 100)};
    photometer.correction = optional_number(field, "correction", 1, 0.1, 10);
    photometer.sigma_rel = number_within(field.at("sigma_rel"), 0, 1);
    photometer.mismatch_rel = number_within(field.at("mismatch_rel"), 0, 1);
    return photometer;
}

// A slip of the pen (512 x 512 positions, 1000 repeats) is refused before it fills memory and disk.
void check_frame_count(const Plan& plan, const std::string& where) {
    constexpr double kMostShots = 1e6;
    const auto count = [](std::size_t size) { return static_cast<double>(size); };
    const double series = count(plan.flat_exposures_us.size());
    const double shots = count(plan.bracket.exposures_us.size()) *
                             (static_cast<double>(plan.grid.x) * plan.grid.y * plan.repeats +
                              plan.blocked + plan.darks_after) +
                         (count(plan.bracket.exposures_us.size()) + series + 2) * plan.darks +
                         series * plan.flats;
    if (shots > kMostShots)
        throw Error{"plan too large", where, fmt::format("at most {:g} frames", kMostShots),
                    fmt::format("{:g}", shots)};
}

// Without a bracket there is no middle exposure to fall back to.
void check_exposures(const Plan& plan, const std::string& where) {
    if (plan.grid.x > 0 || !plan.bracket.exposures_us.empty())
        return;
    if (!plan.views.empty() && plan.target_exposure_us == 0)
        throw Error{"bad value", where + ".targets", "exposure_us, where there is no filter",
                    "none"};
    if (plan.flats > 0 && plan.flat_exposures_us.empty())
        throw Error{"bad value", where + ".flats", "exposures_us, where there is no filter",
                    "none"};
    if (plan.views.empty() && plan.flats == 0)
        throw Error{"bad value", where, "a filter, targets or flats", "nothing to take"};
}

}  // namespace

Plan plan_from(const JsonField& document) {
    const int version = document.at("nearfield_plan").integer(0, 1 << 30);
    if (version < 1 || version > kPlanVersion)
        throw Error{"cannot read plan", document.where() + ".nearfield_plan",
                    fmt::format("version 1 ... {}", kPlanVersion), fmt::format("{}", version)};
    document.only({"nearfield_plan", "camera", "stage", "instruments", "filter", "filter_views",
                   "exposures_us", "bracket", "repeats", "darks_per_exposure",
                   "darks_after_per_exposure", "blocked_per_exposure", "flats", "targets", "screen",
                   "photometer", "drift", "exposure_ratio_limit_rel", "settle_s"});
    Plan plan;
    if (document.has("camera"))
        plan.camera = camera_from(document.at("camera"));
    plan.stage = meaning_of(kStages, document.at("stage"));
    if (document.has("instruments"))
        plan.instruments = instruments_from(document.at("instruments"));
    if (document.has("filter"))
        read_filter(document.at("filter"), plan);
    plan.bracket = bracket_from(document);
    plan.repeats = optional_integer(document, "repeats", plan.repeats, 1, kMostFrames);
    plan.darks = optional_integer(document, "darks_per_exposure", plan.darks, 0, kMostFrames);
    plan.darks_after =
        optional_integer(document, "darks_after_per_exposure", plan.darks_after, 0, kMostFrames);
    plan.blocked = optional_integer(document, "blocked_per_exposure", 0, 0, kMostFrames);
    if (document.has("flats"))
        read_flats(document.at("flats"), plan);
    if (document.has("targets"))
        read_targets(document.at("targets"), plan);
    if (document.has("filter_views"))
        read_filter_views(document.at("filter_views"), plan);
    if (document.has("screen"))
        plan.screen = screen_from(document.at("screen"));
    if (document.has("photometer"))
        plan.photometer = photometer_from(document.at("photometer"), plan);
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
    Plan plan = plan_from({parse_json(read_file(path), path), path});
    check_exposures(plan, path);
    return plan;
}

}  // namespace nearfield::capture
