// SPDX-License-Identifier: Apache-2.0
#include "acquire/session.h"

#include "acquire/frame_queue.h"
#include "acquire/position_check.h"
#include "acquire/settings.h"
#include "acquire/whole_frame.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>
#include <utility>

namespace nearfield::acquire {
namespace {

using capture::EventRecord;
using capture::FrameRecord;
using capture::Shot;
using capture::ShotKind;

// One session under way.
struct Session {
    capture::CaptureWriter& writer;
    const capture::Capture& capture;
    const SessionOptions& options;
    FrameQueue queue;
    Bench bench;
    PositionCheck checks;
    SessionResult result;
    int number = 1;
    double start_s = 0;
    double exposure_us = 0, read_exposure_us = 0;  // asked for last, and what the camera said
    double gain_db = 0;
    std::string last_hash;  // of the frame before: a camera that sends it again is stale
};

std::int64_t elapsed_us(const Session& session) {
    return static_cast<std::int64_t>((now_s() - session.start_s) * 1e6);
}

void note(Session& session, const std::string& what, const std::string& detail) {
    session.queue.flush();
    session.writer.add(EventRecord{session.number, elapsed_us(session), what, detail});
    if (session.options.say)
        session.options.say(what + ": " + detail);
}

std::string raw_hash(const capture::Frame& frame) {
    return hash_bytes(
        {reinterpret_cast<const char*>(frame.values.data()), frame.values.size() * 2});
}

// Sets the shot's exposure if it is another, and drops the frames that a late camera still takes
// with the old one.
void set_exposure(Session& session, double exposure_us) {
    if (exposure_us == session.exposure_us)
        return;
    session.exposure_us = 0;
    session.read_exposure_us = set_exposure_checked(*session.bench.camera, exposure_us);
    for (int k = 0; k < session.result.discarded_frames; ++k)
        session.last_hash =
            raw_hash(expose_whole(*session.bench.camera, session.options.should_stop).frame);
    session.exposure_us = exposure_us;
}

Exposed expose_fresh(Session& session, const Shot& shot) {
    for (int attempt = 1;; ++attempt) {
        std::string complaint;
        try {
            Exposed exposed = session.bench.camera->expose(session.options.should_stop);
            if (raw_hash(exposed.frame) != session.last_hash)
                return exposed;
            complaint = "stale frame: equal to the one before";
        } catch (const IncompleteFrame& error) {
            complaint = error.what();
        }
        if (attempt == kMostTries)
            throw Error{"the camera gives no whole new frame", name_of(shot),
                        fmt::format("one in {} tries", kMostTries), complaint};
        ++session.result.retaken;
        session.bench.stage->arrange(shot, session.options.should_stop);
        note(session, "frame taken again", name_of(shot) + ", " + complaint);
    }
}

void take(Session& session, const Shot& shot) {
    session.bench.stage->arrange(shot, session.options.should_stop);
    set_exposure(session, shot.exposure_us);
    Exposed exposed = expose_fresh(session, shot);
    FrameRecord record;
    record.shot = shot;
    record.pixel_format = exposed.pixel_format;
    record.exposure_us = session.read_exposure_us;
    record.gain_db = session.gain_db;
    record.session = session.number;
    record.time_us = elapsed_us(session);
    record.camera_time_ns = exposed.camera_time_ns;
    record.temperature_c = session.bench.camera->temperature_c();
    const Readings readings = session.bench.stage->readings();
    record.reading_lx = readings.illuminance_lx;
    record.lamp_voltage_v = readings.lamp_voltage_v;
    record.lamp_current_a = readings.lamp_current_a;
    record.stage_mm = readings.stage_mm;
    // Not before: where an instrument was lost on the way, the same shot comes again.
    session.last_hash = raw_hash(exposed.frame);
    session.checks.add(shot, exposed.frame);
    session.result.megabytes += static_cast<double>(exposed.frame.values.size() * 2) * 1e-6;
    ++session.result.frames;
    session.queue.add(std::move(exposed.frame), std::move(record));
}

// What a check found wrong makes the frames behind it doubtful: they are rejected, then it is
// thrown.
void judge(Session& session) {
    const std::optional<Finding> finding = session.checks.judge();
    if (!finding)
        return;
    session.queue.flush();
    session.writer.add(capture::RejectRecord{finding->doubtful_shots, finding->error.what()});
    note(session, finding->error.what_,
         fmt::format("{} frames rejected", finding->doubtful_shots.size()));
    throw finding->error;
}

void open_bench(Session& session) {
    const auto until_free_told = [&session](const auto& call) {
        return until_free(call, Patience(session.options.busy_s, session.options.should_stop,
                                         [&session](const std::string& remark) {
                                             note(session, "device busy", remark);
                                         }));
    };
    session.bench = until_free_told(session.options.open);
    until_free_told(
        [&session] { session.bench.camera->configure(session.capture.header.plan->camera); });
    session.gain_db = session.bench.camera->gain_db();
    session.exposure_us = 0;
}

void wait_s(double seconds, const ShouldStop& should_stop) {
    for (const double end_s = now_s() + seconds; now_s() < end_s;) {
        if (should_stop())
            throw Stopped{};
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
}

// Opens what was lost again and again, until it is there or the time is over.
void reopen_bench(Session& session, const DeviceLost& lost) {
    constexpr double kBetweenTries_s = 1;
    note(session, "device lost", lost.what());
    for (const double end_s = now_s() + session.options.reconnect_s;;) {
        session.bench.stage.reset();
        session.bench.camera.reset();
        wait_s(kBetweenTries_s, session.options.should_stop);
        try {
            open_bench(session);
            ++session.result.reconnects;
            note(session, "device back", session.bench.camera->identity().serial);
            return;
        } catch (const Error& error) {
            if (now_s() > end_s)
                throw Error{"device lost for good", lost.where,
                            fmt::format("it back within {:g} s", session.options.reconnect_s),
                            error.what()};
        }
    }
}

void say_progress(Session& session, std::size_t done, const std::vector<Shot>& shots) {
    if (session.options.progress)
        session.options.progress(static_cast<double>(done) / static_cast<double>(shots.size()),
                                 done < shots.size() ? name_of(shots[done]) : "");
}

void take_all(Session& session, const std::vector<Shot>& shots) {
    for (std::size_t k = 0; k < shots.size();) {
        if (session.options.should_stop())
            throw Stopped{};
        say_progress(session, k, shots);
        try {
            take(session, shots[k]);
            ++k;
        } catch (const DeviceLost& lost) {
            reopen_bench(session, lost);
            continue;
        }
        judge(session);
    }
    session.checks.finish();
    judge(session);
    say_progress(session, shots.size(), shots);
}

// The latency is looked for once a session, by light that the reference position gives.
void find_latency(Session& session, const std::vector<Shot>& shots) {
    const auto light = std::find_if(shots.begin(), shots.end(), [](const Shot& shot) {
        return shot.kind == ShotKind::Light || shot.kind == ShotKind::Reference;
    });
    if (light == shots.end() || session.capture.header.plan->bracket.exposures_us.size() < 2)
        return;
    session.bench.stage->arrange(*light, session.options.should_stop);
    session.result.discarded_frames =
        camera_latency(*session.bench.camera, session.capture.header.plan->bracket.exposures_us,
                       session.options.should_stop);
    session.exposure_us = 0;
}

// A device that is lost before the first frame comes back as later ones do.
void prepare(Session& session, const std::vector<Shot>& shots) {
    for (bool is_ready = false; !is_ready;) {
        try {
            find_latency(session, shots);
            is_ready = true;
        } catch (const DeviceLost& lost) {
            reopen_bench(session, lost);
        }
    }
}

capture::SessionRecord describe(const Session& session) {
    const CameraIdentity identity = session.bench.camera->identity();
    return {session.number,
            fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))),
            program_version(),
            identity.vendor,
            identity.model,
            identity.serial,
            session.result.discarded_frames,
            session.bench.stage->instruments()};
}

}  // namespace

SessionResult run_session(capture::CaptureWriter& writer,
                          const capture::Capture& capture,
                          const SessionOptions& options) {
    const std::vector<Shot> shots = missing_shots(capture);
    Session session{.writer = writer,
                    .capture = capture,
                    .options = options,
                    .queue = FrameQueue(writer),
                    .bench = {},
                    .checks = PositionCheck(capture),
                    .result = {},
                    .last_hash = {}};
    session.number = static_cast<int>(capture.sessions.size()) + 1;
    session.start_s = now_s();
    if (shots.empty())
        return session.result;
    open_bench(session);
    prepare(session, shots);
    writer.add(describe(session));
    try {
        take_all(session, shots);
    } catch (const Stopped&) {
        session.queue.flush();
        throw;
    }
    session.queue.flush();
    const CheckFigures& figures = session.checks.figures();
    session.result.share_exposed_twice =
        share_exposed_twice(figures.exposures, capture.header.plan->bracket.darkest_share);
    session.result.worst_ratio_rel = figures.worst_ratio_rel;
    session.result.ratios = figures.ratios;
    session.result.worst_drift_rel = figures.worst_drift_rel;
    session.result.time_s = now_s() - session.start_s;
    return session.result;
}

}  // namespace nearfield::acquire
