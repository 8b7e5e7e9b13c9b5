// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/trace.h"

#include "formats/files/provenance.h"

#include <imgui.h>
#include <nlohmann/json.hpp>

#include <iterator>
#include <utility>
#include <vector>

namespace nearfield::viewer {

Trace::Trace(const std::string& path) : start_s_(now_s()) {
    if (path.empty())
        return;
    file_.open(path);
    write({{"event", "start"}, {"clock_s", start_s_}});
}

void Trace::write(const nlohmann::json& line) {
    file_ << line.dump() << std::endl;
}

double Trace::now_ms() const {
    return 1e3 * (now_s() - start_s_);
}

void Trace::woke() {
    woke_ms_ = now_ms();
}

void Trace::asked(const Request& request) {
    if (!file_.is_open())
        return;
    asked_ms_.emplace(request.serial, woke_ms_);
    write({{"event", "request"},
           {"t_ms", now_ms()},
           {"serial", request.serial},
           {"dial", request.dial}});
}

void Trace::saw_input() {
    if (!file_.is_open())
        return;
    const ImGuiIO& io = ImGui::GetIO();
    std::vector<std::size_t> keys;
    for (std::size_t key = 0; key < std::size(io.KeysDown); ++key)
        if (io.KeysDown[key])
            keys.push_back(key);
    const nlohmann::json seen = {{"event", "input"},
                                 {"x", io.MousePos.x},
                                 {"y", io.MousePos.y},
                                 {"is_down", io.MouseDown[0]},
                                 {"keys", keys}};
    std::string text = seen.dump();
    if (text == input_)
        return;
    write(seen);
    input_ = std::move(text);
}

void Trace::said(const std::string& message) {
    if (!file_.is_open() || message == message_)
        return;
    message_ = message;
    write({{"event", "message"}, {"t_ms", now_ms()}, {"text", message}});
}

void Trace::showed(const Frame& frame, bool is_final) {
    if (!file_.is_open())
        return;
    nlohmann::json line = {{"event", "frame"},          {"t_ms", now_ms()},
                           {"serial", frame.serial},    {"width", frame.size_px.x},
                           {"height", frame.size_px.y}, {"render_ms", 1e3 * frame.time_s},
                           {"final", is_final}};
    const render::RenderReport& report = frame.report;
    for (const render::PlannedPass& pass : report.plan.passes)
        for (const render::PassReport& cost : report.costs)
            if (cost.id == pass.id)
                line["passes_ms"][pass.name] = 1e3 * cost.time_s;
    line["load_ms"] = 1e3 * report.load_s;
    line["build_ms"] = 1e3 * report.build_s;
    const auto oldest = asked_ms_.begin();
    if (oldest != asked_ms_.end() && oldest->first <= frame.serial)
        line["feedback_ms"] = now_ms() - oldest->second;
    asked_ms_.erase(asked_ms_.begin(), asked_ms_.upper_bound(frame.serial));
    write(line);
}

void Trace::placed(const std::map<std::string, glm::vec4>& places) {
    if (!file_.is_open() || places == places_)
        return;
    places_ = places;
    nlohmann::json line = {{"event", "places"}, {"t_ms", now_ms()}};
    for (const auto& [name, place] : places)
        line["places"][name] = {place.x, place.y, place.z, place.w};
    write(line);
}

}  // namespace nearfield::viewer
