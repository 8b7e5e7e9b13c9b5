// SPDX-License-Identifier: Apache-2.0
#include "app/lab_closure.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "sample_data/bench/lens_light.h"
#include "sample_data/headlight.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {


double value_at_center(const Profile& profile) {
    return model::eval(profile, 0.0);
}

// The real bench in the rig's slab frame.
struct RealBench {
    const sample_data::Bench& bench;
    sample_data::Places places;
    Rigid bench_from_slab;

    glm::dvec3 filter_center_slab(std::size_t position) const {
        const glm::dvec3 at_bench =
            apply(places.bench_from_filter, glm::dvec3(places.position_m[position], 0.0));
        return apply(inverse(bench_from_slab), at_bench);
    }
};

// Optics as they really are.
fit::Optics real_optics(const RealBench& real) {
    fit::Optics optics;
    for (std::size_t k = 0; k < real.places.position_m.size(); ++k)
        optics.position_m.push_back(real.filter_center_slab(k));
    Profile profile = real.bench.filter.profile;
    const double peak = value_at_center(profile);
    for (std::array<double, 3>& cell : profile.cells)
        for (double& coefficient : cell)
            coefficient /= peak;
    optics.filter_x = optics.filter_y = profile;
    optics.filter_pitch_m = real.bench.filter.pitch_m;
    const glm::dvec3 normal = glm::transpose(real.bench_from_slab.rotation) *
                              real.places.bench_from_filter.rotation * glm::dvec3(0, 0, 1);
    optics.filter_slope = {-normal.x / normal.z, -normal.y / normal.z};
    return optics;
}

// Luminance through the filter over its transmission: what a filter of peak 1 would let through.
sample_data::SeenColors luminance_through(const sample_data::BenchFilter& filter) {
    const double peak = value_at_center(filter.profile);
    glm::dvec3 weights(0.0);
    for (int c = 0; c < 3; ++c)
        weights[c] =
            kLuminanceRgb[static_cast<std::size_t>(c)] / (filter.transmission[c] * peak * peak);
    return {weights};
}

// Noise-free measurements of rows of texels: illuminance at their centers behind every position.
fit::TileInput noise_free_tile(const RealBench& real,
                               const sample_data::LensLight& light,
                               const Slab& planes,
                               double model_error_rel,
                               fit::TileRange rows) {
    const auto width = static_cast<std::size_t>(planes.texels.x);
    const std::size_t count = width * static_cast<std::size_t>(rows.row_count);
    const std::size_t positions = real.places.position_m.size();
    fit::TileInput tile;
    tile.value.resize(positions * count);
    tile.variance.resize(positions * count);
    const glm::dvec3 to_lamp = real.bench_from_slab.rotation * glm::dvec3(0, 0, -1);
    const sample_data::SeenColors colors = luminance_through(real.bench.filter);
    tbb::parallel_for(0, rows.row_count, [&](int row) {
        std::vector<glm::dvec3> points;
        points.reserve(width);
        for (int i = 0; i < planes.texels.x; ++i) {
            const glm::dvec2 s_m =
                planes.s_min_m + (glm::dvec2(i, rows.first_row + row) + 0.5) * planes.texel_m();
            points.push_back(apply(real.bench_from_slab, glm::dvec3(s_m, 0.0)));
        }
        const sample_data::LineLight line =
            line_light(light, points, to_lamp, colors, static_cast<int>(positions));
        for (std::size_t i = 0; i < width; ++i) {
            const std::size_t t = static_cast<std::size_t>(row) * width + i;
            double brightest = 0;
            for (std::size_t k = 0; k < positions; ++k)
                brightest = std::max(brightest, line.positions[k * width + i]);
            const double error = std::max(model_error_rel, 1e-6) * std::max(brightest, 1e-6);
            for (std::size_t k = 0; k < positions; ++k) {
                tile.value[k * count + t] = static_cast<float>(line.positions[k * width + i]);
                tile.variance[k * count + t] = static_cast<float>(error * error);
            }
        }
    });
    return tile;
}

LightField noise_free_fit(const RealBench& real,
                          const fit::CaptureFit& fit,
                          double model_error_rel) {
    LightField lightfield = fit.lightfield;
    Slab& slab = lightfield.slabs.front();
    slab.channels = 1;
    slab.sigma.clear();
    slab.coeffs.assign(static_cast<std::size_t>(slab.image_count()) * slab.texel_count(), 0.0F);
    const sample_data::LensLight light =
        make_lens_light(real.bench, real.places, sample_data::make_ray_lamp(real.bench.lamp),
                        real.bench.delta_m, real.bench.accuracy.lens_step);
    const fit::Design design = fit::make_design(slab, real_optics(real));
    fit::FitOptions options;
    options.solve.lambda = fit.lambda;
    fit::solve_lightfield(
        design, options,
        [&](fit::TileRange rows) {
            return noise_free_tile(real, light, slab, model_error_rel, rows);
        },
        [&](const fit::TileResult& tile) {
            const std::size_t count = static_cast<std::size_t>(tile.rows.row_count) *
                                      static_cast<std::size_t>(slab.texels.x);
            const std::size_t first = static_cast<std::size_t>(tile.rows.first_row) *
                                      static_cast<std::size_t>(slab.texels.x);
            for (std::size_t m = 0; m < static_cast<std::size_t>(slab.image_count()); ++m)
                std::copy_n(tile.coeffs.begin() + static_cast<std::ptrdiff_t>(m * count), count,
                            slab.coeffs.begin() +
                                static_cast<std::ptrdiff_t>(m * slab.texel_count() + first));
        });
    return lightfield;
}

// 1 ... 25 m away, over the beam's window, by the R2 sequence (Roberts 2018).
std::vector<glm::dvec3> receiver_places(double delta_m) {
    constexpr int kCount = 300;
    constexpr double kNear_m = 1, kFar_m = 25;
    const glm::dvec3 step(0.8191725133961645, 0.6710436067037893, 0.5497004779019703);
    std::vector<glm::dvec3> places;
    for (int k = 0; k < kCount; ++k) {
        const glm::dvec3 x = glm::fract(glm::dvec3(0.5) + (k + 1.0) * step);
        const double distance_m = kNear_m * std::pow(kFar_m / kNear_m, x.z);
        const glm::dvec2 tangent =
            glm::mix(0.9 * sample_data::kBeamMin, 0.9 * sample_data::kBeamMax, glm::dvec2(x));
        places.emplace_back(distance_m * tangent, distance_m - delta_m);
    }
    return places;
}

double real_delta_m(const RealBench& real) {
    glm::dvec3 middle(0.0);
    for (std::size_t k = 0; k < real.places.position_m.size(); ++k)
        middle += apply(real.places.bench_from_filter, glm::dvec3(real.places.position_m[k], 0.0)) /
                  static_cast<double>(real.places.position_m.size());
    return -apply(inverse(real.places.bench_from_screen), middle).z;
}

void summarize(Closure& closure) {
    const auto intensity = [](const ClosureReceiver& receiver) {
        return receiver.truth_lx * glm::dot(receiver.at_slab_m, receiver.at_slab_m);
    };
    double most = 0;
    for (const ClosureReceiver& receiver : closure.receivers)
        most = std::max(most, intensity(receiver));
    double square = 0, square_truth = 0;
    int count = 0, covered = 0;
    for (const ClosureReceiver& receiver : closure.receivers) {
        constexpr double kDark = 0.01;
        if (intensity(receiver) < kDark * most)
            continue;
        const double error = receiver.fitted_lx / receiver.noise_free_lx - 1;
        square += error * error;
        square_truth += std::pow(receiver.fitted_lx / receiver.truth_lx - 1, 2);
        covered += std::abs(receiver.fitted_lx - receiver.noise_free_lx) <= 3 * receiver.sigma_lx;
        ++count;
    }
    closure.irradiance_rms = std::sqrt(square / count);
    closure.irradiance_rms_truth = std::sqrt(square_truth / count);
    closure.coverage_3sigma = static_cast<double>(covered) / count;
}

}  // namespace

Closure closure_of(const sample_data::Bench& bench,
                   double time_s,
                   const rig::Rig& rig,
                   const fit::CaptureFit& fit,
                   double model_error_rel) {
    if (!bench.lamp.file.empty())
        throw Error{"the truth is not known by formula", "lamp.file", "the headlight",
                    bench.lamp.file};
    const RealBench real{bench, sample_data::make_places(bench),
                         bench.camera.bench_from_camera * rig.planes->camera_from_slab};
    const sample_data::Headlight headlight = sample_data::make_headlight(bench.lamp.headlight_seed);
    const LightField noise_free = noise_free_fit(real, fit, model_error_rel);
    Closure closure;
    closure.lamp_factor = sample_data::lamp_factor(bench, time_s);
    const Rigid lamp_from_slab = inverse(real.places.bench_from_lamp) * real.bench_from_slab;
    const std::vector<glm::dvec3> places = receiver_places(rig.planes->delta_m);
    closure.receivers.resize(places.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t k) {
        const glm::dvec3 toward =
            -glm::normalize(places[k] + glm::dvec3(0, 0, rig.planes->delta_m));
        const model::Receiver in_slab{places[k], toward};
        const model::Receiver in_lamp{apply(lamp_from_slab, places[k]),
                                      lamp_from_slab.rotation * toward};
        ClosureReceiver& receiver = closure.receivers[k];
        receiver.at_slab_m = places[k];
        receiver.truth_lx =
            closure.lamp_factor * model::luminance(sample_data::irradiance(headlight, in_lamp));
        receiver.fitted_lx = model::luminance(model::irradiance(fit.lightfield, in_slab));
        receiver.noise_free_lx =
            closure.lamp_factor * model::luminance(model::irradiance(noise_free, in_slab));
        receiver.sigma_lx = std::hypot(model::irradiance_sigma_y(fit.lightfield, in_slab),
                                       fit.lightfield.scale_sigma_rel * receiver.fitted_lx);
    });
    summarize(closure);
    const double flux_lm = closure.lamp_factor * model::luminance(sample_data::flux(headlight));
    closure.flux_rel = model::luminance(model::flux(fit.lightfield)) / flux_lm - 1;
    closure.noise_free_flux_rel =
        closure.lamp_factor * model::luminance(model::flux(noise_free)) / flux_lm - 1;
    closure.delta_rel = rig.planes->delta_m / real_delta_m(real) - 1;
    return closure;
}

}  // namespace nearfield::app
