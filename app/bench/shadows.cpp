// SPDX-License-Identifier: Apache-2.0
#include "app/bench/shadows.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "render/cpu/render.h"
#include "render/film.h"
#include "render/gpu/render.h"
#include "render/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace nearfield::bench {
namespace {

using render::ShadowEye;
using render::ShadowMapOptions;

/// Settings around the default ones, one option varied at a time.
std::vector<ShadowResult> settings(const ShadowSweepOptions& options) {
    std::vector<ShadowResult> all;
    const auto add = [&](const std::string& sweep, const std::string& setting,
                         const ShadowMapOptions& shadows) {
        all.push_back({sweep, setting, shadows, 0, 0, 0, 0});
    };
    ShadowMapOptions shadows;
    add("eye", "cell", shadows);
    shadows.eye = ShadowEye::Paper;
    add("eye", "paper", shadows);
    for (const int maps : options.maps) {
        shadows = {};
        shadows.maps = maps;
        add("maps", fmt::format("{}", maps), shadows);
    }
    add("maps", "all", {});
    for (const int map_px : options.map_px) {
        shadows = {};
        shadows.map_px = map_px;
        add("map-px", fmt::format("{}", map_px), shadows);
    }
    for (const int taps : {1, 4, 9, 16}) {
        shadows = {};
        shadows.pcf_taps = taps;
        add("pcf", fmt::format("{}", taps), shadows);
    }
    return all;
}

double cost_s(const render::RenderReport& report, render::PassId id) {
    double time_s = 0.0;
    for (const render::PassReport& pass : report.costs)
        time_s += pass.id == id ? pass.time_s : 0.0;
    return time_s;
}

double cost_bytes(const render::RenderReport& report, render::PassId id) {
    double bytes = 0.0;
    for (const render::PassReport& pass : report.costs)
        bytes += pass.id == id ? pass.bytes : 0.0;
    return bytes;
}

const std::vector<float>& irradiance(const render::Rendered& rendered) {
    return rendered.picture.layers[render::kIrradiance].values;
}

/// Fills in the result; returns the device's name.
std::string measure(const Scene& scene,
                    const render::RenderOptions& options,
                    int repeats,
                    const std::vector<float>& traced,
                    ShadowResult& result) {
    render::RenderOptions with_maps = options;
    with_maps.shadow_maps = result.options;
    std::string device;
    result.maps_s = result.light_s = std::numeric_limits<double>::infinity();
    for (int k = 0; k < repeats; ++k) {
        const render::Rendered rendered = render::render_gl(scene, with_maps);
        result.lab = render::lab_difference(irradiance(rendered), traced);
        result.maps_s =
            std::min(result.maps_s, cost_s(rendered.report, render::PassId::ShadowMaps));
        result.light_s =
            std::min(result.light_s, cost_s(rendered.report, render::PassId::LightSums));
        result.bytes = cost_bytes(rendered.report, render::PassId::ShadowMaps);
        device = rendered.report.device;
    }
    return device;
}

}  // namespace

ShadowFindings run_shadow_sweeps(const Scene& scene,
                                 const ShadowSweepOptions& options,
                                 const std::function<void(double fraction)>& progress) {
    const double start_s = now_s();
    render::RenderOptions traced_options;
    traced_options.camera = options.camera;
    traced_options.size_px = options.size_px;
    traced_options.samples = options.samples;
    traced_options.effects.gloss = render::Switch::Off;
    render::RenderOptions options_gl = traced_options;
    options_gl.device = render::Device::Gl;

    const render::Rendered traced = render::render_cpu(scene, traced_options);
    if (traced.report.shadow_rays == 0)
        throw Error{"no shadows to measure", "the scene",
                    "something between a lamp and what it lights", "nothing"};
    ShadowFindings findings;
    findings.results = settings(options);
    findings.traced_s = traced.report.time_s;
    findings.size_px = traced.picture.size_px;
    findings.samples = options.samples;
    findings.camera = render::find_camera(scene, options.camera).name;
    ++traced_options.seed;
    findings.lab_noise = render::lab_difference(
        irradiance(render::render_cpu(scene, traced_options)), irradiance(traced));

    render::RenderOptions without = options_gl;
    without.effects.shadows = render::Switch::Off;
    ShadowResult unshadowed;
    findings.device = measure(scene, without, options.repeats, irradiance(traced), unshadowed);
    findings.light_without_s = unshadowed.light_s;
    findings.lab_without = unshadowed.lab;
    double done = 0.0;
    for (ShadowResult& result : findings.results) {
        measure(scene, options_gl, options.repeats, irradiance(traced), result);
        progress(++done / static_cast<double>(findings.results.size()));
    }
    findings.time_s = now_s() - start_s;
    return findings;
}

}  // namespace nearfield::bench
