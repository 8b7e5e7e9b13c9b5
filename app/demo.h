// SPDX-License-Identifier: Apache-2.0
/// The demo's stages, from a synthetic headlight to a report, and the report.
#pragma once

#include "formats/report/page.h"
#include "render/report.h"
#include "sample_data/simulate.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::app {

struct DemoOptions {
    std::string folder;  // made where it does not exist; files in it that are not the demo's stay
    bool quick = false;  // smaller light field and picture: seconds
};

/// What a stage took and how exact it says it is.
struct Stage {
    std::string name, error_estimate;
    double time_s = 0, peak_memory_mib = 0;  // memory: of the process so far
};

struct DemoView {
    std::string camera, png;  // file name in the folder
    render::RenderReport report;
    double time_s = 0, exposure_ev = 0;
};

struct DemoResult {
    sample_data::SimulatedHeadlight lamp;
    std::vector<std::string> files;  // written, names in the folder
    std::vector<Stage> stages;
    std::vector<DemoView> views;  // the first is picture.exr and .png
    glm::ivec2 size_px{0};
};

/// The path of a file of the demo's folder.
std::string path_in(const DemoOptions& options, const std::string& name);

/// Called with a stage's name and how far it is.
using DemoProgress = std::function<void(const std::string& stage, double fraction)>;

/// Simulates, packs, writes the scene and renders its cameras. Throws Error where a file cannot be
/// written.
DemoResult run_demo(const DemoOptions& options, const DemoProgress& progress);

/// Writes report.html and report.json.
void write_demo_report(const DemoOptions& options,
                       const DemoResult& result,
                       const std::string& command_line);

}  // namespace nearfield::app
