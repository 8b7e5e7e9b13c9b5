// SPDX-License-Identifier: Apache-2.0
#include "app/bench/papers.h"

#include "app/bench/files.h"
#include "app/bench/papers_run.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "render/device.h"

#include <algorithm>
#include <array>
#include <filesystem>

namespace nearfield::bench {
namespace {

struct Measurement {
    const char* name;
    void (*measure)(const PapersOptions&, PapersFindings&);
    bool needs_gl;
};

constexpr std::array<Measurement, 9> kMeasurements = {{
    {"figure 5, search", measure_search, false},
    {"figure 7, shadows", measure_shadows, true},
    {"figure 8, sequences", measure_sequences, false},
    {"figure 9, most samples of an image", measure_k_max, false},
    {"figure 11, precomputed samples", measure_precomputed, false},
    {"figure 12, uniform samples", measure_uniform, false},
    {"figure 13, convergence", measure_convergence, false},
    {"all samplers", measure_samplers, false},
    {"figures 2 and 10, frames", measure_frames, false},
}};

constexpr int kWidth_px = 240, kQuickWidth_px = 32;

// 4 : 3, as the paper's.
glm::ivec2 frame_of(int width_px) {
    return {width_px, 3 * width_px / 4};
}

// Scenes that users can render again.
void write_scenes(const PapersOptions& options, const PapersFindings& findings) {
    for (const PapersLamp& lamp : findings.lamps)
        write_scene(make_papers_scene(lamp, options.folder, 2),
                    (std::filesystem::path(options.folder) / (lamp.name + ".gltf")).string());
}

void add_tables(PapersFindings& findings) {
    for (const PapersLamp& lamp : findings.lamps) {
        PapersRow row;
        row.figure = "tables";
        row.lamp = lamp.name;
        row.device = "CPU";
        row.method = "coefficients";
        row.bytes = lamp.coefficient_bytes;
        findings.rows.push_back(row);
        row.method = "tables";
        row.time_s = lamp.tables_s;
        row.bytes = lamp.table_bytes;
        findings.rows.push_back(row);
    }
}

// A frame of a few pixels tells whether there is an OpenGL context.
void look_for_gl(const PapersOptions& options, PapersFindings& findings) {
    render::RenderOptions render_options;
    render_options.device = render::Device::Auto;
    render_options.size_px = {8, 6};
    const render::RenderReport report =
        render::render(make_papers_scene(findings.lamps.front(), options.folder, 1), render_options)
            .report;
    if (report.plan.device == render::Device::Gl)
        findings.gl_device = report.device;
    else
        findings.gl_missing = report.device_reason;
}

}  // namespace

const PapersLamp& lamp_of(const PapersFindings& findings, const std::string& name) {
    return *std::find_if(findings.lamps.begin(), findings.lamps.end(),
                         [&](const PapersLamp& lamp) { return lamp.name == name; });
}

PapersFindings run_papers(const PapersOptions& options, const PapersProgress& progress) {
    const double start_s = now_s();
    make_folder(options.folder);
    PapersFindings findings;
    const int width_px =
        options.frame_px > 0 ? options.frame_px : (options.quick ? kQuickWidth_px : kWidth_px);
    findings.size_px = frame_of(width_px);
    findings.small_px = frame_of(2 * width_px / 5);
    findings.render_px = frame_of(2 * width_px / 3);
    constexpr double kSteps = kMeasurements.size() + 1.0;
    progress("lamps", 0.0);
    findings.lamps = make_papers_lamps(options.folder, options.quick);
    write_scenes(options, findings);
    add_tables(findings);
    look_for_gl(options, findings);
    for (std::size_t k = 0; k < kMeasurements.size(); ++k) {
        progress(kMeasurements[k].name, static_cast<double>(k + 1) / kSteps);
        if (!kMeasurements[k].needs_gl || !findings.gl_device.empty())
            kMeasurements[k].measure(options, findings);
    }
    findings.time_s = now_s() - start_s;
    return findings;
}

std::vector<const PapersRow*> rows_of(const PapersFindings& findings,
                                      const std::string& figure,
                                      const std::string& lamp,
                                      const std::string& method) {
    std::vector<const PapersRow*> rows;
    for (const PapersRow& row : findings.rows)
        if (row.figure == figure && (lamp.empty() || row.lamp == lamp) &&
            (method.empty() || row.method == method))
            rows.push_back(&row);
    return rows;
}

}  // namespace nearfield::bench
