// SPDX-License-Identifier: Apache-2.0
#include "app/bench/papers_run.h"
#include "app/bench/shadows.h"
#include "render/device.h"
#include "render/film.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

namespace nearfield::bench {
namespace {

using render::Device;
using render::ShadowEye;

constexpr const char* kFrameView = "road";
constexpr int kFrameSamples = 200;  // of a pixel and lamp, the paper's
constexpr glm::ivec2 kPapersSize_px{1024, 768}, kFewPixels_px{8, 6};

// What the paper renders a frame from: as many maps as its lamps have cells.
struct FrameCase {
    const char* lamp;
    int lamps;
    int map_px;
};

PapersRow row_of_frame(const FrameCase& of,
                       const std::string& figure,
                       const render::Rendered& rendered,
                       const render::RenderOptions& options) {
    PapersRow row;
    row.figure = figure;
    row.lamp = of.lamps == 1 ? of.lamp : fmt::format("{} x {}", of.lamps, of.lamp);
    row.view = kFrameView;
    row.device = rendered.report.device;
    row.method = options.sampler ? model::name_of(*options.sampler) : "sum";
    row.samples = options.samples;
    row.size_px = rendered.picture.size_px;
    return row;
}

// All passes of a frame: loading lamps, which happens once, is not among them.
double frame_s(const render::RenderReport& report) {
    double sum_s = 0.0;
    for (const render::PassReport& pass : report.costs)
        sum_s += pass.time_s;
    return sum_s;
}

const char* name_of(const render::Plan& plan, render::PassId id) {
    for (const render::PlannedPass& pass : plan.passes)
        if (pass.id == id)
            return pass.name;
    return "";
}

void add_rendered(const PapersOptions& options,
                  const FrameCase& of,
                  const render::RenderOptions& render_options,
                  bool has_passes,
                  PapersFindings& findings) {
    const Scene scene = make_papers_scene(lamp_of(findings, of.lamp), options.folder, of.lamps);
    const render::Rendered rendered = render::render(scene, render_options);
    PapersRow row = row_of_frame(of, "2", rendered, render_options);
    row.time_s = frame_s(rendered.report);
    findings.rows.push_back(row);
    if (rendered.report.lamp_bytes > 0.0 && of.lamps == 1) {
        PapersRow textures = row;
        textures.figure = "tables";
        textures.method = "textures for " + row.method;
        textures.time_s.reset();
        textures.bytes = rendered.report.lamp_bytes;
        findings.rows.push_back(textures);
    }
    if (!has_passes)
        return;
    for (const render::PassReport& pass : rendered.report.costs) {
        PapersRow part = row_of_frame(of, "10", rendered, render_options);
        part.setting = name_of(rendered.report.plan, pass.id);
        part.time_s = pass.time_s;
        part.share = pass.time_s / *row.time_s;
        findings.rows.push_back(part);
    }
}

render::RenderOptions frame_options(Device device, glm::ivec2 size_px) {
    render::RenderOptions options;
    options.device = device;
    options.size_px = size_px;
    options.camera = kFrameView;
    options.samples = kFrameSamples;
    return options;
}

render::Rendered render_light(const Scene& scene,
                              glm::ivec2 size_px,
                              Device device,
                              const render::ShadowMapOptions& maps,
                              int samples) {
    render::RenderOptions options = frame_options(device, size_px);
    options.samples = samples;
    options.shadow_maps = maps;
    options.effects.gloss = render::Switch::Off;
    return render::render(scene, options);
}

// Irradiance as gray, [row from below][column].
std::vector<float> light_of(const render::Rendered& rendered) {
    const std::vector<float>& rgb = rendered.picture.layers[render::kIrradiance].values;
    const glm::ivec2 size = rendered.picture.size_px;
    std::vector<float> y;
    for (int row = size.y - 1; row >= 0; --row)
        for (int column = 0; column < size.x; ++column) {
            const auto k = 3 * static_cast<std::size_t>(row * size.x + column);
            y.push_back(static_cast<float>(model::luminance({rgb[k], rgb[k + 1], rgb[k + 2]})));
        }
    return y;
}

}  // namespace

void measure_shadows(const PapersOptions& options, PapersFindings& findings) {
    const FrameCase of{"5x5", 1, 192};
    const Scene scene = make_papers_scene(lamp_of(findings, of.lamp), options.folder, of.lamps);
    const glm::ivec2 size_px = findings.render_px;
    ShadowSweepOptions sweep;
    sweep.camera = kFrameView;
    sweep.size_px = size_px;
    sweep.samples = options.quick ? 64 : 1024;
    sweep.repeats = 1;
    sweep.maps.clear();
    sweep.map_px = {768};
    const ShadowFindings shadows = run_shadow_sweeps(scene, sweep, [](double) {});
    const auto add = [&](const std::string& method, const std::string& setting, double lab) {
        PapersRow row;
        row.figure = "7";
        row.lamp = of.lamp;
        row.view = kFrameView;
        row.device = shadows.device;
        row.method = method;
        row.setting = setting;
        row.size_px = size_px;
        row.lab = lab;
        findings.rows.push_back(row);
    };
    for (const ShadowResult& result : shadows.results) {
        add(result.sweep, result.setting, result.lab);
        findings.rows.back().time_s = result.maps_s;
        findings.rows.back().bytes = result.bytes;
    }
    add("none", "no shadows at all", shadows.lab_without);
    add("rays", "other random numbers", shadows.lab_noise);

    const std::vector<float> traced =
        light_of(render_light(scene, size_px, Device::Cpu, {}, sweep.samples));
    const auto show = [&](const std::string& name, const std::string& caption,
                          const std::vector<float>& y) {
        const std::string file = "figure7_" + name + ".png";
        findings.pictures.push_back(
            {"7", file,
             write_view((std::filesystem::path(options.folder) / file).string(), caption, size_px,
                        y, traced)});
        if (auto error = draw_error(caption + ", difference to rays", size_px, y, traced))
            findings.pictures.push_back({"7", "", std::move(*error)});
    };
    show("rays", "traced rays", traced);
    for (const auto& [eye, name] :
         {std::pair{ShadowEye::Paper, "paper"}, std::pair{ShadowEye::Cell, "cell"}}) {
        render::ShadowMapOptions maps;
        maps.eye = eye;
        show(name, fmt::format("49 maps, eye \"{}\"", name),
             light_of(render_light(scene, size_px, Device::Gl, maps, kFrameSamples)));
    }
}

void measure_frames(const PapersOptions& options, PapersFindings& findings) {
    std::vector<FrameCase> cases = {{"11x9", 2, 192}};
    if (!options.quick)
        cases.insert(cases.end(), {{"11x9", 1, 192}, {"5x5", 1, 192}, {"9x7", 1, 256}});
    for (const FrameCase& of : cases) {
        const bool has_passes = of.lamps == 2;
        for (const Device device : {Device::Gl, Device::Cpu}) {
            if (device == Device::Gl && findings.gl_device.empty())
                continue;
            render::RenderOptions frame = frame_options(device, findings.render_px);
            frame.shadow_maps.map_px = of.map_px;
            add_rendered(options, of, frame, has_passes, findings);
            for (const model::Sampler sampler :
                 {model::Sampler::Pdis, model::Sampler::Systematic}) {
                frame.sampler = sampler;
                add_rendered(options, of, frame, has_passes, findings);
            }
            // What a frame costs whatever its size: compiling shaders, shadow maps.
            frame.sampler = model::Sampler::Pdis;
            frame.size_px = kFewPixels_px;
            add_rendered(options, of, frame, false, findings);
        }
    }
    if (!options.quick)
        for (const FrameCase& of : cases)
            add_rendered(options, of, frame_options(Device::Cpu, kPapersSize_px), false, findings);
}

}  // namespace nearfield::bench
