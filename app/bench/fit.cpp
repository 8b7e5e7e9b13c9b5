// SPDX-License-Identifier: Apache-2.0
#include "app/bench/fit.h"

#include "app/bench/fit_lamp.h"
#include "app/bench/fit_measurement.h"
#include "fit/smoothness.h"
#include "formats/files/provenance.h"
#include "formats/model/profile.h"
#include "sample_data/random.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <utility>

namespace nearfield::bench {
namespace {

// Sizes of a run.
struct Scale {
    glm::ivec2 texels;
    double node_spacing_m;
    int receivers;
    int solver_texels, compared_texels;
};

constexpr Scale kFull{{64, 48}, 0.002, 300, 256, 512};
constexpr Scale kQuick{{16, 12}, 0.005, 100, 24, 24};

// The stage's steps cover the lens, and every position is off by up to half a millimetre along U,
// as a stage's are.
fit::Optics optics_of(const FitSetting& setting, const Slab& planes) {
    constexpr double kOff_m = 0.0005;
    fit::Optics optics;
    optics.filter_x = optics.filter_y = model::make_profile("bspline");
    optics.filter_pitch_m = setting.filter_width * planes.pitch_m;
    sample_data::SplitMix random{3};
    for (int m = 0; m < planes.image_count(); ++m) {
        const glm::dvec2 off(random.next(), random.next());
        optics.position_m.emplace_back(planes.basis_center_m(m % planes.grid.x, m / planes.grid.x) +
                                           kOff_m * (2.0 * off - 1.0),
                                       -planes.delta_m);
    }
    return optics;
}

std::vector<bool> missing_of(const FitSetting& setting, int count) {
    const int wanted = static_cast<int>(std::lround(setting.missing_share * count));
    std::vector<bool> missing(static_cast<std::size_t>(count), false);
    sample_data::SplitMix random{5};
    for (int done = 0; done < wanted;) {
        const auto k = static_cast<std::size_t>(random.next() * count);
        done += missing[k] ? 0 : 1;
        missing[k] = true;
    }
    return missing;
}

double cpu_now_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The rows about the brightest one.
std::pair<fit::TileRange, fit::TileInput> bright_rows(const fit::TileInput& tile,
                                                      const Slab& planes) {
    constexpr int kRows = 4;
    const auto width = static_cast<std::size_t>(planes.texels.x);
    const std::size_t texels = planes.texel_count();
    std::vector<double> light(static_cast<std::size_t>(planes.texels.y), 0.0);
    for (std::size_t at = 0; at < tile.value.size(); ++at)
        light[at % texels / width] += double(tile.value[at]);
    const auto brightest =
        static_cast<int>(std::max_element(light.begin(), light.end()) - light.begin());
    const int rows = std::min(kRows, planes.texels.y);
    const int first = std::clamp(brightest - rows / 2, 0, planes.texels.y - rows);
    fit::TileInput part;
    for (std::size_t k = 0; k < tile.value.size() / texels; ++k) {
        const auto begin =
            static_cast<std::ptrdiff_t>(k * texels + static_cast<std::size_t>(first) * width);
        const auto end =
            begin + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(rows) * width);
        part.value.insert(part.value.end(), tile.value.begin() + begin, tile.value.begin() + end);
        part.variance.insert(part.variance.end(), tile.variance.begin() + begin,
                             tile.variance.begin() + end);
    }
    return std::pair(fit::TileRange{first, rows}, std::move(part));
}

double chosen_lambda(const fit::Design& design,
                     const fit::FitOptions& options,
                     const fit::TileInput& tile,
                     const Slab& planes,
                     int positions) {
    constexpr int kTexelsAsked = 16;  // of a row
    fit::SmoothnessOptions smoothness;
    smoothness.lambdas = {0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
    smoothness.texel_step = std::max(1, planes.texels.x / kTexelsAsked);
    smoothness.folds = std::min(smoothness.folds, positions);
    const auto [rows, part] = bright_rows(tile, planes);
    const fit::SmoothnessCurve curve = cross_validate(design, options, smoothness, rows, part);
    return curve.lambda[curve.best];
}

// A fit as a light field whose S is z = 0.
LightField as_lightfield(const Slab& planes, const fit::TileResult& fitted) {
    LightField lightfield;
    lightfield.slabs = {planes};
    lightfield.slabs.front().coeffs = fitted.coeffs;
    lightfield.slabs.front().sigma = fitted.sigma;
    return lightfield;
}

// Irradiance of both fits at the receivers, against each other and the formula.
void compare(const LitReceivers& receivers,
             const LightField& fitted,
             const LightField& noise_free,
             FitResult& result) {
    const std::size_t count = receivers.at_lens.size();
    const double delta_m = fitted.slabs.front().delta_m;
    std::vector<glm::dvec4> off(count);  // of fit, of basis, of both, in sigmas
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        model::Receiver receiver = receivers.at_lens[k];
        receiver.position_m.z -= delta_m;
        const double lx = model::luminance(model::irradiance(fitted, receiver));
        const double free_lx = model::luminance(model::irradiance(noise_free, receiver));
        const double sigma_lx = model::irradiance_sigma_y(fitted, receiver);
        off[k] = {lx / free_lx - 1, free_lx / receivers.truth_lx[k] - 1,
                  lx / receivers.truth_lx[k] - 1, (lx - free_lx) / sigma_lx};
    });
    glm::dvec4 square(0.0);
    double covered = 0;
    for (const glm::dvec4& one : off) {
        square += one * one;
        covered += std::abs(one.w) <= 3 ? 1 : 0;
    }
    const glm::dvec4 rms = glm::sqrt(square / static_cast<double>(count));
    result.noise_rms = rms.x;
    result.basis_rms = rms.y;
    result.total_rms = rms.z;
    result.coverage = covered / static_cast<double>(count);
}

FitResult measured_and_fitted(const FitSetting& setting,
                              const LampLight& light,
                              const LitReceivers& receivers,
                              double flux_lm,
                              std::uint32_t seed) {
    // The bspline's steps for all bases: what is compared is the basis, not the stage.
    Slab planes = sample_data::headlight_planes(setting.delta_m, setting.grid, light.planes.texels,
                                                "bspline", Weighting::Irradiance, 1);
    planes.profile = model::make_profile(setting.basis);
    const fit::Optics optics = optics_of(setting, planes);
    const std::size_t positions = optics.position_m.size();
    const std::vector<bool> missing = missing_of(setting, static_cast<int>(positions));
    const fit::Design design = make_design(planes, optics);
    const std::vector<double> exact_lx = measured_lx(light, optics);
    fit::TileInput tile =
        photographed(exact_lx, missing, {setting.exposures, setting.frames}, seed);

    fit::FitOptions options;
    options.keeps_light = true;
    options.model_error_rel = setting.model_error_rel;
    FitResult result;
    result.setting = setting;
    result.positions = static_cast<int>(std::count(missing.begin(), missing.end(), false));
    result.lambda = setting.lambda
                        ? *setting.lambda
                        : chosen_lambda(design, options, tile, planes, static_cast<int>(positions));
    options.solve.lambda = result.lambda;
    options.solve.wants_sigma = true;
    const fit::TileRange all{0, planes.texels.y};
    fit::FitReport report, unused;
    const double start_s = cpu_now_s();
    const LightField fitted = as_lightfield(planes, solve_tile(design, options, all, tile, report));
    const auto texels = static_cast<double>(planes.texel_count());
    result.texel_us = 1e6 * (cpu_now_s() - start_s) / texels;
    result.factorizations = static_cast<double>(report.factorizations) / texels;
    result.chi_square = report.reduced_chi_square();
    result.kkt_worst = report.kkt_worst;

    // The same weights, without the noise.
    std::transform(exact_lx.begin(), exact_lx.end(), tile.value.begin(),
                   [](double lx) { return static_cast<float>(lx); });
    options.solve.wants_sigma = false;
    const LightField noise_free =
        as_lightfield(planes, solve_tile(design, options, all, tile, unused));
    compare(receivers, fitted, noise_free, result);
    result.flux_rel = model::luminance(model::flux(fitted)) / flux_lm - 1;
    return result;
}

}  // namespace

FitFindings run_fit_sweeps(const FitSweepOptions& options,
                           const std::function<void(double fraction)>& progress) {
    constexpr double kSolversShare = 0.3;  // of the time, about
    const double start_s = now_s();
    const Scale& scale = options.quick ? kQuick : kFull;
    const sample_data::Headlight headlight = sample_data::make_headlight();
    const LitReceivers receivers = lit_receivers(headlight, scale.receivers);
    const double flux_lm = model::luminance(sample_data::flux(headlight));
    const std::vector<FitSetting> settings = fit_settings(options.quick);
    FitFindings findings;
    findings.texels = scale.texels;
    findings.receivers = static_cast<int>(receivers.at_lens.size());
    std::map<double, LampLight> lights;  // by delta: the lens' light is the dearest part
    for (const FitSetting& setting : settings) {
        auto light = lights.find(setting.delta_m);
        if (light == lights.end())
            light = lights
                        .emplace(setting.delta_m, lamp_light(headlight, setting.delta_m,
                                                             scale.texels, scale.node_spacing_m))
                        .first;
        findings.results.push_back(
            measured_and_fitted(setting, light->second, receivers, flux_lm, options.seed));
        progress((1 - kSolversShare) * static_cast<double>(findings.results.size()) /
                 static_cast<double>(settings.size()));
    }
    findings.solvers = compare_solvers(scale.solver_texels, scale.compared_texels);
    progress(1);
    findings.time_s = now_s() - start_s;
    return findings;
}

}  // namespace nearfield::bench
