// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "sample_data/bench/bench_random.h"
#include "sample_data/bench/optics.h"
#include "sample_data/bench/prepare_parts.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::sample_data {
namespace {

// What all pictures of one bench may take.
constexpr double kMostBytes = 4.0 * (1ULL << 30U);

void check_memory(const Bench& bench) {
    const double pictures = position_count(bench) + 7.0 + double(bench.targets.views.size());
    const double bytes = sizeof(float) * pictures * bench.camera.size_px.x * bench.camera.size_px.y;
    if (bytes > kMostBytes)
        throw Error("pictures take too much memory", "filter.grid, camera.size_px", "at most 4 GiB",
                    fmt::format("{:.1f} GiB", bytes / (1ULL << 30U)));
}

// Pixels that are hot, and what else differs from pixel to pixel for good.
void prepare_pattern(PreparedBench& prepared) {
    const BenchCamera& camera = prepared.bench.camera;
    const auto count =
        static_cast<std::size_t>(camera.size_px.x) * static_cast<std::size_t>(camera.size_px.y);
    for (std::size_t k = 0; k < count; ++k) {
        const auto index = static_cast<std::uint32_t>(k);
        const auto draw = [&](Draw what) {
            return normal_pair(prepared.bench.seed, what, 0, index).x;
        };
        const double dark = 1.0 + camera.dsnu_sigma_rel * draw(Draw::Dsnu);
        const float chance = open_unit(draw_words(prepared.bench.seed, Draw::Hot, 0, index).x);
        const double hot = chance < camera.hot_share ? camera.hot_factor : 1.0;
        prepared.prnu.push_back(
            static_cast<float>(std::max(0.0, 1.0 + camera.prnu_sigma_rel * draw(Draw::Prnu))));
        prepared.dark_e_per_s.push_back(
            static_cast<float>(camera.dark_e_per_s * std::max(0.0, dark) * hot));
        prepared.offset_dn.push_back(
            static_cast<float>(camera.offset_sigma_dn * draw(Draw::Offset)));
    }
}

void prepare_photometer(const RayLamp& lamp, PreparedBench& prepared) {
    const Bench& bench = prepared.bench;
    const BenchPhotometer& photometer = bench.photometer;
    SeenColors color(1);
    for (int channel = 0; channel < 3; ++channel)
        color[0][channel] =
            photometer.channel_factor[channel] * kLuminanceRgb[static_cast<std::size_t>(channel)];
    const Rigid bench_from_emitter = prepared.places.bench_from_lamp * lamp.lamp_from_emitter;
    const double distance_m = apply(inverse(bench_from_emitter), photometer.position_m).z;
    prepared.photometer_lx.assign(static_cast<std::size_t>(position_count(bench)), 0.0);
    prepared.photometer_room_lx = bench.stray.veil_lx * channel_sum(color[0]);
    if (distance_m <= 0.0 || bench.setup == Setup::Direct)
        return;
    const LensLight light =
        make_lens_light(bench, prepared.places, lamp, distance_m, 0.5 * bench.accuracy.lens_step);
    const std::span<const glm::dvec3> place(&photometer.position_m, 1);
    const bool is_filter = bench.setup == Setup::Filter;
    const LineLight line =
        line_light(light, place, photometer.normal, color, is_filter ? position_count(bench) : 0);
    prepared.photometer_open_lx = line.open[0];
    StrayedLight strayed{std::vector<double>(prepared.photometer_lx.size(), 0.0), 0.0};
    if (bench.stray.blocked_share > 0.0)
        strayed = strayed_light(light, color);
    prepared.photometer_blocked_lx = strayed.blocked;
    for (std::size_t m = 0; m < prepared.photometer_lx.size(); ++m)
        prepared.photometer_lx[m] =
            strayed.positions[m] + (is_filter ? line.positions[m]
                                              : hole_light(light, place, photometer.normal, color,
                                                           prepared.places.position_m[m])[0]);
}

}  // namespace

SeenColors seen_colors(const Bench& bench, glm::dvec3 reflectance) {
    SeenColors colors;
    for (int p = 0; p < color_count(bench.camera); ++p) {
        const glm::dmat3& response = bench.camera.response_e_per_cd_m2_s;
        colors.push_back(glm::dvec3(response[0][p], response[1][p], response[2][p]) * reflectance);
    }
    return colors;
}

void prepare_direct(const RayLamp& lamp,
                    const std::function<void(double)>& progress,
                    PreparedBench& prepared) {
    const Bench& bench = prepared.bench;
    const SampleGrid samples = make_sample_grid(bench.camera, bench.accuracy.subsamples);
    const SampleRays rays = sample_rays(bench.camera, samples);
    const LensLight light = make_lens_light(bench, prepared.places, lamp, bench.delta_m, 1.0);
    const SeenColors colors = seen_colors(bench, glm::dvec3(1.0));
    const auto width = static_cast<std::size_t>(samples.count.x);
    for (const glm::dvec2& position_m : prepared.places.position_m) {
        const glm::dvec3 center_bench =
            apply(prepared.places.bench_from_filter, glm::dvec3(position_m, 0.0));
        const auto sample_row = [&](int row, std::span<float> values) {
            for (int column = 0; column < samples.count.x; ++column) {
                const glm::dvec3 towards_lamp_bench =
                    bench.camera.bench_from_camera.rotation * rays.ray(column, row);
                const std::vector<double> seen =
                    ray_light(light, center_bench, -towards_lamp_bench, colors);
                const double factor = rays.vignetting[rays.index(column, row)];
                for (std::size_t p = 0; p < colors.size(); ++p)
                    values[p * width + static_cast<std::size_t>(column)] =
                        static_cast<float>(factor * seen[p]);
            }
        };
        prepared.positions.push_back(form_picture(bench.camera, samples, sample_row, true));
        if (progress)
            progress(0.8 * static_cast<double>(prepared.positions.size()) / position_count(bench));
    }
}

Prepared prepare(const Bench& bench, const std::function<void(double fraction)>& progress) {
    check(bench, "bench");
    check_memory(bench);
    auto prepared = std::make_shared<PreparedBench>();
    prepared->bench = bench;
    prepared->places = make_places(bench);
    const RayLamp lamp = make_ray_lamp(bench.lamp);
    const Rigid bench_from_emitter = prepared->places.bench_from_lamp * lamp.lamp_from_emitter;
    if (bench_from_emitter.rotation[2].z <= 0.0 || bench_from_emitter.translation_m.z >= 0.0)
        throw Error("the lamp does not shine at S", "lamp.u_from_lamp",
                    "a lamp behind S whose light goes towards +z");
    if (bench.setup == Setup::Direct)
        prepare_direct(lamp, progress, *prepared);
    else
        prepare_screen(lamp, progress, *prepared);
    prepare_targets(*prepared);
    prepare_pattern(*prepared);
    prepare_photometer(lamp, *prepared);
    if (progress)
        progress(1.0);
    return prepared;
}

const Bench& bench_of(const PreparedBench& prepared) {
    return prepared.bench;
}

}  // namespace nearfield::sample_data
