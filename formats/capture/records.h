// SPDX-License-Identifier: Apache-2.0
/// What a capture's log says: one line of JSON for every session, frame, event and rejection.
#pragma once

#include "formats/capture/plan.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::capture {

/// One run of the program that took frames. Times of its frames count from its start.
struct SessionRecord {
    int number = 1;
    std::string start_utc;  // ISO 8601
    std::string program;    // "nearfield 0.1.0"
    std::string vendor, model, serial;
    int discarded_frames =
        0;  // taken and dropped after a change of exposure, for a camera that is late
    std::vector<std::string> instruments = {};  // "luxmeter: MAKER,MODEL,SERIAL,VERSION"
};

/// A frame that is whole on disk.
struct FrameRecord {
    Shot shot;         // asked for
    std::string file;  // below the capture's folder
    std::string xxh128;
    glm::ivec2 size_px{0};
    int channels = 1, bits = 16;
    std::string pixel_format;
    double exposure_us = 0;  // read back from the camera; 0: not known
    double gain_db = 0;      // read back
    int session = 1;
    std::int64_t time_us = 0;  // monotonic, since the session's start
    std::uint64_t camera_time_ns = 0;
    std::optional<double> temperature_c, reading_lx;
    std::optional<double> lamp_voltage_v, lamp_current_a;  // measured by the supply
    std::optional<glm::dvec2> stage_mm;                    // the stage's position, read back
    double mean_dn = 0, share_saturated = 0;
    std::string source;  // the photograph that it was made from; empty: a camera's frame
};

/// Something that people should know: "camera lost", "lamp drifted".
struct EventRecord {
    int session = 1;
    std::int64_t time_us = 0;
    std::string what, detail;
};

/// Frames that are not to be used and are to be taken again.
struct RejectRecord {
    std::vector<int> shots;
    std::string why;
};

Json json_of(const SessionRecord& session);
Json json_of(const FrameRecord& frame);
Json json_of(const EventRecord& event);
Json json_of(const RejectRecord& reject);

SessionRecord session_from(const JsonField& line);
FrameRecord frame_from(const JsonField& line);
EventRecord event_from(const JsonField& line);
RejectRecord reject_from(const JsonField& line);

}  // namespace nearfield::capture
