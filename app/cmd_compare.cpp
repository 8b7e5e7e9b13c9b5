// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/lamp_input.h"
#include "app/options.h"
#include "app/output.h"
#include "formats/farfield/align.h"
#include "formats/farfield/compare.h"
#include "formats/files/provenance.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>
#include <numbers>

namespace nearfield::app {
namespace {

using farfield::Comparison;
using farfield::Differences;
using nlohmann::ordered_json;

struct CompareCommand {
    std::string a, b;
    bool align = false, json = false;
    farfield::CompareOptions options;
};

struct Turn {
    glm::dvec3 axis{0, 0, 1};
    double angle_deg = 0;
};

Turn turn_of(const glm::dmat3& rotation) {
    const glm::dquat q = glm::normalize(glm::quat_cast(rotation));
    const glm::dvec3 v(q.x, q.y, q.z);
    const double length = glm::length(v);
    if (length == 0)
        return {};
    return {v / length, 2 * std::atan2(length, q.w) * 180 / std::numbers::pi};
}

std::string differences_text(const Differences& d) {
    std::string text =
        fmt::format("mean {:+.2f} %, median {:.2f} %, 95 % below {:.2f} %, RMS {:.2f} %",
                    100 * d.mean_rel, 100 * d.median_rel, 100 * d.p95_rel, 100 * d.rms_rel);
    if (d.rms_in_sigmas > 0)
        text +=
            fmt::format("; {:.2f} sigmas RMS (sigma {:.2f} %)", d.rms_in_sigmas, 100 * d.sigma_rel);
    return text;
}

std::string comparison_text(const CompareCommand& command,
                            const Comparison& result,
                            const Rigid& a_from_b) {
    std::string text = fmt::format("flux       {:.6g} and {:.6g}: {:+.3f} %", result.flux_a,
                                   result.flux_b, 100 * (result.flux_b / result.flux_a - 1));
    const double sigma = std::hypot(result.flux_a_sigma, result.flux_b_sigma);
    if (sigma > 0)
        text += fmt::format(", {:+.2f} sigmas", (result.flux_b - result.flux_a) / sigma);
    if (command.align) {
        const Turn turn = turn_of(a_from_b.rotation);
        const glm::dvec3 t_mm = 1e3 * a_from_b.translation_m;
        text += fmt::format(
            "\naligned    B turned by {:.3f} deg about ({:.3f}, {:.3f}, {:.3f}), moved by ({:.3f}, "
            "{:.3f}, {:.3f}) mm",
            turn.angle_deg, turn.axis.x, turn.axis.y, turn.axis.z, t_mm.x, t_mm.y, t_mm.z);
    }
    const glm::dvec3 worst = result.intensity.worst_direction;
    text += fmt::format(
        "\nintensity  {}\n           worst {:.4g} towards ({:.3f}, {:.3f}, {:.3f})\n",
        differences_text(result.intensity), result.intensity.worst, worst.x, worst.y, worst.z);
    for (const farfield::NearDifferences& near : result.near_field)
        text += fmt::format("at {:<7} {}\n", fmt::format("{:.3g} m", near.distance_m),
                            differences_text(near.illuminance));
    return text;
}

ordered_json differences_json(const Differences& d) {
    return {
        {"mean_rel", d.mean_rel}, {"median_rel", d.median_rel},       {"p95_rel", d.p95_rel},
        {"rms_rel", d.rms_rel},   {"rms_in_sigmas", d.rms_in_sigmas}, {"sigma_rel", d.sigma_rel},
        {"worst", d.worst}};
}

ordered_json comparison_json(const Comparison& result, const Rigid& a_from_b) {
    ordered_json json = {{"flux",
                          {{"a", result.flux_a},
                           {"b", result.flux_b},
                           {"a_sigma", result.flux_a_sigma},
                           {"b_sigma", result.flux_b_sigma}}},
                         {"intensity", differences_json(result.intensity)}};
    const Turn turn = turn_of(a_from_b.rotation);
    const glm::dvec3 t = a_from_b.translation_m;
    json["a_from_b"] = {{"turn_deg", turn.angle_deg},
                        {"axis", {turn.axis.x, turn.axis.y, turn.axis.z}},
                        {"translation_m", {t.x, t.y, t.z}}};
    json["near_field"] = ordered_json::array();
    for (const farfield::NearDifferences& near : result.near_field) {
        ordered_json entry = differences_json(near.illuminance);
        entry["distance_m"] = near.distance_m;
        json["near_field"].push_back(entry);
    }
    return json;
}

void run(const CompareCommand& command) {
    const double start_s = now_s();
    const LampInput a = read_lamp(command.a), b = read_lamp(command.b);
    const farfield::LampView view_a = a.view(), view_b = b.view();
    const Rigid a_from_b =
        command.align ? farfield::align(view_a, view_b, command.options.seed) : Rigid{};
    const Comparison result = farfield::compare(view_a, view_b, a_from_b, command.options);
    print(command.json ? comparison_json(result, a_from_b).dump(2) + "\n"
                       : comparison_text(command, result, a_from_b));
    say(fmt::format("{} directions of each lamp's light; {}\n", command.options.directions,
                    cost(record_run(start_s))));
}

}  // namespace

void add_compare(CLI::App& app) {
    auto c = std::make_shared<CompareCommand>();
    CLI::App* sub = add_command(app, "compare",
                                "Differences of two lamps: flux, intensity, near field, with sigma",
                                {"nearfield compare led.luminaire.exr again.luminaire.exr --align",
                                 "nearfield compare headlight.luminaire.exr headlight.ies --json"});
    sub->add_option("a", c->a, "light field, luminaire or photometric file")
        ->required()
        ->type_name("FILE");
    sub->add_option("b", c->b, "another one; differences are b - a, relative to the mean of both")
        ->required()
        ->type_name("FILE");
    sub->add_flag("--align", c->align,
                  "first turn b (and move it, of two light fields) to agree best");
    add_number(*sub, "--directions", c->options.directions, 10, 1000000, "N",
               "of each lamp's light, which differences are taken over");
    add_seed(*sub, c->options.seed, "of directions");
    sub->add_flag("--json", c->json, "as JSON");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
