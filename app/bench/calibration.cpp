// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace nearfield::bench {
namespace {

using rig::LensModel;

constexpr double kRadOfDegree = 3.14159265358979324 / 180.0;

CalibrationSetting usual_setting(const std::string& sweep, const std::string& series) {
    CalibrationSetting setting;
    setting.sweep = sweep;
    setting.series = series;
    setting.options.with_validation = false;
    return setting;
}

using Settings = std::vector<CalibrationSetting>;

void add_noise(bool quick, Settings& settings) {
    const std::vector<double> all =
        quick ? std::vector<double>{0.02, 0.2} : std::vector<double>{0.02, 0.05, 0.1, 0.2, 0.5};
    for (const double sigma_px : all) {
        CalibrationSetting setting = usual_setting("noise", "12 free boards");
        setting.setting = fmt::format("{} px", sigma_px);
        setting.value = setting.corner_sigma_px = sigma_px;
        settings.push_back(std::move(setting));
    }
}

void add_boards(bool quick, Settings& settings) {
    const std::vector<int> all =
        quick ? std::vector<int>{4, 20} : std::vector<int>{4, 6, 8, 12, 20, 30};
    for (const int boards : all) {
        CalibrationSetting setting = usual_setting("boards", "corner noise 0.05 px");
        setting.setting = fmt::format("{}", boards);
        setting.value = setting.truth.free_views = boards;
        settings.push_back(std::move(setting));
    }
}

void add_bend(bool quick, Settings& settings) {
    const std::vector<double> all_mm =
        quick ? std::vector<double>{0.0, 1.0} : std::vector<double>{0.0, 0.25, 0.5, 1.0, 2.0};
    for (const bool is_ignored : {true, false})
        for (const double bend_mm : all_mm) {
            CalibrationSetting setting =
                usual_setting("bend", is_ignored ? "bend ignored" : "bend estimated");
            setting.setting = fmt::format("{} mm", bend_mm);
            setting.value = setting.truth.bend_m = 1e-3 * bend_mm;
            setting.options.is_board_flat = is_ignored;
            setting.with_checks = is_ignored;
            settings.push_back(std::move(setting));
        }
}

void add_tilt(bool quick, Settings& settings) {
    const std::vector<double> all_deg =
        quick ? std::vector<double>{0.0, 1.0} : std::vector<double>{0.0, 0.25, 0.5, 1.0, 2.0};
    for (const double tilt_deg : all_deg) {
        CalibrationSetting setting = usual_setting("tilt", "");
        setting.setting = fmt::format("{} degree{}", tilt_deg, tilt_deg == 1.0 ? "" : "s");
        setting.value = setting.truth.u_tilt_rad = tilt_deg * kRadOfDegree;
        settings.push_back(std::move(setting));
    }
}

void add_lenses(bool quick, Settings& settings) {
    constexpr std::array<std::pair<const char*, LensModel>, 3> kModels = {
        {{"Brown5", LensModel::Brown5},
         {"Brown8", LensModel::Brown8},
         {"fisheye", LensModel::Fisheye}}};
    for (const auto& [true_name, true_model] : kModels)
        for (const auto& [name, model] : kModels) {
            if (quick && true_model != LensModel::Fisheye)
                continue;
            CalibrationSetting setting = usual_setting("lens", true_name);
            setting.setting = name;
            setting.truth.is_wide = true;
            setting.truth.lens_model = true_model;
            setting.truth.free_views = 20;
            setting.options.lens_model = model;
            setting.with_checks = true;
            settings.push_back(std::move(setting));
        }
}

CalibrationChecks checks_of(const calibrate::Observations& seen,
                            calibrate::GeometryOptions options) {
    options.with_validation = true;
    const calibrate::Geometry found = calibrate_geometry(seen, options);
    CalibrationChecks checks;
    if (found.held_out)
        checks.held_out_px = found.held_out->rms_px;
    if (found.halves)
        checks.halves_ratio = found.halves->difference_rms_px / found.halves->predicted_rms_px;
    if (found.bend)
        checks.bend_significance = found.bend->significance_sigma;
    return checks;
}

CalibrationTrial tried(const CalibrationSetting& setting, std::uint32_t seed, int number) {
    TruthOptions options = setting.truth;
    options.seed = seed;
    options.trial = static_cast<std::uint32_t>(number);
    const CalibrationTruth truth = make_calibration_truth(options);
    const calibrate::Observations seen =
        observe(truth, setting.corner_sigma_px, seed, options.trial);
    CalibrationTrial trial;
    trial.trial = number;
    try {
        const calibrate::Geometry found = calibrate_geometry(seen, setting.options);
        trial.errors = errors_of(found, truth);
        trial.corner_sigma_px = found.corner_sigma_px;
        trial.rms_px = found.rms_px;
        trial.time_s = found.time_s;
        if (setting.with_checks)
            trial.checks = checks_of(seen, setting.options);
    } catch (const Error& error) {
        trial.refused = error.what();  // a finding: how often it happens is on the page
    }
    return trial;
}

}  // namespace

CalibrationFindings run_calibration_sweeps(const CalibrationSweepOptions& options,
                                           const std::function<void(double fraction)>& progress) {
    constexpr int kTrials = 20, kQuickTrials = 3;
    const double start_s = now_s();
    CalibrationFindings findings;
    findings.trials =
        options.trials > 0 ? options.trials : (options.quick ? kQuickTrials : kTrials);
    for (const auto add : {add_noise, add_boards, add_bend, add_tilt, add_lenses})
        add(options.quick, findings.settings);
    const double all = static_cast<double>(findings.settings.size()) * findings.trials;
    double done = 0.0;
    for (CalibrationSetting& setting : findings.settings)
        for (int number = 0; number < findings.trials; ++number) {
            setting.trials.push_back(tried(setting, options.seed, number));
            progress(++done / all);
        }
    findings.time_s = now_s() - start_s;
    return findings;
}

}  // namespace nearfield::bench
