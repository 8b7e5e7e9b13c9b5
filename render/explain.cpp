// SPDX-License-Identifier: Apache-2.0
#include "render/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace nearfield::render {
namespace {

/// What is said of one thing: name, in or out, time, memory, why.
using Line = std::array<std::string, 5>;

std::string in_or_out(bool is_in) {
    return is_in ? "in" : "out";
}

std::string time_text(double time_s) {
    return fmt::format("{:.1f} ms", 1e3 * time_s);
}

std::string memory_text(double bytes) {
    constexpr double kMiB = 1024.0 * 1024.0;
    return fmt::format("{:.1f} MiB", bytes / kMiB);
}

Line pass_line(const PlannedPass& pass, const std::vector<PassReport>& costs) {
    Line line = {pass.name, in_or_out(pass.is_in), "", "", pass.reason};
    const auto cost = std::find_if(costs.begin(), costs.end(),
                                   [&](const PassReport& one) { return one.id == pass.id; });
    if (pass.is_in && cost != costs.end()) {
        line[2] = time_text(cost->time_s);
        line[3] = memory_text(cost->bytes);
    }
    return line;
}

std::vector<Line> lines_of(const RenderReport& report) {
    const Plan& plan = report.plan;
    std::vector<Line> lines = {{"pass", "", "time", "memory", "because"}};
    for (const PlannedPass& pass : plan.passes)
        lines.push_back(pass_line(pass, report.costs));
    lines.push_back({"color", in_or_out(plan.color.is_in), "", "", plan.color.reason});
    lines.push_back({"lamp", "", "", "", ""});
    for (const LampPlan& lamp : plan.lamps) {
        lines.push_back({lamp.name, in_or_out(lamp.is_lit), "", "", lamp.light_reason});
        if (lamp.is_lit)
            lines.push_back(
                {"  its shadows", in_or_out(lamp.has_shadows), "", "", lamp.shadows_reason});
    }
    for (const UnlitLamp& lamp : plan.unlit)
        lines.push_back({lamp.name.empty() ? "luminaire" : lamp.name, "out", "", "", lamp.reason});
    return lines;
}

}  // namespace

std::string explain(const RenderReport& report) {
    const std::vector<Line> lines = lines_of(report);
    std::array<std::size_t, 4> widths{};
    for (const Line& line : lines)
        for (std::size_t c = 0; c < widths.size(); ++c)
            widths[c] = std::max(widths[c], line[c].size());
    std::string text =
        fmt::format("{}{}\n", report.device,
                    report.device_reason.empty() ? "" : fmt::format(": {}", report.device_reason));
    for (const Line& line : lines) {
        std::string row =
            fmt::format("{:<{}}  {:<{}}  {:>{}}  {:>{}}  {}", line[0], widths[0], line[1],
                        widths[1], line[2], widths[2], line[3], widths[3], line[4]);
        row.erase(row.find_last_not_of(' ') + 1);
        text += row + "\n";
    }
    return text;
}

}  // namespace nearfield::render
