// SPDX-License-Identifier: Apache-2.0
/// A GigE Vision camera made of software: any client of the standard drives it over UDP as it
/// drives a camera. What it sees comes from a callback. docs/gige.md has registers and limits.
///
/// Source: GigE Vision 1.2 (GVCP, GVSP, bootstrap registers), GenICam GenApi schema 1.1 and
/// SFNC 2.4 (names of features), as the free client library Aravis understands them.
#pragma once

#include "sample_data/gige/pixel_format.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace nearfield::gige {

/// What the camera is shown.
enum class Subject : std::uint32_t {
    Position = 0,  // the filter at Stage::filter
    Open = 1,      // no filter
    Flat = 2,      // an even source
    Target = 3,    // the calibration target in pose Stage::target_view
    Cap = 4,       // the lens is covered
    Filter = 5,    // the filter itself at Stage::filter, without the screen
    Blocked = 6,   // an opaque plate instead of the filter
};

/// What the client moved in the lab, by vendor features.
struct Stage {
    Subject subject = Subject::Position;
    glm::ivec2 filter{0};  // column and row of the filter's position
    int target_view = 0;
    bool lamp_on = true;
    std::uint32_t shot = 0;  // the client's number of what it does; 0: it does not count

    bool operator==(const Stage&) const = default;
};

/// One frame to expose.
struct Exposure {
    std::uint64_t frame_number =
        0;  // counts exposures since Stage::shot was last set, or the start
    double exposure_us = 0;
    double gain_db = 0;
    double time_s = 0;  // lab time at the exposure's middle
    Stage stage;
};

/// What stands before the camera. Both callbacks are called from the camera's threads, maybe at the
/// same time.
struct Lab {
    glm::ivec2 sensor_px{512, 512};  // even, at most 16384
    int sensor_bits = 12;            // 8 ... 16
    bool is_bayer = false;           // offers BayerRG formats, else Mono formats
    glm::ivec2 filter_grid{1, 1};    // positions of the filter
    int target_views = 0;            // poses of the calibration target; 0: no Subject::Target
    bool can_open = true;            // Subject::Open exists
    bool can_see_filter = true;      // Subject::Filter and Subject::Blocked exist
    double black_level_dn = 0;       // in the sensor's bits, read by BlackLevel

    /// The sensor's values of a frame, rows from the top, each below 2^sensor_bits.
    std::function<std::vector<std::uint16_t>(const Exposure&)> expose;
    /// The photometer's reading; may be empty (reads as 0). Should take well under a second.
    std::function<double(const Stage&, double time_s)> photometer_lx;
    /// The sensor's temperature; may be empty (reads as 0).
    std::function<double(double time_s)> sensor_c;
};

/// Misbehavior for tests. Zeros: none.
struct Faults {
    double drop_share = 0;          // of data packets, not sent the first time
    std::uint64_t seed = 1;         // of what is dropped
    std::uint64_t stall_after = 0;  // frames, then none comes although the camera still answers
    std::uint64_t die_after = 0;    // frames, then silence in the middle of the next
    double clamp_exposure_us = 0;   // longest exposure applied; what was set is still read back
    bool ignore_exposure = false;   // applies the first exposure time for ever
    bool no_resend = false;         // packet resend is neither offered nor done
};

struct CameraOptions {
    std::string address = "127.0.0.1";  // IPv4; other than 127.x.x.x it can be reached from outside
    std::uint16_t port = 3956;      // 0: any free one (clients that only know 3956 cannot find it)
    std::string serial = "NF0001";  // 15 characters at most
    bool fast = false;              // exposure and readout take no time; lab time goes on as if
    double readout_us = 2000;       // from the exposure's end to the frame's first packet
    int exposure_latency_frames = 0;  // exposure and gain take effect that many frames late
    double link_mbit_s = 1000;        // pace of the stream, headers included; 0: none
    Faults faults;
};

/// What happened since the start.
struct Statistics {
    std::uint64_t frames = 0;           // sent, complete
    std::uint64_t packets = 0;          // sent, without resends
    std::uint64_t dropped_packets = 0;  // by Faults::drop_share
    std::uint64_t resent_packets = 0;
    std::uint64_t unavailable_packets = 0;  // asked for again when the frame was gone
    std::uint64_t late_frames = 0;          // the callback took longer than exposure and readout
    std::uint64_t bytes = 0;                // of payload
    double sending_s = 0;                   // time spent on sending frames, pacing included
    std::uint64_t commands = 0;             // datagrams on the control port
    std::uint64_t refused_commands = 0;     // answered by an error
    std::uint64_t malformed_commands = 0;
};

/// Throws Error where a camera could not be opened now: no address of this machine, port in use.
void check_address(const CameraOptions& options);

/// Answers and sends until destroyed. Its threads: control, exposure, link.
class Camera {
  public:
    /// Throws Error where an option is out of range, or the address cannot be bound.
    Camera(CameraOptions options, Lab lab);
    ~Camera();
    Camera(const Camera&) = delete;
    Camera& operator=(const Camera&) = delete;

    std::uint16_t port() const;
    /// False once Faults::die_after has come true, or a callback threw.
    bool running() const;
    /// What a callback threw, rethrown here; nothing otherwise.
    void check() const;
    Statistics statistics() const;

  private:
    struct Threads;
    std::unique_ptr<Threads> threads_;
};

}  // namespace nearfield::gige
