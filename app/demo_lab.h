// SPDX-License-Identifier: Apache-2.0
/// The whole way of a measurement, on the virtual bench: capture over GigE Vision, calibrate, fit,
/// pack, render, and how far the result is from the truth, which no stage reads.
#pragma once

#include "app/demo.h"
#include "app/lab_closure.h"
#include "calibrate/calibrate.h"

#include <string>

namespace nearfield::app {

struct LabDemoOptions {
    std::string folder;  // made; must not hold a capture
    std::string bench = "sample_data/bench_near.json";
    std::string plan = "sample_data/plan_near.json";
    std::string address = "127.0.0.1";  // of the camera that is served
    bool quick = false;                 // smaller texels and picture
};

struct LabDemoResult {
    std::vector<Stage> stages;
    calibrate::Calibration calibration;
    fit::CaptureFit fit;
    Closure closure;
    std::string picture_png;
};

/// Throws Error as its stages do.
LabDemoResult run_lab_demo(const LabDemoOptions& options, const DemoProgress& progress);

/// Writes report.html and report.json, whose `closure` says how far from the truth.
void write_lab_report(const LabDemoOptions& options,
                      const LabDemoResult& result,
                      const std::string& command_line);

}  // namespace nearfield::app
