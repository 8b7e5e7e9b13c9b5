// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/trace.h"

#include "formats/files/provenance.h"

#include <nlohmann/json.hpp>

namespace nearfield::viewer {

Trace::Trace(const std::string& path) : start_s_(now_s()) {
    if (!path.empty())
        file_.open(path);
}

double Trace::now_ms() const {
    return 1e3 * (now_s() - start_s_);
}

void Trace::asked(int serial) {
    if (file_.is_open())
        asked_ms_.emplace(serial, now_ms());
}

void Trace::showed(const Frame& frame, bool is_final) {
    if (!file_.is_open())
        return;
    nlohmann::json line = {{"event", "frame"},          {"t_ms", now_ms()},
                           {"serial", frame.serial},    {"width", frame.size_px.x},
                           {"height", frame.size_px.y}, {"render_ms", 1e3 * frame.time_s},
                           {"final", is_final}};
    const auto oldest = asked_ms_.begin();
    if (oldest != asked_ms_.end() && oldest->first <= frame.serial)
        line["feedback_ms"] = now_ms() - oldest->second;
    asked_ms_.erase(asked_ms_.begin(), asked_ms_.upper_bound(frame.serial));
    file_ << line.dump() << std::endl;
}

void Trace::placed(const std::map<std::string, glm::vec4>& places) {
    if (!file_.is_open() || places == places_)
        return;
    places_ = places;
    nlohmann::json line = {{"event", "places"}, {"t_ms", now_ms()}};
    for (const auto& [name, place] : places)
        line["places"][name] = {place.x, place.y, place.z, place.w};
    file_ << line.dump() << std::endl;
}

}  // namespace nearfield::viewer
