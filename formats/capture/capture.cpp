// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/capture.h"

#include "formats/capture/header.h"
#include "formats/capture/words.h"
#include "formats/files/error.h"
#include "formats/files/provenance_json.h"
#include "formats/files/read_file.h"

#include <fmt/format.h>

#include <filesystem>

namespace nearfield::capture {
namespace {

constexpr std::size_t kMostFrameBytes = std::size_t{4} << 30;

constexpr Words<Response, 2> kResponses{
    {{"linear", Response::Linear}, {"unknown", Response::Unknown}}};

CaptureHeader read_header(const std::string& path) {
    const Json document = parse_json(read_file(path), path);
    const JsonField field(document, path);
    const int version = field.at("nearfield_capture").integer(0, 1 << 30);
    if (version > kCaptureVersion || version < 1)
        throw Error{"cannot read capture", path, fmt::format("version 1 ... {}", kCaptureVersion),
                    fmt::format("{}", version)};
    CaptureHeader header;
    if (field.has("plan")) {
        header.plan = plan_from(field.at("plan"));
        if (header.plan->grid.x > 0 && header.plan->bracket.exposures_us.empty())
            throw Error{"bad capture", path + ".plan", "exposures_us", "none"};
    }
    header.response = meaning_of(kResponses, field.at("response"));
    header.provenance = provenance_from(field.at("provenance"));
    return header;
}

void read_line(const JsonField& line, Capture& capture) {
    const std::string record = line.at("record").text();
    if (record == "frame") {
        FrameRecord frame = frame_from(line);
        capture.frames.insert_or_assign(frame.shot.number, std::move(frame));
    } else if (record == "session") {
        capture.sessions.push_back(session_from(line));
    } else if (record == "event") {
        capture.events.push_back(event_from(line));
    } else if (record == "reject") {
        capture.rejects.push_back(reject_from(line));
        for (const int number : capture.rejects.back().shots)
            capture.frames.erase(number);
    } else {
        throw Error{"bad capture", line.where(), "session, frame, event or reject",
                    "'" + record + "'"};
    }
}

void read_log(const std::string& path, Capture& capture) {
    const std::string text = read_file(path);
    std::size_t begin = 0;
    for (int number = 1; begin < text.size(); ++number) {
        const std::size_t end = text.find('\n', begin);
        if (end == std::string::npos) {
            capture.has_torn_end = true;
            return;
        }
        const std::string where = fmt::format("{}, line {}", path, number);
        const Json line = parse_json(text.substr(begin, end - begin), where);
        read_line({line, where}, capture);
        begin = end + 1;
    }
}

}  // namespace

std::string header_text(const CaptureHeader& header) {
    Json document = {{"nearfield_capture", kCaptureVersion},
                     {"response", word_for(kResponses, header.response)},
                     {"provenance", json_of(header.provenance)}};
    if (header.plan)
        document["plan"] = json_of(*header.plan);
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

bool holds_capture(const std::string& folder) {
    std::error_code failed;
    return std::filesystem::is_regular_file(folder + "/capture.json", failed);
}

Capture read_capture(const std::string& folder) {
    if (!holds_capture(folder))
        throw Error{"not a capture", folder, "a folder with capture.json"};
    Capture capture;
    capture.header = read_header(folder + "/capture.json");
    read_log(folder + "/log.jsonl", capture);
    return capture;
}

Frame read_frame(const std::string& folder, const FrameRecord& record) {
    const std::string path = folder + "/" + record.file;
    const std::string bytes = read_file(path, kMostFrameBytes);
    const std::string hash = hash_bytes(bytes);
    if (hash != record.xxh128)
        throw Error{"damaged frame", path, "xxh128 " + record.xxh128, hash};
    Frame frame = decode_frame(bytes, record.bits, path);
    if (frame.size_px != record.size_px || frame.channels != record.channels)
        throw Error{
            "damaged frame", path,
            fmt::format("{} x {} x {}", record.size_px.x, record.size_px.y, record.channels),
            fmt::format("{} x {} x {}", frame.size_px.x, frame.size_px.y, frame.channels)};
    return frame;
}

std::vector<int> damaged_frames(const std::string& folder,
                                const Capture& capture,
                                const std::function<void(double fraction)>& progress) {
    std::vector<int> damaged;
    std::size_t count = 0;
    for (const auto& [number, record] : capture.frames) {
        const std::string path = folder + "/" + record.file;
        std::error_code failed;
        if (!std::filesystem::is_regular_file(path, failed) || hash_file(path) != record.xxh128)
            damaged.push_back(number);
        if (progress)
            progress(static_cast<double>(++count) / static_cast<double>(capture.frames.size()));
    }
    return damaged;
}

std::vector<Shot> missing_shots(const Capture& capture) {
    std::vector<Shot> missing;
    if (!capture.header.plan)
        return missing;
    for (const Shot& shot : shots_of(*capture.header.plan))
        if (!capture.frames.contains(shot.number))
            missing.push_back(shot);
    return missing;
}

}  // namespace nearfield::capture
