// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "sample_data/bench/bench_random.h"
#include "sample_data/bench/filter_view.h"
#include "sample_data/bench/prepared.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>

namespace nearfield::sample_data {
namespace {

constexpr double kSecondsPerMicrosecond = 1e-6;

// Pictures whose sum, each with a factor, is a shot's expected signal.
struct Signal {
    std::span<const float> lamp;  // what drifts with the lamp; empty: none
    std::span<const float> rest;
    std::vector<float> made;  // holds a picture that is not kept
};

void require(bool is_right,
             const char* where,
             const std::string& expected,
             const std::string& got) {
    if (!is_right)
        throw Error("cannot expose", where, expected, got);
}

std::size_t position_index(const Bench& bench, glm::ivec2 position) {
    const glm::ivec2 grid = bench.filter.grid;
    require(position.x >= 0 && position.y >= 0 && position.x < grid.x && position.y < grid.y,
            "shot.position", fmt::format("0 0 ... {} {}", grid.x - 1, grid.y - 1),
            fmt::format("{} {}", position.x, position.y));
    return static_cast<std::size_t>(position.y * grid.x + position.x);
}

Signal signal_of(const PreparedBench& prepared, const Shot& shot) {
    Signal signal;
    switch (shot.subject) {
        case Subject::Position:
            signal.lamp = prepared.positions[position_index(prepared.bench, shot.position)];
            signal.rest = prepared.room;
            break;
        case Subject::Open:
            require(!prepared.open.empty(), "shot.subject", "a subject of this setup", "open");
            signal.lamp = prepared.open;
            signal.rest = prepared.room;
            break;
        case Subject::Blocked:
            require(!prepared.blocked.empty(), "shot.subject", "a subject of this setup",
                    "blocked");
            signal.lamp = prepared.blocked;
            signal.rest = prepared.room;
            break;
        case Subject::Flat:
            signal.rest = prepared.flat;
            break;
        case Subject::Target:
            require(shot.target_view >= 0 &&
                        static_cast<std::size_t>(shot.target_view) < prepared.targets.size(),
                    "shot.target_view", fmt::format("0 ... {}", int(prepared.targets.size()) - 1),
                    std::to_string(shot.target_view));
            signal.rest = prepared.targets[static_cast<std::size_t>(shot.target_view)];
            break;
        case Subject::Filter:
            require(prepared.bench.setup != Setup::Direct, "shot.subject",
                    "a subject of this setup", "filter");
            signal.made = filter_picture(prepared.bench, prepared.places,
                                         position_index(prepared.bench, shot.position));
            signal.rest = signal.made;
            break;
        case Subject::Cap:
            break;
    }
    if (!shot.lamp_on)
        signal.lamp = {};
    return signal;
}

// All that a pixel's number depends on besides its place.
struct Readout {
    const float* lamp = nullptr;
    const float* rest = nullptr;
    const float* prnu = nullptr;
    const float* dark = nullptr;
    const float* offset = nullptr;
    float lamp_s = 0, rest_s = 0,
          dark_s = 0;  // exposure times the lamp's, 1, dark current's factor
    float full_well_e = 0, read_noise_e = 0, dn_per_e = 0, black_dn = 0, most_dn = 0;
    glm::uvec4 key{0};
};

// One pixel: shot noise, saturation, read noise, gain, rounding.
std::uint16_t pixel_dn(const Readout& readout, std::size_t k) {
    float photo_e = 0.0F;
    if (readout.lamp != nullptr)
        photo_e += readout.lamp_s * readout.lamp[k];
    if (readout.rest != nullptr)
        photo_e += readout.rest_s * readout.rest[k];
    const float mean_e =
        std::max(photo_e, 0.0F) * readout.prnu[k] + readout.dark_s * readout.dark[k];
    const glm::uvec4 words = draw_words(readout.key, static_cast<std::uint32_t>(k));
    const glm::vec2 z = normal_pair(words.x, words.y);
    const float electrons =
        mean_e < kPoissonExactBelow ? poisson_exact(mean_e, words.z) : poisson_normal(mean_e, z.x);
    const float read_e = std::min(electrons, readout.full_well_e) + readout.read_noise_e * z.y;
    const float dn = readout.black_dn + readout.offset[k] + readout.dn_per_e * read_e;
    return static_cast<std::uint16_t>(std::clamp(dn + 0.5F, 0.0F, readout.most_dn));
}

Readout make_readout(const PreparedBench& prepared, const Shot& shot, const Signal& signal) {
    const BenchCamera& camera = prepared.bench.camera;
    const double exposure_s = shot.exposure_us * kSecondsPerMicrosecond;
    const double dark_factor = std::exp2(
        (sensor_c(prepared.bench, shot.time_s) - camera.dark_reference_c) / camera.dark_doubling_c);
    Readout readout;
    readout.lamp = signal.lamp.empty() ? nullptr : signal.lamp.data();
    readout.rest = signal.rest.empty() ? nullptr : signal.rest.data();
    readout.prnu = prepared.prnu.data();
    readout.dark = prepared.dark_e_per_s.data();
    readout.offset = prepared.offset_dn.data();
    readout.lamp_s = static_cast<float>(exposure_s * lamp_factor(prepared.bench, shot.time_s));
    readout.rest_s = static_cast<float>(exposure_s);
    readout.dark_s = static_cast<float>(exposure_s * dark_factor);
    readout.full_well_e = static_cast<float>(camera.full_well_e);
    readout.read_noise_e = static_cast<float>(camera.read_noise_e);
    readout.dn_per_e =
        static_cast<float>(std::pow(10.0, shot.gain_db / 20.0) / camera.gain_e_per_dn);
    readout.black_dn = static_cast<float>(camera.black_level_dn);
    readout.most_dn = static_cast<float>((1 << camera.bits) - 1);
    readout.key = draw_key(prepared.bench.seed, Draw::Noise, shot.frame_number);
    return readout;
}

}  // namespace

double lamp_factor(const Bench& bench, double time_s) {
    const BenchLamp& lamp = bench.lamp;
    // A stationary walk with knots every walk_s: neighboring knots' normal numbers, mixed so that
    // its sigma is the same between them.
    const double at = std::max(0.0, time_s) / lamp.walk_s;
    const double knot = std::floor(at);
    const auto number = [&](double index) {
        return normal_pair(bench.seed, Draw::Walk, static_cast<std::uint64_t>(index), 0).x;
    };
    const double part = at - knot;
    const double smooth = part * part * (3.0 - 2.0 * part);
    const double walk = ((1.0 - smooth) * number(knot) + smooth * number(knot + 1.0)) /
                        std::hypot(1.0 - smooth, smooth);
    return (1.0 + lamp.warm_up_rel * std::exp(-std::max(0.0, time_s) / lamp.warm_up_s)) *
           std::max(0.0, 1.0 + lamp.walk_sigma_rel * walk);
}

double sensor_c(const Bench& bench, double time_s) {
    const BenchCamera& camera = bench.camera;
    return camera.sensor_start_c -
           camera.sensor_rise_c * std::expm1(-std::max(0.0, time_s) / camera.sensor_rise_s);
}

std::vector<std::uint16_t> expose(const PreparedBench& prepared, const Shot& shot) {
    require(std::isfinite(shot.exposure_us) && shot.exposure_us >= 0.0, "shot.exposure_us",
            "0 or more", fmt::format("{}", shot.exposure_us));
    require(std::isfinite(shot.gain_db) && shot.gain_db >= 0.0, "shot.gain_db", "0 or more",
            fmt::format("{}", shot.gain_db));
    require(std::isfinite(shot.time_s), "shot.time_s", "a finite time",
            fmt::format("{}", shot.time_s));
    const Signal signal = signal_of(prepared, shot);
    const Readout readout = make_readout(prepared, shot, signal);
    std::vector<std::uint16_t> raw(prepared.prnu.size());
    constexpr std::size_t kPixelsPerTask = 16384;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, raw.size(), kPixelsPerTask),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t k = range.begin(); k < range.end(); ++k)
                              raw[k] = pixel_dn(readout, k);
                      });
    return raw;
}

std::vector<float> signal_e_per_s(const PreparedBench& prepared, const Shot& shot) {
    const Signal signal = signal_of(prepared, shot);
    std::vector<float> sum(prepared.prnu.size(), 0.0F);
    for (const std::span<const float> picture : {signal.lamp, signal.rest})
        std::transform(picture.begin(), picture.end(), sum.begin(), sum.begin(), std::plus<>());
    return sum;
}

double photometer_lx(const PreparedBench& prepared, const Shot& shot) {
    const Bench& bench = prepared.bench;
    double lamp_lx = 0.0;
    if (shot.lamp_on && shot.subject == Subject::Position)
        lamp_lx = prepared.photometer_lx[position_index(bench, shot.position)];
    if (shot.lamp_on && shot.subject == Subject::Open)
        lamp_lx = prepared.photometer_open_lx;
    if (shot.lamp_on && shot.subject == Subject::Blocked)
        lamp_lx = prepared.photometer_blocked_lx;
    const double true_lx = lamp_lx * lamp_factor(bench, shot.time_s) + prepared.photometer_room_lx;
    const glm::dvec2 z = normal_pair(bench.seed, Draw::Photometer, shot.frame_number, 0);
    return true_lx * (1.0 + bench.photometer.sigma_rel * z.x) + bench.photometer.sigma_lx * z.y;
}

}  // namespace nearfield::sample_data
