// SPDX-License-Identifier: Apache-2.0
#include "app/bench/files.h"
#include "app/bench/summary.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::bench {
namespace {

// Strings, numbers, or nothing.
using Json = nlohmann::ordered_json;

Json as_record(const Result& result, bool is_on_front) {
    const render::RelativeError& error = result.error;
    return {{"sweep", result.of.sweep},
            {"curve", result.of.curve},
            {"setting", result.of.setting},
            {"sampler", result.of.method.name()},
            {"size", result.of.method.size()},
            {"rms_rel", error.rms},
            {"rms_low_rel", result.rms_low},
            {"rms_high_rel", result.rms_high},
            {"p50_rel", error.p50},
            {"p95_rel", error.p95},
            {"max_rel", error.largest},
            {"bias_rel", error.bias},
            {"block_rms_rel", result.block_rms ? Json(*result.block_rms) : Json()},
            {"time_us", result.time_us},
            {"look_us", result.of.method.sampling ? Json(result.look_us) : Json()},
            {"reads", result.reads},
            {"passes", result.of.passes},
            {"on_pareto_front", is_on_front}};
}

std::vector<Json> as_records(const Findings& findings) {
    const std::vector<bool> front = on_front(findings);
    std::vector<Json> records;
    std::size_t at = 0;
    for (const Result& result : findings.results)
        records.push_back(as_record(result, result.of.sweep == "samplers" && front[at++]));
    return records;
}

std::string csv_cell(const Json& value) {
    if (value.is_null())
        return "";
    if (value.is_string()) {
        const auto text = value.get<std::string>();
        return text.find(',') == std::string::npos ? text : fmt::format("\"{}\"", text);
    }
    return value.is_number_float() ? fmt::format("{:.6g}", value.get<double>()) : value.dump();
}

Json as_json(const std::optional<CostPoint>& arrival) {
    if (!arrival)
        return {};
    return {
        {"time_us", arrival->time_us}, {"size", arrival->size}, {"error_rel", arrival->error_rel}};
}

Json as_json(const SamplerSummary& summary) {
    Json json = {{"sampler", summary.sampler}, {"end", as_json(std::optional(summary.end))}};
    for (std::size_t goal = 0; goal < kGoals_rel.size(); ++goal) {
        Json speedups = Json::object();
        for (const Speedup& speedup : summary.speedups[goal])
            speedups[speedup.baseline] = {{"ratio", speedup.ratio ? Json(*speedup.ratio) : Json()},
                                          {"baseline_arrives", speedup.baseline_arrives}};
        json["goals"].push_back({{"error_rel", kGoals_rel[goal]},
                                 {"arrival", as_json(summary.arrivals[goal])},
                                 {"faster_than", std::move(speedups)}});
    }
    return json;
}

}  // namespace

std::string as_csv(const Findings& findings) {
    std::string names, lines;
    for (const Json& record : as_records(findings)) {
        std::vector<std::string> columns, cells;
        for (const auto& [name, value] : record.items()) {
            columns.push_back(name);
            cells.push_back(csv_cell(value));
        }
        names = fmt::format("{}\n", fmt::join(columns, ","));
        lines += fmt::format("{}\n", fmt::join(cells, ","));
    }
    return names + lines;
}

std::string as_json(const Findings& findings, const Setup& setup) {
    Json json = {{"kind", "accuracy"},
                 {"program", program_version()},
                 {"command", setup.command_line},
                 {"machine", setup.machine},
                 {"threads", findings.threads},
                 {"lamp", setup.lamp},
                 {"receivers", findings.receivers},
                 {"time_s", findings.time_s},
                 {"skipped", findings.skipped},
                 {"summary", Json::array()},
                 {"results", as_records(findings)}};
    for (const SamplerSummary& summary : summarize(findings))
        json["summary"].push_back(as_json(summary));
    return json.dump(1) + "\n";
}

void make_folder(const std::string& folder) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure)
        throw Error("cannot make folder", folder, {}, failure.message());
}

}  // namespace nearfield::bench
