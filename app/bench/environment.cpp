// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment.h"

#include "app/bench/environment_scenes.h"
#include "formats/files/provenance.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/render.h"
#include "render/film.h"
#include "render/gpu/render.h"
#include "render/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

namespace nearfield::bench {
namespace {

using render::EnvironmentMethod, render::EnvironmentOptions, render::FilterLevel;

/// Frames, numbers and what is known so far.
struct Sweep {
    std::string picture;
    Mesh mesh;
    render::RenderOptions options;  // of all pictures
    int reference_samples = 0;
    std::vector<int> counts;  // of samples
    std::vector<float> exponents;
    bool quick = false;
    std::function<void()> step;
    EnvironmentFindings& findings;
};

/// The environment's light where a surface is seen, r g b.
std::vector<float> surface_light(const Picture& picture) {
    const std::vector<float>& depth = picture.layers[render::kDepth].values;
    const std::vector<float>& light =
        picture.layers[*render::find_layer(picture, "environment")].values;
    std::vector<float> seen;
    for (std::size_t k = 0; k < depth.size(); ++k)
        if (depth[k] > 0.0F)
            seen.insert(seen.end(), light.begin() + static_cast<std::ptrdiff_t>(3 * k),
                        light.begin() + static_cast<std::ptrdiff_t>(3 * k + 3));
    return seen;
}

std::vector<float> luminances(const std::vector<float>& rgb) {
    std::vector<float> y;
    for (std::size_t k = 0; k < rgb.size(); k += 3)
        y.push_back(shared::luminance709({rgb[k], rgb[k + 1], rgb[k + 2]}));
    return y;
}

double environment_s(const render::RenderReport& report) {
    double time_s = 0.0;
    for (const render::PassReport& pass : report.costs)
        if (pass.id == render::PassId::EnvironmentSamples ||
            pass.id == render::PassId::EnvironmentIrradiance ||
            pass.id == render::PassId::EnvironmentMaps)
            time_s += pass.time_s;
    return time_s;
}

/// Fills in how far a picture is from its reference.
void compare(const std::vector<float>& rgb,
             const std::vector<float>& truth_rgb,
             EnvironmentRow& row) {
    const std::vector<float> values = luminances(rgb), truth = luminances(truth_rgb);
    double sum = 0.0, truth_sum = 0.0, squares = 0.0, toned = 0.0;
    for (const float value : truth)
        truth_sum += static_cast<double>(value);
    const auto count = static_cast<double>(truth.size());
    const double mean = truth_sum / count;
    for (std::size_t k = 0; k < truth.size(); ++k) {
        const auto a = static_cast<double>(values[k]), b = static_cast<double>(truth[k]);
        sum += a;
        squares += (a - b) * (a - b);
        toned += std::pow(std::exp(-a / mean) - std::exp(-b / mean), 2);
    }
    row.rms = render::relative_error(values, truth).rms;
    row.rms_mean = std::sqrt(squares / count) / mean;
    row.rms_toned = std::sqrt(toned / count);
    row.lab = render::lab_difference(rgb, truth_rgb);
    row.bias = sum / truth_sum - 1.0;
}

EnvironmentOptions filtered(int samples, int suns, FilterLevel level = FilterLevel::Fis) {
    EnvironmentOptions options;
    options.samples = samples;
    options.suns = suns;
    options.level = level;
    return options;
}

EnvironmentOptions lamps(int count) {
    EnvironmentOptions options;
    options.method = EnvironmentMethod::Lights;
    options.directions = count;
    return options;
}

render::Rendered reference(const Sweep& sweep, const Scene& scene, std::uint32_t seed) {
    render::RenderOptions options = sweep.options;
    options.environment.method = EnvironmentMethod::Reference;
    options.samples = sweep.reference_samples;
    options.seed = seed;
    return render::render_cpu(scene, options);
}

/// A scene, its reference, and that one's own noise as a row: two with other random numbers apart.
struct Subject {
    Scene scene;
    std::string study, name;
    std::vector<float> truth;
};

Subject make_subject(Sweep& sweep, Scene scene, const std::string& study, const std::string& name) {
    Subject subject{std::move(scene), study, name, {}};
    const render::Rendered first = reference(sweep, subject.scene, 1);
    subject.truth = surface_light(first.picture);
    EnvironmentRow row{study, name, "reference", sweep.reference_samples};
    compare(surface_light(reference(sweep, subject.scene, 2).picture), subject.truth, row);
    row.time_s = environment_s(first.report);
    sweep.findings.rows.push_back(row);
    sweep.step();
    return subject;
}

void measure(Sweep& sweep,
             const Subject& subject,
             const std::string& method,
             int samples,
             const EnvironmentOptions& environment,
             bool by_gl = false) {
    render::RenderOptions options = sweep.options;
    options.environment = environment;
    const render::Rendered rendered = by_gl ? render::render_gl(subject.scene, options)
                                            : render::render_cpu(subject.scene, options);
    EnvironmentRow row{subject.study, subject.name, method, samples};
    compare(surface_light(rendered.picture), subject.truth, row);
    row.time_s = environment_s(rendered.report);
    sweep.findings.rows.push_back(row);
    if (by_gl)
        sweep.findings.device = rendered.report.device;
    sweep.step();
}

/// Every way to find unshadowed light, over the number of samples.
void sweep_surfaces(Sweep& sweep, const Mesh& mesh, const std::string& study) {
    for (const float exponent : sweep.exponents) {
        const Subject subject = make_subject(sweep, scene_of(mesh, phong(exponent), sweep.picture),
                                             study, fmt::format("exponent {}", exponent));
        for (const int n : sweep.counts) {
            measure(sweep, subject, "fis", n, filtered(n, 0));
            measure(sweep, subject, "fis, suns apart", n, filtered(n, 32));
            measure(sweep, subject, "gems", n, filtered(n, 0, FilterLevel::Gems));
            measure(sweep, subject, "mfis", n, filtered(n, 0, FilterLevel::Mfis));
            measure(sweep, subject, "mfis, suns apart", n, filtered(n, 32, FilterLevel::Mfis));
            measure(sweep, subject, "unfiltered", n, filtered(n, 0, FilterLevel::None));
            EnvironmentOptions random = filtered(n, 0, FilterLevel::None);
            random.is_shifted = true;
            measure(sweep, subject, "unfiltered, random", n, random);
            measure(sweep, subject, "far lamps", n, lamps(n));
        }
    }
}

void sweep_brushed(Sweep& sweep) {
    const Mesh ball = make_ball(sweep.quick ? 24 : 64, 0.0);
    for (const auto& [x, y] :
         {std::pair(0.1F, 0.1F), std::pair(0.1F, 0.29F), std::pair(0.01F, 0.29F)}) {
        const Subject subject = make_subject(sweep, scene_of(ball, ward(x, y), sweep.picture),
                                             "anisotropic", fmt::format("alpha {}, {}", x, y));
        for (const int n : {50, 512}) {
            EnvironmentOptions along = filtered(n, 0);
            along.is_anisotropic = true;
            measure(sweep, subject, "fis", n, filtered(n, 0));
            measure(sweep, subject, "mfis", n, filtered(n, 0, FilterLevel::Mfis));
            measure(sweep, subject, "along the longer axis", n, along);
            measure(sweep, subject, "unfiltered", n, filtered(n, 0, FilterLevel::None));
        }
    }
}

/// Diffuse light on the mesh and on the floor below it, so that all errors are harmonics' and
/// visibility's.
void sweep_visibility(Sweep& sweep) {
    Scene scene = scene_of(sweep.mesh, matt(), sweep.picture);
    add_floor(scene);
    sweep.options.effects.shadows = render::Switch::Auto;
    const Subject subject = make_subject(sweep, std::move(scene), "visibility", "diffuse");
    const auto asked = [](int directions) {
        EnvironmentOptions options;
        options.directions = directions;
        return options;
    };
    measure(sweep, subject, "no shadows", 0, asked(0));
    for (const int n : {8, 16, 64}) {
        measure(sweep, subject, "rays", n, asked(n));
        measure(sweep, subject, "maps", n, asked(n), true);
    }
    // More say no more of the sky than its harmonics can hold.
    const int all = sweep.quick ? 256 : 10000;
    measure(sweep, subject, "rays", all, asked(all));
    sweep.options.effects.shadows = render::Switch::Off;
}

/// Time on the graphics card against samples and against triangles.
void sweep_time(Sweep& sweep) {
    const std::vector<int> rows = sweep.quick ? std::vector{12, 24} : std::vector{16, 50, 160, 500};
    for (const int count : rows) {
        const Mesh mesh = make_ball(count, 0.05);
        Scene scene = scene_of(mesh, phong(50.0F), sweep.picture);
        add_floor(scene);
        const Subject subject{
            scene, "time", fmt::format("{} triangles", mesh.triangles.size()), {}};
        for (const int n : {8, 16, 64}) {
            render::RenderOptions options = sweep.options;
            options.effects.shadows = render::Switch::On;
            options.environment.directions = n;
            double least_s = 1e30;
            for (int k = 0; k < 3; ++k)
                least_s = std::min(least_s,
                                   environment_s(render::render_gl(subject.scene, options).report));
            sweep.findings.rows.push_back(
                {"time", subject.name, "maps and light", n, 0, 0, 0, 0, 0, least_s});
            sweep.step();
        }
    }
}

}  // namespace

EnvironmentFindings run_environment_sweeps(const EnvironmentSweepOptions& options,
                                           const std::function<void(double fraction)>& progress) {
    const double start_s = now_s();
    EnvironmentFindings findings;
    double done = 0.0;
    const double steps = options.quick ? 70.0 : 460.0;  // about, for the progress line
    Sweep sweep{options.picture,
                {},
                {},
                options.quick ? 256 : 2048,
                {},
                {},
                options.quick,
                [&] { progress(std::min(++done / steps, 1.0)); },
                findings};
    if (sweep.picture.empty()) {
        sweep.picture = (std::filesystem::path(options.folder) / "hall.exr").string();
        write_hall(sweep.picture);
    }
    findings.picture = options.picture.empty() ? "a hall by formula" : options.picture;
    findings.mesh = options.mesh.empty() ? "a knobby ball" : options.mesh;
    sweep.mesh =
        options.mesh.empty() ? make_ball(options.quick ? 32 : 96, 0.08) : read_mesh(options.mesh);
    findings.frame_px = options.quick ? 24 : 48;
    findings.reference_samples = sweep.reference_samples;
    sweep.options.size_px = glm::ivec2(findings.frame_px);
    sweep.options.effects.shadows = render::Switch::Off;
    sweep.counts =
        options.quick ? std::vector{8, 64} : std::vector{8, 16, 32, 50, 64, 128, 256, 512};
    sweep.exponents = options.quick ? std::vector{20.0F} : std::vector{5.0F, 20.0F, 100.0F, 500.0F};
    sweep_surfaces(sweep, make_ball(options.quick ? 24 : 64, 0.0), "sphere");
    sweep.exponents = options.quick ? std::vector{20.0F} : std::vector{20.0F, 100.0F};
    sweep_surfaces(sweep, sweep.mesh, "mesh");
    sweep_brushed(sweep);
    sweep_visibility(sweep);
    sweep_time(sweep);
    findings.time_s = now_s() - start_s;
    return findings;
}

}  // namespace nearfield::bench
