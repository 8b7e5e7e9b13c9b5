// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/lens_light.h"
#include "sample_data/bench/optics.h"
#include "sample_data/bench/prepare_parts.h"

#include <glm/gtc/constants.hpp>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

namespace nearfield::sample_data {
namespace {

// Share of prepare()'s time that the light on the screen takes, about.
constexpr double kScreenShare = 0.8;

// Irradiance on the screen as the pixels' colors weigh it: [color][row][column] each.
struct ScreenLight {
    std::vector<std::vector<float>> positions;
    std::vector<float> open;
};

glm::dvec3 screen_point(const Places& places, glm::dvec2 at_m) {
    return apply(places.bench_from_screen, glm::dvec3(at_m, 0.0));
}

LineLight light_on_line(const LensLight& light,
                        std::span<const glm::dvec3> points_bench,
                        const SeenColors& colors) {
    const Bench& bench = *light.bench;
    const glm::dvec3 normal_bench = -light.places->bench_from_screen.rotation[2];
    const bool is_filter = bench.setup == Setup::Filter;
    LineLight line = line_light(light, points_bench, normal_bench, colors,
                                is_filter ? position_count(bench) : 0);
    if (bench.setup == Setup::Pinhole) {
        for (const glm::dvec2& hole : light.places->position_m) {
            const std::vector<double> seen =
                hole_light(light, points_bench, normal_bench, colors, hole);
            line.positions.insert(line.positions.end(), seen.begin(), seen.end());
        }
    }
    return line;
}

ScreenLight screen_light(const LensLight& light,
                         const ScreenGrid& grid,
                         const SeenColors& colors,
                         const std::function<void(double)>& progress) {
    ScreenLight result;
    std::mutex mutex;
    int done = 0;
    const std::size_t positions = static_cast<std::size_t>(position_count(*light.bench));
    const std::size_t size = colors.size() * grid.size();
    result.positions.assign(positions, std::vector<float>(size));
    result.open.resize(size);
    const auto width = static_cast<std::size_t>(grid.count.x);
    tbb::parallel_for(0, grid.count.y, [&](int row) {
        std::vector<glm::dvec3> points;
        points.reserve(width);
        for (int column = 0; column < grid.count.x; ++column)
            points.push_back(
                screen_point(*light.places, grid.min_m + glm::dvec2(column, row) * grid.step_m));
        const LineLight line = light_on_line(light, points, colors);
        for (std::size_t p = 0; p < colors.size(); ++p) {
            const std::size_t to = p * grid.size() + static_cast<std::size_t>(row) * width;
            for (std::size_t i = 0; i < width; ++i) {
                result.open[to + i] = static_cast<float>(line.open[p * width + i]);
                for (std::size_t m = 0; m < positions; ++m)
                    result.positions[m][to + i] =
                        static_cast<float>(line.positions[(m * colors.size() + p) * width + i]);
            }
        }
        const std::lock_guard lock(mutex);
        ++done;
        if (progress)
            progress(kScreenShare * done / grid.count.y);
    });
    return result;
}

std::vector<float> screen_picture(const Bench& bench,
                                  const SampleGrid& samples,
                                  const std::vector<ScreenSample>& places,
                                  const ScreenGrid& grid,
                                  std::span<const float> light) {
    const auto width = static_cast<std::size_t>(samples.count.x);
    const int colors = color_count(bench.camera);
    const auto sample_row = [&](int row, std::span<float> values) {
        const ScreenSample* const line = &places[static_cast<std::size_t>(row) * width];
        for (std::size_t p = 0; p < static_cast<std::size_t>(colors); ++p) {
            const std::span<const float> plane = light.subspan(p * grid.size(), grid.size());
            for (std::size_t i = 0; i < width; ++i)
                values[p * width + i] =
                    line[i].factor > 0.0F
                        ? line[i].factor * interpolated(plane, grid.count, line[i].x, line[i].y)
                        : 0.0F;
        }
    };
    return form_picture(bench.camera, samples, sample_row, false);
}

// The screen under even light of 1 (as each color sees it).
std::vector<float> even_picture(const Bench& bench,
                                const SampleGrid& samples,
                                const std::vector<ScreenSample>& places) {
    const auto width = static_cast<std::size_t>(samples.count.x);
    const auto sample_row = [&](int row, std::span<float> values) {
        for (std::size_t k = 0; k < values.size(); ++k)
            values[k] = places[static_cast<std::size_t>(row) * width + k % width].factor;
    };
    return form_picture(bench.camera, samples, sample_row, true);
}

// Adds light that is even on the screen: value[color].
void add_even(const Bench& bench,
              const std::vector<float>& even,
              const std::vector<double>& value,
              std::vector<float>& picture) {
    const glm::ivec2 size = bench.camera.size_px;
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            const auto k = static_cast<std::size_t>(y * size.x + x);
            const auto p = static_cast<std::size_t>(pixel_color(bench.camera, x, y));
            picture[k] += even[k] * static_cast<float>(value[p]);
        }
    }
}

// Mean over the seen part of the screen of what the filter holds back, by color, times the share
// that strays.
std::vector<double> strayed(const Bench& bench,
                            const ScreenGrid& grid,
                            const std::vector<float>& open,
                            const std::vector<float>& position) {
    std::vector<double> value;
    for (std::size_t first = 0; first < open.size(); first += grid.size()) {
        double sum = 0.0;
        for (std::size_t k = first; k < first + grid.size(); ++k)
            sum += open[k] - position[k];
        value.push_back(bench.stray.blocked_share * sum / static_cast<double>(grid.size()));
    }
    return value;
}

// Compares the interpolated irradiance with a finer quadrature at points that pixels look at.
OpticsError estimate_error(const LensLight& light,
                           const LensLight& fine,
                           const std::vector<ScreenSample>& samples,
                           const ScreenGrid& grid,
                           const ScreenLight& seen,
                           const SeenColors& colors) {
    constexpr std::size_t kProbes = 32;
    constexpr std::size_t kTries = 4096;
    std::vector<ScreenSample> probes;
    for (std::size_t k = 0; k < kTries && probes.size() < kProbes; ++k) {
        // A golden-section lattice through all samples.
        const auto index = static_cast<std::size_t>(static_cast<double>(samples.size()) *
                                                    glm::fract(double(k) * 0.6180339887498949));
        const ScreenSample& sample = samples[index];
        if (sample.factor > 0.0F && interpolated(std::span(seen.open).first(grid.size()),
                                                 grid.count, sample.x, sample.y) > 0.0F)
            probes.push_back(sample);
    }
    std::vector<glm::dvec3> sums(probes.size(), glm::dvec3(0.0));
    tbb::parallel_for(std::size_t{0}, probes.size(), [&](std::size_t k) {
        const ScreenSample& probe = probes[k];
        const glm::dvec3 point =
            screen_point(*light.places, grid.min_m + glm::dvec2(probe.x, probe.y) * grid.step_m);
        const LineLight coarse_line = light_on_line(light, {&point, 1}, colors);
        const LineLight fine_line = light_on_line(fine, {&point, 1}, colors);
        for (std::size_t m = 0; m < seen.positions.size(); ++m) {
            const double truth = fine_line.positions[m * colors.size()];
            const double coarse = coarse_line.positions[m * colors.size()];
            const double used = interpolated(std::span(seen.positions[m]).first(grid.size()),
                                             grid.count, probe.x, probe.y);
            sums[k] += glm::dvec3(truth * truth, (coarse - truth) * (coarse - truth),
                                  (used - truth) * (used - truth));
        }
    });
    const glm::dvec3 sum = std::accumulate(sums.begin(), sums.end(), glm::dvec3(0.0));
    if (sum.x <= 0.0)
        return {};
    return {std::sqrt(sum.y / sum.x), std::sqrt(sum.z / sum.x)};
}

}  // namespace

StrayedLight strayed_light(const LensLight& light, const SeenColors& color) {
    const Bench& bench = *light.bench;
    const ScreenGrid seen =
        make_screen_grid(bench, *light.places, make_sample_grid(bench.camera, 1));
    // Midpoints of a few hundred parts of the area that the grid's own points stand for.
    constexpr glm::ivec2 kParts{32, 24};
    const glm::dvec2 step_m = seen.step_m * glm::dvec2(seen.count) / glm::dvec2(kParts);
    const glm::dvec2 min_m = seen.min_m - 0.5 * seen.step_m;
    const auto positions = static_cast<std::size_t>(position_count(bench));
    StrayedLight strayed;
    strayed.positions.assign(positions, 0.0);
    for (int row = 0; row < kParts.y; ++row) {
        std::vector<glm::dvec3> points;
        points.reserve(static_cast<std::size_t>(kParts.x));
        for (int column = 0; column < kParts.x; ++column)
            points.push_back(
                screen_point(*light.places, min_m + (glm::dvec2(column, row) + 0.5) * step_m));
        const LineLight line = light_on_line(light, points, color);
        for (std::size_t i = 0; i < points.size(); ++i) {
            strayed.blocked += line.open[i];
            for (std::size_t m = 0; m < positions; ++m)
                strayed.positions[m] += line.open[i] - line.positions[m * points.size() + i];
        }
    }
    const double share = bench.stray.blocked_share / (kParts.x * kParts.y);
    strayed.blocked *= share;
    for (double& value : strayed.positions)
        value *= share;
    return strayed;
}

void prepare_screen(const RayLamp& lamp,
                    const std::function<void(double)>& progress,
                    PreparedBench& prepared) {
    const Bench& bench = prepared.bench;
    const Places& places = prepared.places;
    const SampleGrid samples = make_sample_grid(bench.camera, bench.accuracy.subsamples);
    const ScreenGrid grid = make_screen_grid(bench, places, samples);
    const std::vector<ScreenSample> at_samples =
        screen_samples(bench, places, samples, sample_rays(bench.camera, samples), grid);
    // Lens to screen: sets how fine the lens is sampled.
    const double distance_m = -(places.bench_from_lamp * lamp.lamp_from_emitter).translation_m.z;
    const double step = bench.accuracy.lens_step;
    const LensLight light = make_lens_light(bench, places, lamp, distance_m, step);
    const SeenColors colors = seen_colors(bench, bench.screen.reflectance);
    const ScreenLight seen = screen_light(light, grid, colors, progress);
    const LensLight fine = make_lens_light(bench, places, lamp, distance_m, 0.5 * step);
    prepared.error = estimate_error(light, fine, at_samples, grid, seen, colors);

    const std::vector<float> even = even_picture(bench, samples, at_samples);
    prepared.positions.resize(seen.positions.size());
    tbb::parallel_for(std::size_t{0}, seen.positions.size(), [&](std::size_t m) {
        prepared.positions[m] = screen_picture(bench, samples, at_samples, grid, seen.positions[m]);
        add_even(bench, even, strayed(bench, grid, seen.open, seen.positions[m]),
                 prepared.positions[m]);
    });
    prepared.open = screen_picture(bench, samples, at_samples, grid, seen.open);
    prepared.blocked.assign(prepared.open.size(), 0.0F);
    const std::vector<float> nothing(seen.open.size(), 0.0F);
    add_even(bench, even, strayed(bench, grid, seen.open, nothing), prepared.blocked);
    prepared.room.assign(prepared.open.size(), 0.0F);
    std::vector<double> room;
    for (const glm::dvec3& color : colors)
        room.push_back(bench.stray.veil_lx * channel_sum(color));
    add_even(bench, even, room, prepared.room);
}

}  // namespace nearfield::sample_data
