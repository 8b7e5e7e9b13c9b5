// SPDX-License-Identifier: Apache-2.0
#include "app/lab_truth.h"

#include "formats/files/error.h"
#include "formats/model/profile.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

double value_at_center(const Profile& profile) {
    return model::eval(profile, 0.0);
}

glm::dvec3 filter_center_slab(const LabTruth& truth, std::size_t position) {
    const glm::dvec3 at_bench =
        apply(truth.places.bench_from_filter, glm::dvec3(truth.places.position_m[position], 0.0));
    return apply(inverse(truth.bench_from_slab), at_bench);
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

// Midpoints of a texel along an axis: what a measurement sees is its mean, which differs from its
// center's light where directions change by more than a hundredth across it.
int parts_of(const Slab& planes) {
    constexpr double kFine = 0.01;  // of delta
    constexpr int kMost = 4;
    const glm::dvec2 texel_m = planes.texel_m();
    return std::clamp(
        static_cast<int>(std::ceil(std::max(texel_m.x, texel_m.y) / (kFine * planes.delta_m))), 1,
        kMost);
}

std::vector<glm::dvec3> points_on_row(const LabTruth& truth,
                                      const Slab& planes,
                                      int parts,
                                      int part_row) {
    const glm::dvec2 step_m = planes.texel_m() / static_cast<double>(parts);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < planes.texels.x * parts; ++i) {
        const glm::dvec2 s_m = planes.s_min_m + (glm::dvec2(i, part_row) + 0.5) * step_m;
        points.push_back(apply(truth.bench_from_slab, glm::dvec3(s_m, 0.0)));
    }
    return points;
}

}  // namespace

LabTruth lab_truth(const sample_data::Bench& bench, const rig::Rig& rig, double time_s) {
    if (!bench.lamp.file.empty())
        throw Error{"the truth is not known by formula", "lamp.file", "the headlight",
                    bench.lamp.file};
    return {bench, sample_data::make_places(bench),
            sample_data::make_headlight(bench.lamp.headlight_seed),
            bench.camera.bench_from_camera * rig.planes->camera_from_slab,
            sample_data::lamp_factor(bench, time_s)};
}

fit::Optics true_optics(const LabTruth& truth) {
    fit::Optics optics;
    for (std::size_t k = 0; k < truth.places.position_m.size(); ++k)
        optics.position_m.push_back(filter_center_slab(truth, k));
    Profile profile = truth.bench.filter.profile;
    const double peak = value_at_center(profile);
    for (std::array<double, 3>& cell : profile.cells)
        for (double& coefficient : cell)
            coefficient /= peak;
    optics.filter_x = optics.filter_y = profile;
    optics.filter_pitch_m = truth.bench.filter.pitch_m;
    const glm::dvec3 normal = glm::transpose(truth.bench_from_slab.rotation) *
                              truth.places.bench_from_filter.rotation * glm::dvec3(0, 0, 1);
    optics.filter_slope = {-normal.x / normal.z, -normal.y / normal.z};
    return optics;
}

double true_delta_m(const LabTruth& truth) {
    glm::dvec3 middle(0.0);
    for (std::size_t k = 0; k < truth.places.position_m.size(); ++k)
        middle +=
            apply(truth.places.bench_from_filter, glm::dvec3(truth.places.position_m[k], 0.0)) /
            static_cast<double>(truth.places.position_m.size());
    return -apply(inverse(truth.places.bench_from_screen), middle).z;
}

double true_flux_lm(const LabTruth& truth) {
    return truth.lamp_factor * model::luminance(sample_data::flux(truth.headlight));
}

double true_irradiance_lx(const LabTruth& truth, const model::Receiver& receiver_slab) {
    const Rigid lamp_from_slab = inverse(truth.places.bench_from_lamp) * truth.bench_from_slab;
    return truth.lamp_factor *
           model::luminance(sample_data::irradiance(
               truth.headlight, {apply(lamp_from_slab, receiver_slab.position_m),
                                 lamp_from_slab.rotation * receiver_slab.normal}));
}

TrueTexels true_texels(const LabTruth& truth, const Slab& planes) {
    const sample_data::LensLight light =
        make_lens_light(truth.bench, truth.places, sample_data::make_ray_lamp(truth.bench.lamp),
                        truth.bench.delta_m, truth.bench.accuracy.lens_step);
    const glm::dvec3 to_lamp = truth.bench_from_slab.rotation * glm::dvec3(0, 0, -1);
    const sample_data::SeenColors colors = luminance_through(truth.bench.filter);
    const auto width = static_cast<std::size_t>(planes.texels.x);
    TrueTexels texels{planes.texels, truth.places.position_m.size(), {}};
    texels.lux.resize(texels.positions * planes.texel_count());
    const int parts = parts_of(planes);
    const double share = truth.lamp_factor / (parts * parts);
    tbb::parallel_for(0, planes.texels.y, [&](int row) {
        float* const to = &texels.lux[static_cast<std::size_t>(row) * width];
        for (int part_row = parts * row; part_row < parts * (row + 1); ++part_row) {
            const std::vector<glm::dvec3> points = points_on_row(truth, planes, parts, part_row);
            const sample_data::LineLight line =
                line_light(light, points, to_lamp, colors, static_cast<int>(texels.positions));
            for (std::size_t k = 0; k < texels.positions; ++k)
                for (std::size_t i = 0; i < points.size(); ++i)
                    to[k * planes.texel_count() + i / static_cast<std::size_t>(parts)] +=
                        static_cast<float>(share * line.positions[k * points.size() + i]);
        }
    });
    return texels;
}

fit::TileInput TrueTexels::read(fit::TileRange rows) const {
    constexpr double kLeastError = 1e-6;  // of light; an error of nothing has no weight
    const auto width = static_cast<std::size_t>(texels.x);
    const std::size_t count = static_cast<std::size_t>(rows.row_count) * width;
    const std::size_t all = static_cast<std::size_t>(texels.y) * width;
    const std::size_t first = static_cast<std::size_t>(rows.first_row) * width;
    fit::TileInput tile;
    tile.value.resize(positions * count);
    tile.variance.resize(positions * count);
    for (std::size_t k = 0; k < positions; ++k)
        std::copy_n(lux.begin() + static_cast<std::ptrdiff_t>(k * all + first), count,
                    tile.value.begin() + static_cast<std::ptrdiff_t>(k * count));
    for (std::size_t t = 0; t < count; ++t) {
        double brightest = kLeastError;
        for (std::size_t k = 0; k < positions; ++k)
            brightest = std::max(brightest, double(tile.value[k * count + t]));
        const double error = kLeastError * brightest;
        for (std::size_t k = 0; k < positions; ++k)
            tile.variance[k * count + t] = static_cast<float>(error * error);
    }
    return tile;
}

LightField fit_true_texels(const TrueTexels& texels,
                           const Slab& planes,
                           const fit::Optics& optics,
                           double lambda,
                           double model_error_rel) {
    LightField lightfield;
    lightfield.slabs = {planes};
    Slab& slab = lightfield.slabs.front();
    slab.channels = 1;
    slab.sigma.clear();
    slab.coeffs.assign(static_cast<std::size_t>(slab.image_count()) * slab.texel_count(), 0.0F);
    fit::FitOptions options;
    options.solve.lambda = lambda;
    options.keeps_light = true;
    options.model_error_rel = model_error_rel;
    fit::solve_lightfield(
        fit::make_design(slab, optics), options,
        [&](fit::TileRange rows) { return texels.read(rows); },
        [&](const fit::TileResult& tile) {
            const auto width = static_cast<std::size_t>(slab.texels.x);
            const std::size_t count = static_cast<std::size_t>(tile.rows.row_count) * width;
            const std::size_t first = static_cast<std::size_t>(tile.rows.first_row) * width;
            for (std::size_t m = 0; m < static_cast<std::size_t>(slab.image_count()); ++m)
                std::copy_n(tile.coeffs.begin() + static_cast<std::ptrdiff_t>(m * count), count,
                            slab.coeffs.begin() +
                                static_cast<std::ptrdiff_t>(m * slab.texel_count() + first));
        });
    return lightfield;
}

}  // namespace nearfield::app
