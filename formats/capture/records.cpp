// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/records.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <limits>

namespace nearfield::capture {
namespace {

constexpr int kMostNumber = std::numeric_limits<int>::max();
constexpr int kMostSize_px = 65535;

Json json_of(const Shot& shot) {
    return {{"number", shot.number},
            {"kind", word_of(shot.kind)},
            {"position", {shot.position.x, shot.position.y}},
            {"view", shot.view},
            {"exposure_us", shot.exposure_us},
            {"repeat", shot.repeat}};
}

Shot shot_from(const JsonField& field) {
    const std::vector<JsonField> position = field.at("position").elements(2);
    return {field.at("number").integer(0, kMostNumber),
            shot_kind_from(field.at("kind")),
            {position[0].integer(-1, kMostNumber), position[1].integer(-1, kMostNumber)},
            field.at("view").integer(-1, kMostNumber),
            field.at("exposure_us").number(),
            field.at("repeat").integer(0, kMostNumber)};
}

// Whole numbers beyond int; doubles hold them exactly up to 2^53, which is 285 years in us.
std::int64_t whole_number(const JsonField& field) {
    const double value = field.number();
    if (!(value >= 0 && value <= 9007199254740992.0))
        throw Error{"bad value", field.where(), "0 ... 2^53", fmt::format("{}", value)};
    return static_cast<std::int64_t>(value);
}

std::optional<double> number_if(const JsonField& field, const std::string& key) {
    return field.has(key) ? std::optional(field.at(key).number()) : std::nullopt;
}

// A file below the capture's folder: no path leads out of it.
std::string file_below(const JsonField& field) {
    std::string file = field.text();
    if (file.empty() || file.starts_with('/') || file.find("..") != std::string::npos)
        throw Error{"bad value", field.where(), "a file below the capture's folder",
                    "'" + file + "'"};
    return file;
}

}  // namespace

Json json_of(const SessionRecord& session) {
    return {{"record", "session"},
            {"number", session.number},
            {"start_utc", session.start_utc},
            {"program", session.program},
            {"vendor", session.vendor},
            {"model", session.model},
            {"serial", session.serial},
            {"discarded_frames", session.discarded_frames},
            {"instruments", session.instruments}};
}

// Captures of version 1 have none.
std::vector<std::string> instruments_of(const JsonField& line) {
    std::vector<std::string> instruments;
    if (line.has("instruments"))
        for (const JsonField& instrument : line.at("instruments").elements())
            instruments.push_back(instrument.text());
    return instruments;
}

SessionRecord session_from(const JsonField& line) {
    return {line.at("number").integer(1, kMostNumber),
            line.at("start_utc").text(),
            line.at("program").text(),
            line.at("vendor").text(),
            line.at("model").text(),
            line.at("serial").text(),
            line.at("discarded_frames").integer(0, kMostNumber),
            instruments_of(line)};
}

Json json_of(const FrameRecord& frame) {
    Json line = {{"record", "frame"},
                 {"shot", json_of(frame.shot)},
                 {"file", frame.file},
                 {"xxh128", frame.xxh128},
                 {"size_px", {frame.size_px.x, frame.size_px.y}},
                 {"channels", frame.channels},
                 {"bits", frame.bits},
                 {"pixel_format", frame.pixel_format},
                 {"exposure_us", frame.exposure_us},
                 {"gain_db", frame.gain_db},
                 {"session", frame.session},
                 {"time_us", frame.time_us},
                 {"camera_time_ns", frame.camera_time_ns},
                 {"mean_dn", frame.mean_dn},
                 {"share_saturated", frame.share_saturated}};
    if (frame.temperature_c)
        line["temperature_c"] = *frame.temperature_c;
    if (frame.reading_lx)
        line["reading_lx"] = *frame.reading_lx;
    if (frame.lamp_voltage_v)
        line["lamp_voltage_v"] = *frame.lamp_voltage_v;
    if (frame.lamp_current_a)
        line["lamp_current_a"] = *frame.lamp_current_a;
    if (frame.stage_mm)
        line["stage_mm"] = {frame.stage_mm->x, frame.stage_mm->y};
    if (!frame.source.empty())
        line["source"] = frame.source;
    return line;
}

FrameRecord frame_from(const JsonField& line) {
    FrameRecord frame;
    frame.shot = shot_from(line.at("shot"));
    frame.file = file_below(line.at("file"));
    frame.xxh128 = line.at("xxh128").text();
    const std::vector<JsonField> size = line.at("size_px").elements(2);
    frame.size_px = {size[0].integer(1, kMostSize_px), size[1].integer(1, kMostSize_px)};
    frame.channels = line.at("channels").integer(1, 3);
    frame.bits = line.at("bits").integer(1, 16);
    frame.pixel_format = line.at("pixel_format").text();
    frame.exposure_us = line.at("exposure_us").number();
    frame.gain_db = line.at("gain_db").number();
    frame.session = line.at("session").integer(1, kMostNumber);
    frame.time_us = whole_number(line.at("time_us"));
    frame.camera_time_ns = static_cast<std::uint64_t>(line.at("camera_time_ns").number());
    frame.mean_dn = line.at("mean_dn").number();
    frame.share_saturated = line.at("share_saturated").number();
    frame.temperature_c = number_if(line, "temperature_c");
    frame.reading_lx = number_if(line, "reading_lx");
    frame.lamp_voltage_v = number_if(line, "lamp_voltage_v");
    frame.lamp_current_a = number_if(line, "lamp_current_a");
    if (line.has("stage_mm")) {
        const std::vector<double> stage = line.at("stage_mm").numbers(2);
        frame.stage_mm = glm::dvec2(stage[0], stage[1]);
    }
    if (line.has("source"))
        frame.source = line.at("source").text();
    return frame;
}

Json json_of(const EventRecord& event) {
    return {{"record", "event"},
            {"session", event.session},
            {"time_us", event.time_us},
            {"what", event.what},
            {"detail", event.detail}};
}

EventRecord event_from(const JsonField& line) {
    return {line.at("session").integer(1, kMostNumber), whole_number(line.at("time_us")),
            line.at("what").text(), line.at("detail").text()};
}

Json json_of(const RejectRecord& reject) {
    return {{"record", "reject"}, {"shots", reject.shots}, {"why", reject.why}};
}

RejectRecord reject_from(const JsonField& line) {
    RejectRecord reject;
    for (const JsonField& number : line.at("shots").elements())
        reject.shots.push_back(number.integer(0, kMostNumber));
    reject.why = line.at("why").text();
    return reject;
}

}  // namespace nearfield::capture
