// SPDX-License-Identifier: Apache-2.0
#include "tests/fit/straight_bench.h"

#include "formats/model/profile.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace nearfield::fit {
namespace {

constexpr glm::ivec2 kGrid{5, 4};
constexpr glm::dvec2 kPitch_m{0.02, 0.024};
constexpr double kDelta_m = 0.2, kCamera_m = 0.5;
constexpr double kDnPerLuxSecond = 100, kBlack_dn = 100, kPeak = 0.5;
constexpr int kBits = 12;
constexpr double kStart_c = 20;

glm::dvec2 center_m(glm::ivec2 position) {
    return (glm::dvec2(position) - 0.5 * glm::dvec2(kGrid - 1)) * kPitch_m;
}

// The lamp's only lit functions: four in the middle of the grid.
double coefficient(glm::ivec2 at) {
    const bool is_middle = (at.x == 2 || at.x == 3) && (at.y == 1 || at.y == 2);
    return is_middle ? 4e5 : 0;  // lm m^-4
}

double slope(double x_m) {
    return 1 + x_m;
}

// Integral of a B-spline times another of peak 1, in pitches, by midpoints: independent of the
// fit's own integrals.
double overlap(double shift) {
    const Profile profile = model::make_profile("bspline");
    constexpr int kSteps = 3000;
    double sum = 0;
    for (int k = 0; k < kSteps; ++k) {
        const double x = -1.5 + 3.0 * (k + 0.5) / kSteps;
        sum += model::eval(profile, x) * model::eval(profile, x - shift) * 3.0 / kSteps;
    }
    return sum / 0.75;
}

// Illuminance behind the filter at a position, where the lamp's slope is 1; lux.
double through_lx(glm::ivec2 position) {
    double sum = 0;
    for (int row = 0; row < kGrid.y; ++row)
        for (int column = 0; column < kGrid.x; ++column)
            sum += coefficient({column, row}) * overlap(column - position.x) *
                   overlap(row - position.y) * kPitch_m.x * kPitch_m.y;
    return kPeak * sum;
}

// All of the lamp on S, where its slope is 1.
double open_lx() {
    double sum = 0;
    for (int row = 0; row < kGrid.y; ++row)
        for (int column = 0; column < kGrid.x; ++column)
            sum += coefficient({column, row}) * kPitch_m.x * kPitch_m.y;
    return sum;
}

capture::Plan plan_of(const StraightBench& bench) {
    capture::Plan plan;
    plan.grid = kGrid;
    plan.pitch_m = kPitch_m;
    plan.basis = "bspline";
    plan.bracket.exposures_us = bench.exposures_us;
    plan.darks = 0;
    plan.blocked = bench.has_blocked_frames ? 1 : 0;
    plan.drift_every = bench.drift_every;
    return plan;
}

// What a shot shows where the lamp's slope is 1, and what is even over S.
struct Seen {
    double lamp_lx = 0, even_lx = 0;
};

Seen seen_of(const StraightBench& bench, const capture::Shot& shot) {
    if (shot.kind == capture::ShotKind::Blocked)
        return {0, bench.beside_lx};
    const double lamp_lx = through_lx(shot.position);
    return {lamp_lx, bench.beside_lx * (1 - lamp_lx / open_lx())};
}

// Of a shot so far into the capture.
double sensor_c(const StraightBench& bench, double part) {
    return kStart_c + bench.sensor_rise_c * part;
}

double dark_dn_per_s(const StraightBench& bench, double part) {
    return bench.room_dn_per_s +
           bench.current_dn_per_s * std::pow(2.0, (sensor_c(bench, part) - kStart_c) / 7.0);
}

capture::Frame frame_of(const StraightBench& bench, const capture::Shot& shot, double part) {
    const double factor = 1 + bench.lamp_rise_rel * part;
    const Seen seen = seen_of(bench, shot);
    capture::Frame frame;
    frame.size_px = bench.size_px;
    frame.bits = kBits;
    for (int y = 0; y < bench.size_px.y; ++y)
        for (int x = 0; x < bench.size_px.x; ++x) {
            const double x_m = (x + 0.5 - 0.5 * bench.size_px.x) * bench.pixel_m;
            const double lux =
                bench.brightness * factor * (slope(x_m) * seen.lamp_lx + seen.even_lx);
            const double dn = kBlack_dn + (kDnPerLuxSecond * lux + dark_dn_per_s(bench, part)) *
                                              shot.exposure_us * 1e-6;
            frame.values.push_back(
                static_cast<std::uint16_t>(std::clamp(std::lround(dn), 0L, (1L << kBits) - 1L)));
        }
    return frame;
}

}  // namespace

rig::Rig straight_rig(const StraightBench& bench) {
    rig::Rig rig;
    rig::Lens lens;
    lens.size_px = bench.size_px;
    lens.fx_px = lens.fy_px = kCamera_m / bench.pixel_m;
    lens.cx_px = 0.5 * bench.size_px.x;
    lens.cy_px = 0.5 * bench.size_px.y;
    lens.distortion.assign(5, 0.0);
    rig.lens = lens;
    rig::Planes planes;
    // The camera looks back at the lamp: half a turn about x. Its picture's x is the slab's.
    planes.camera_from_slab.rotation = glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
    planes.camera_from_slab.translation_m = {0, 0, kCamera_m};
    planes.delta_m = kDelta_m;
    planes.grid = kGrid;
    planes.pitch_m = kPitch_m;
    for (int row = 0; row < kGrid.y; ++row)
        for (int column = 0; column < kGrid.x; ++column)
            planes.position_m.emplace_back(center_m({column, row}), -kDelta_m);
    rig.planes = planes;
    rig::Radiometry radiometry;
    radiometry.bits = kBits;
    radiometry.saturation_dn = 4000;
    radiometry.gain_e_per_dn = 1e4;
    radiometry.read_noise_dn = 0.3;  // rounding
    radiometry.scale_lx_s_per_dn = 1 / kDnPerLuxSecond;
    radiometry.is_absolute = true;
    radiometry.dark_temperature_c = kStart_c;
    radiometry.filter_profile = model::make_profile("bspline");
    for (std::array<double, 3>& cell : radiometry.filter_profile.cells)
        for (double& number : cell)
            number /= 0.75;
    radiometry.filter_pitch_m = kPitch_m;
    radiometry.filter_peak = glm::dvec3(kPeak);
    rig.radiometry = radiometry;
    return rig;
}

rig::Maps straight_maps(const StraightBench& bench) {
    const auto count =
        static_cast<std::size_t>(bench.size_px.x) * static_cast<std::size_t>(bench.size_px.y);
    rig::Maps maps;
    maps.size_px = bench.size_px;
    maps.black_dn.assign(count, static_cast<float>(kBlack_dn));
    maps.dark_dn_per_s.assign(count, static_cast<float>(dark_dn_per_s(bench, 0.0)));
    maps.room_dn_per_s.assign(count, static_cast<float>(bench.room_dn_per_s));
    maps.response.assign(count, 1.0F);
    maps.response_sigma_rel.assign(count, 0.0F);
    maps.is_bad.assign(count, 0.0F);
    return maps;
}

LightField straight_lamp(const StraightBench& bench) {
    Slab slab;
    slab.delta_m = kDelta_m;
    slab.grid = kGrid;
    slab.pitch_m = kPitch_m;
    slab.texels = bench.size_px;
    slab.s_max_m = 0.5 * bench.pixel_m * glm::dvec2(bench.size_px);
    slab.s_min_m = -slab.s_max_m;
    slab.profile = model::make_profile("bspline");
    for (int row = 0; row < kGrid.y; ++row)
        for (int column = 0; column < kGrid.x; ++column)
            for (int j = 0; j < slab.texels.y; ++j)
                for (int i = 0; i < slab.texels.x; ++i)
                    slab.coeffs.push_back(
                        static_cast<float>(bench.brightness * coefficient({column, row}) *
                                           slope((i + 0.5) * bench.pixel_m + slab.s_min_m.x)));
    LightField lamp;
    lamp.slabs = {slab};
    return lamp;
}

capture::Capture take_capture(const StraightBench& bench, const std::string& folder) {
    std::filesystem::remove_all(folder);
    capture::CaptureHeader header;
    header.plan = plan_of(bench);
    {
        capture::CaptureWriter writer = capture::CaptureWriter::create(folder, header);
        writer.add(capture::SessionRecord{});
        const std::vector<capture::Shot> shots = capture::shots_of(*header.plan);
        for (const capture::Shot& shot : shots) {
            if (shot.kind == capture::ShotKind::Light &&
                std::find(bench.left_out.begin(), bench.left_out.end(), shot.position) !=
                    bench.left_out.end())
                continue;
            const double part = shot.number / static_cast<double>(shots.size());
            capture::FrameRecord record;
            record.shot = shot;
            record.pixel_format = "Mono12";
            record.exposure_us = shot.exposure_us;
            record.time_us = 1000000LL * shot.number;
            record.temperature_c = sensor_c(bench, part);
            writer.add(frame_of(bench, shot, part), record);
        }
    }
    return capture::read_capture(folder);
}

}  // namespace nearfield::fit
