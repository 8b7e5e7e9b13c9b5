// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment_sweep.h"

#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/render.h"
#include "render/film.h"
#include "render/gpu/render.h"
#include "render/metrics.h"

#include <algorithm>
#include <cmath>

namespace nearfield::bench {
namespace {

using render::EnvironmentMethod, render::EnvironmentOptions, render::FilterLevel;

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

/// Fills in how far a picture is from its reference.
void compare(const std::vector<float>& rgb,
             const std::vector<float>& truth_rgb,
             EnvironmentRow& row) {
    const std::vector<float> values = luminances(rgb), truth = luminances(truth_rgb);
    double sum = 0.0, truth_sum = 0.0, squares = 0.0, toned = 0.0, most = 0.0;
    for (const float value : truth)
        truth_sum += static_cast<double>(value);
    const auto count = static_cast<double>(truth.size());
    const double mean = truth_sum / count;
    for (std::size_t k = 0; k < truth.size(); ++k) {
        const auto a = static_cast<double>(values[k]), b = static_cast<double>(truth[k]);
        sum += a;
        squares += (a - b) * (a - b);
        toned += std::pow(std::exp(-a / mean) - std::exp(-b / mean), 2);
        most = std::max(most, a - b);
    }
    row.rms = render::relative_error(values, truth).rms;
    row.rms_mean = std::sqrt(squares / count) / mean;
    row.rms_toned = std::sqrt(toned / count);
    row.lab = render::lab_difference(rgb, truth_rgb);
    row.bias = sum / truth_sum - 1.0;
    row.spark = most / mean;
}

render::Rendered reference(const Sweep& sweep, const Scene& scene, std::uint32_t seed) {
    render::RenderOptions options = sweep.options;
    options.environment.method = EnvironmentMethod::Reference;
    options.samples = sweep.reference_samples;
    options.seed = seed;
    return render::render_cpu(scene, options);
}

void add_row(Sweep& sweep,
             const Subject& subject,
             const std::string& method,
             int samples,
             const render::Rendered& rendered) {
    EnvironmentRow row{subject.study, subject.name, method, samples};
    compare(surface_light(rendered.picture), subject.truth, row);
    row.time_s = environment_s(rendered.report);
    sweep.findings.rows.push_back(row);
    sweep.step();
}

}  // namespace

double environment_s(const render::RenderReport& report) {
    double time_s = 0.0;
    for (const render::PassReport& pass : report.costs)
        if (pass.id == render::PassId::EnvironmentSamples ||
            pass.id == render::PassId::EnvironmentIrradiance ||
            pass.id == render::PassId::EnvironmentMaps)
            time_s += pass.time_s;
    return time_s;
}

EnvironmentOptions filtered(int samples, int suns, FilterLevel level) {
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

Subject make_subject(Sweep& sweep, Scene scene, const std::string& study, const std::string& name) {
    Subject subject{std::move(scene), study, name, {}};
    const render::Rendered first = reference(sweep, subject.scene, 1);
    subject.truth = surface_light(first.picture);
    // Several camera samples of a pixel depend on the seed: other ones see other things.
    if (sweep.options.samples_per_pixel > 1)
        return subject;
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
             bool by_gl) {
    render::RenderOptions options = sweep.options;
    options.environment = environment;
    const render::Rendered rendered = by_gl ? render::render_gl(subject.scene, options)
                                            : render::render_cpu(subject.scene, options);
    if (by_gl)
        sweep.findings.device = rendered.report.device;
    add_row(sweep, subject, method, samples, rendered);
}

void measure_by_error(Sweep& sweep, const Subject& subject) {
    constexpr int kMost = 512;
    render::RenderOptions options = sweep.options;
    options.environment = filtered(kMost, 32);
    options.environment.samples = 1;
    const auto lobes =
        static_cast<double>(render::render_cpu(subject.scene, options).report.sky_samples);
    options.environment.samples = kMost;
    for (const double error_rel : {0.4, 0.2, 0.1, 0.05}) {
        options.environment.error_rel = error_rel;
        const render::Rendered rendered = render::render_cpu(subject.scene, options);
        const double mean = static_cast<double>(rendered.report.sky_samples) / std::max(lobes, 1.0);
        add_row(sweep, subject, "fis, suns apart, by error", static_cast<int>(std::lround(mean)),
                rendered);
    }
}

void measure_resampled(Sweep& sweep, const Subject& subject, int samples) {
    render::RenderOptions options = sweep.options;
    options.environment.method = EnvironmentMethod::Resampled;
    options.samples = samples;
    // The references' are 1 and 2: its candidates would be theirs, and its error none.
    options.seed = 3;
    add_row(sweep, subject, "resampled", samples, render::render_cpu(subject.scene, options));
}

}  // namespace nearfield::bench
