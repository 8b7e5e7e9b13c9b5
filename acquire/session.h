// SPDX-License-Identifier: Apache-2.0
/// Takes the shots of a plan that are missing, checks them, and loses nothing.
#pragma once

#include "acquire/camera.h"
#include "acquire/stage.h"
#include "acquire/until_free.h"
#include "formats/capture/capture.h"

#include <functional>
#include <memory>
#include <string>

namespace nearfield::acquire {

/// What stands in the lab, open. The stage may use the camera's connection: it goes first.
struct Bench {
    std::unique_ptr<Camera> camera;
    std::unique_ptr<Stage> stage;
};

struct SessionOptions {
    /// Opens camera and stage; called again when they were lost. Throws Error.
    std::function<Bench()> open;
    ShouldStop should_stop = [] { return false; };
    double reconnect_s = 60;          // how long a lost device is tried again
    double busy_s = kBusyPatience_s;  // how long one that another program has is waited for
    std::function<void(double fraction, const std::string& state)> progress;
    std::function<void(const std::string& remark)> say;  // what people should know at once
};

struct SessionResult {
    int frames = 0;   // taken and kept in this session
    int retaken = 0;  // stale or incomplete frames that were taken again
    int reconnects = 0;
    int discarded_frames = 0;  // after every change of exposure
    double time_s = 0;
    double megabytes = 0;            // raw, of the kept frames
    double share_exposed_twice = 1;  // of pixels not darker than the plan's darkest_share
    double worst_ratio_rel = 0;  // largest deviation of true exposure ratios from those asked for
    int ratios = 0;              // that could be checked
    double worst_drift_rel = 0;  // of the lamp, against the first look at the reference
};

/// Takes what is missing from a capture.
///
/// In      writer, and the capture as read before, with its plan.
/// Throws  Stopped (all frames so far are on disk); Error with the frames so far on disk where the
/// disk is full,
///         the camera is gone for longer than reconnect_s, clamps or ignores exposure, shows
///         exposures in a ratio beyond the plan's limit, or the lamp drifts beyond its limit. What
///         the last two make doubtful is rejected in the log, so that a later session takes it
///         again.
/// Memory  a bracket of one position and a few frames.
SessionResult run_session(capture::CaptureWriter& writer,
                          const capture::Capture& capture,
                          const SessionOptions& options);

/// The bracket that a plan with is_auto asks for, by metering at the reference position, the grid's
/// corners and its center: the brightest pixel of all of them.
std::vector<double> meter(Bench& bench, const capture::Plan& plan, const ShouldStop& should_stop);

}  // namespace nearfield::acquire
