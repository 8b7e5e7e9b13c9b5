// SPDX-License-Identifier: Apache-2.0
/// A capture on disk: a folder that describes itself.
///
///     CAPTURE/capture.json      plan, provenance: written once, first
///     CAPTURE/log.jsonl         sessions, frames, events, rejections: a line each, only ever added
///     to CAPTURE/frames/NAME.png   raw values, 16 bits
///
/// A frame's file is whole under its name before the log has its line; a line that was cut off by a
/// crash (no line end) counts as not written. So a frame is whole or absent, whenever the program
/// or the machine stops, and what is missing is taken by the next session.
#pragma once

#include "formats/capture/frame.h"
#include "formats/capture/plan.h"
#include "formats/capture/records.h"
#include "formats/files/provenance.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::capture {

constexpr int kCaptureVersion = 2;  // 2: instruments and what they read

/// How values follow light: of cameras in DN proportional to it, or of photographs unknown.
enum class Response { Linear, Unknown };

/// What a capture is; its exposures are known (found by metering where the plan said so).
struct CaptureHeader {
    /// None for imported photographs, of which nothing is missing; those that show a known board
    /// have a plan of its views and nothing else.
    std::optional<Plan> plan;
    Response response = Response::Linear;
    Provenance provenance;
};

/// A capture as its files tell.
struct Capture {
    CaptureHeader header;
    std::vector<SessionRecord> sessions;
    std::map<int, FrameRecord> frames;  // by the shot's number: the last that was not rejected
    std::vector<EventRecord> events;
    std::vector<RejectRecord> rejects;
    bool has_torn_end = false;  // the log's last line was cut off
};

/// True for a folder with a capture.json.
bool holds_capture(const std::string& folder);

/// Throws Error naming file and line where the capture does not say what it must. Frames' files are
/// not opened.
Capture read_capture(const std::string& folder);

/// Reads a frame's values. Throws Error if the file is missing or not the one that was written.
Frame read_frame(const std::string& folder, const FrameRecord& record);

/// The shots' numbers whose files are missing or not those that were written, ascending.
/// Cost    reads every file: 1 GB/s where they are in memory.
std::vector<int> damaged_frames(const std::string& folder,
                                const Capture& capture,
                                const std::function<void(double fraction)>& progress);

/// Shots of the plan that have no frame, in the plan's order; none where there is no plan.
std::vector<Shot> missing_shots(const Capture& capture);

/// The one writer of a capture, while it lives: a second one is refused.
class CaptureWriter {
  public:
    /// Makes the folder. Throws Error if it holds anything.
    static CaptureWriter create(const std::string& folder, const CaptureHeader& header);
    /// Goes on with a capture; a torn end of its log is cut off.
    static CaptureWriter reopen(const std::string& folder);

    CaptureWriter(CaptureWriter&& other) noexcept;
    CaptureWriter& operator=(CaptureWriter&&) = delete;
    ~CaptureWriter();

    /// Writes the frame's file, then its line. The record's file, xxh128, size, bits and levels are
    /// filled in here; returns it as written.
    FrameRecord add(const Frame& frame, FrameRecord record);
    void add(const SessionRecord& session);
    void add(const EventRecord& event);
    void add(const RejectRecord& reject);

    const std::string& folder() const { return folder_; }

  private:
    explicit CaptureWriter(std::string folder);
    void append(const Json& line);

    std::string folder_;
    int log_ = -1;  // open for appending, locked
};

}  // namespace nearfield::capture
