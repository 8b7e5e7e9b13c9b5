// SPDX-License-Identifier: Apache-2.0
#include "app/describe_capture.h"

#include "app/describe.h"
#include "formats/files/json_field.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>

namespace nearfield::app {
namespace {

using capture::Capture;
using capture::FrameRecord;

std::map<std::string, int> count_by_kind(const Capture& capture) {
    std::map<std::string, int> counts;
    for (const auto& [number, frame] : capture.frames)
        ++counts[word_of(frame.shot.kind)];
    return counts;
}

// "Mono12, 512 x 512", or that they differ.
std::string format_text(const Capture& capture) {
    if (capture.frames.empty())
        return "none";
    const FrameRecord& first = capture.frames.begin()->second;
    const bool differ =
        std::any_of(capture.frames.begin(), capture.frames.end(), [&](const auto& entry) {
            return entry.second.size_px != first.size_px ||
                   entry.second.pixel_format != first.pixel_format;
        });
    const std::string text =
        fmt::format("{}, {} x {} px", first.pixel_format, first.size_px.x, first.size_px.y);
    return differ ? text + " and others" : text;
}

std::string board_text(const capture::BoardPlan& board) {
    std::string text =
        fmt::format("board      {} of {} x {} squares of {:g} mm",
                    board.kind == capture::BoardKind::Charuco ? "ChArUco" : "chessboard",
                    board.squares.x, board.squares.y, board.square_m * 1e3);
    if (board.kind == capture::BoardKind::Charuco)
        text += fmt::format(", markers of {:g} mm, {}", board.marker_m * 1e3, board.dictionary);
    return text + "\n";
}

std::string views_text(const capture::Plan& plan) {
    const auto count = [&plan](capture::TargetPlane plane) {
        return std::count(plan.views.begin(), plan.views.end(), plane);
    };
    return fmt::format(
        "views      {} on the screen, {} on the filter's plane, {} free; {} of the "
        "filter itself\n",
        count(capture::TargetPlane::Screen), count(capture::TargetPlane::Filter),
        count(capture::TargetPlane::Free), plan.filter_views.positions.size());
}

std::string plan_text(const capture::Plan& plan) {
    std::string text;
    if (plan.grid.x > 0)
        text = fmt::format(
            "plan       {} x {} positions, pitch {:g} x {:g} mm, basis {}; exposures {} us, {} of "
            "each\n",
            plan.grid.x, plan.grid.y, plan.pitch_m.x * 1e3, plan.pitch_m.y * 1e3, plan.basis,
            fmt::join(plan.bracket.exposures_us, ", "), plan.repeats);
    if (!plan.views.empty() || !plan.filter_views.positions.empty())
        text += views_text(plan);
    if (plan.board)
        text += board_text(*plan.board);
    return text;
}

std::string temperature_text(const Capture& capture) {
    double least_c = std::numeric_limits<double>::infinity(), most_c = -least_c;
    for (const auto& [number, frame] : capture.frames)
        if (frame.temperature_c) {
            least_c = std::min(least_c, *frame.temperature_c);
            most_c = std::max(most_c, *frame.temperature_c);
        }
    return least_c > most_c ? "" : fmt::format("sensor     {:.1f} ... {:.1f} C\n", least_c, most_c);
}

}  // namespace

Json describe(const Capture& capture, const std::optional<std::vector<int>>& damaged) {
    Json json = {{"kind", "capture"}, {"format_version", capture::kCaptureVersion}};
    if (capture.header.plan)
        json["plan"] = json_of(*capture.header.plan);
    json["response"] = capture.header.response == capture::Response::Linear ? "linear" : "unknown";
    json["frames"] = capture.frames.size();
    json["frames_by_kind"] = count_by_kind(capture);
    json["missing"] = missing_shots(capture).size();
    const auto list = [&json](const char* key, const auto& records) {
        json[key] = Json::array();
        for (const auto& record : records)
            json[key].push_back(json_of(record));
    };
    list("sessions", capture.sessions);
    list("events", capture.events);
    list("rejects", capture.rejects);
    if (damaged)
        json["damaged"] = *damaged;
    json["provenance"] = describe(capture.header.provenance);
    return json;
}

std::string capture_text(const Capture& capture, const std::optional<std::vector<int>>& damaged) {
    std::string text = fmt::format(
        "kind       capture, format version {}, response {}\n", capture::kCaptureVersion,
        capture.header.response == capture::Response::Linear ? "linear" : "unknown");
    if (capture.header.plan)
        text += plan_text(*capture.header.plan);
    text += fmt::format("frames     {} ({}), {} missing, {}\n", capture.frames.size(),
                        format_text(capture), missing_shots(capture).size(),
                        fmt::join(count_by_kind(capture), ", "));
    text += temperature_text(capture);
    for (const capture::SessionRecord& session : capture.sessions) {
        text +=
            fmt::format("session {}  {} by {} with {} {} {}\n", session.number, session.start_utc,
                        session.program, session.vendor, session.model, session.serial);
        for (const std::string& instrument : session.instruments)
            text += fmt::format("           {}\n", instrument);
    }
    for (const capture::EventRecord& event : capture.events)
        text += fmt::format("event      session {}, {:.1f} s: {}: {}\n", event.session,
                            static_cast<double>(event.time_us) * 1e-6, event.what, event.detail);
    for (const capture::RejectRecord& reject : capture.rejects)
        text += fmt::format("rejected   {} frames: {}\n", reject.shots.size(), reject.why);
    if (damaged)
        text += fmt::format("verified   {} of {} frames damaged or missing on disk\n",
                            damaged->size(), capture.frames.size());
    return text;
}

}  // namespace nearfield::app
