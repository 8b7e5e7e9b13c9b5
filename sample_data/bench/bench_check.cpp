// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "sample_data/bench/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace nearfield::sample_data {
namespace {

// Values of one bench, checked one by one.
class Checker {
  public:
    explicit Checker(const std::string& where) : where_(where) {}

    void in(const char* key, double value, double least, double most) const {
        if (!(value >= least && value <= most))
            throw Error("bad bench", where_ + "." + key, fmt::format("{} ... {}", least, most),
                        fmt::format("{}", value));
    }
    template <typename Vector>
    void all_in(const char* key, Vector vector, double least, double most) const {
        for (int k = 0; k < Vector::length(); ++k)
            in(key, static_cast<double>(vector[k]), least, most);
    }
    void rigid(const char* key, const Rigid& pose) const {
        // As tight as a rotation written with a few digits less than double's.
        constexpr double kTolerance = 1e-9;
        const glm::dmat3 left = glm::transpose(pose.rotation) * pose.rotation - glm::dmat3(1.0);
        double worst = std::abs(glm::determinant(pose.rotation) - 1.0);
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row)
                worst = std::max(worst, std::abs(left[column][row]));
        }
        if (!(worst <= kTolerance))
            throw Error("bad bench", where_ + "." + key + ".rotation",
                        "a proper rotation (orthonormal, determinant 1)",
                        fmt::format("one that is off by {:.3g}", worst));
        all_in(key, pose.translation_m, -kFar_m, kFar_m);
    }

    static constexpr double kFar_m = 1e3;

  private:
    const std::string& where_;
};

void check_filter(const Checker& is, const BenchFilter& filter, Setup setup) {
    is.all_in("filter.grid", filter.grid, 1, 512);
    is.all_in("filter.pitch_m", filter.pitch_m, 1e-6, 10);
    is.all_in("filter.center_m", filter.center_m, -10, 10);
    is.all_in("filter.transmission", filter.transmission, 0, 1);
    is.in("filter.hole_radius_m", filter.hole_radius_m, 1e-7, 0.1);
    is.all_in("filter.tilt_deg", filter.tilt_deg, -20, 20);
    is.all_in("filter.stage_scale", filter.stage_scale, 0.5, 2);
    is.in("filter.stage_skew_deg", filter.stage_skew_deg, -20, 20);
    is.in("filter.step_sigma_m", filter.step_sigma_m, 0, 0.1);
    if (setup == Setup::Filter)
        is.in("filter.profile (cells)", static_cast<double>(filter.profile.cells.size()), 1, 64);
    for (const std::array<double, 3>& cell : filter.profile.cells) {
        for (const double value : cell)
            is.in("filter.profile", value, -1e6, 1e6);
    }
}

void check_screen(const Checker& is, const BenchScreen& screen) {
    is.all_in("screen.min_m", screen.min_m, -100, 100);
    is.all_in("screen.max_m - min_m", screen.max_m - screen.min_m, 1e-6, 200);
    is.all_in("screen.tilt_deg", screen.tilt_deg, -20, 20);
    is.all_in("screen.reflectance", screen.reflectance, 0, 1);
    is.in("screen.lobe_share", screen.lobe_share, 0, 1);
    is.in("screen.lobe_exponent", screen.lobe_exponent, 0, 100);
}

void check_optics(const Checker& is, const BenchCamera& camera) {
    is.all_in("camera.size_px", camera.size_px, 8, 16384);
    is.in("camera.fx_px", camera.fx_px, 1, 1e6);
    is.in("camera.fy_px", camera.fy_px, 1, 1e6);
    is.in("camera.cx_px", camera.cx_px, -1e6, 1e6);
    is.in("camera.cy_px", camera.cy_px, -1e6, 1e6);
    for (const double k : {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3})
        is.in("camera.k1 ... k3", k, -10, 10);
    is.rigid("camera.bench_from_camera", camera.bench_from_camera);
    is.in("camera.vignetting_cos4", camera.vignetting_cos4, 0, 2);
    is.all_in("camera.vignetting", camera.vignetting, -1, 1);
    is.in("camera.psf_sigma_px", camera.psf_sigma_px, 0, 20);
    is.in("camera.veil_share", camera.veil_share, 0, 0.5);
    is.in("camera.veil_sigma_px", camera.veil_sigma_px, 8, 4096);
    for (int column = 0; column < 3; ++column)
        is.all_in("camera.response_e_per_cd_m2_s", camera.response_e_per_cd_m2_s[column], 0, 1e12);
}

void check_sensor(const Checker& is, const BenchCamera& camera) {
    is.in("camera.bits", camera.bits, 8, 16);
    is.in("camera.gain_e_per_dn", camera.gain_e_per_dn, 1e-3, 1e4);
    is.in("camera.full_well_e", camera.full_well_e, 1, 1e7);
    is.in("camera.read_noise_e", camera.read_noise_e, 0, 1e4);
    is.in("camera.black_level_dn", camera.black_level_dn, 0, (1 << camera.bits) - 1);
    is.in("camera.dark_e_per_s", camera.dark_e_per_s, 0, 1e6);
    is.in("camera.dark_reference_c", camera.dark_reference_c, -273.15, 200);
    is.in("camera.dark_doubling_c", camera.dark_doubling_c, 0.1, 1000);
    is.in("camera.sensor_start_c", camera.sensor_start_c, -273.15, 200);
    is.in("camera.sensor_rise_c", camera.sensor_rise_c, 0, 200);
    is.in("camera.sensor_rise_s", camera.sensor_rise_s, 1e-3, 1e9);
    is.in("camera.prnu_sigma_rel", camera.prnu_sigma_rel, 0, 0.2);
    is.in("camera.dsnu_sigma_rel", camera.dsnu_sigma_rel, 0, 10);
    is.in("camera.offset_sigma_dn", camera.offset_sigma_dn, 0, 1000);
    is.in("camera.hot_share", camera.hot_share, 0, 1);
    is.in("camera.hot_factor", camera.hot_factor, 0, 1e6);
}

void check_targets(const Checker& is, const BenchTargets& targets) {
    const BenchBoard& board = targets.board;
    is.all_in("targets.board.squares", board.squares, 2, 32);
    // Half of the squares hold a marker of a dictionary of 50.
    is.in("targets.board.squares (product)", board.squares.x * board.squares.y, 4, 100);
    is.in("targets.board.square_m", board.square_m, 1e-4, 10);
    is.in("targets.board.marker_m", board.marker_m, 1e-5, board.square_m);
    is.in("targets.board.margin_m", board.margin_m, 0, 10);
    is.in("targets.board.black", board.black, 0, 1);
    is.in("targets.board.white", board.white, 0, 1);
    is.in("targets.hand_sigma_deg", targets.hand_sigma_deg, 0, 30);
    is.in("targets.hand_sigma_m", targets.hand_sigma_m, 0, 1);
    is.in("targets.room_lx", targets.room_lx, 0, 1e6);
    for (const TargetView& view : targets.views)
        is.rigid("targets.views.plane_from_board", view.plane_from_board);
}

}  // namespace

void check(const Bench& bench, const std::string& where) {
    const Checker is(where);
    is.in("delta_m", bench.delta_m, 1e-4, 100);
    is.rigid("lamp.u_from_lamp", bench.lamp.u_from_lamp);
    is.in("lamp.warm_up_rel", bench.lamp.warm_up_rel, -1, 10);
    is.in("lamp.warm_up_s", bench.lamp.warm_up_s, 1e-3, 1e9);
    is.in("lamp.walk_sigma_rel", bench.lamp.walk_sigma_rel, 0, 0.2);
    is.in("lamp.walk_s", bench.lamp.walk_s, 1e-3, 1e9);
    check_filter(is, bench.filter, bench.setup);
    check_screen(is, bench.screen);
    check_optics(is, bench.camera);
    check_sensor(is, bench.camera);
    is.in("stray.veil_lx", bench.stray.veil_lx, 0, 1e6);
    is.in("stray.blocked_share", bench.stray.blocked_share, 0, 1);
    is.all_in("photometer.position_m", bench.photometer.position_m, -Checker::kFar_m,
              Checker::kFar_m);
    is.in("photometer.normal (length)", glm::length(bench.photometer.normal), 1 - 1e-6, 1 + 1e-6);
    is.all_in("photometer.channel_factor", bench.photometer.channel_factor, 0, 10);
    is.in("photometer.sigma_rel", bench.photometer.sigma_rel, 0, 1);
    is.in("photometer.sigma_lx", bench.photometer.sigma_lx, 0, 1e6);
    check_targets(is, bench.targets);
    is.in("flat_cd_m2", bench.flat_cd_m2, 0, 1e9);
    is.in("accuracy.lens_step", bench.accuracy.lens_step, 0.05, 20);
    is.in("accuracy.screen_step_px", bench.accuracy.screen_step_px, 0.25, 16);
    is.in("accuracy.subsamples", bench.accuracy.subsamples, 1, 8);
}

}  // namespace nearfield::sample_data
