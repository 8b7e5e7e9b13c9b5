// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration.h"

#include <fmt/format.h>

namespace nearfield::bench {
namespace {

// Messages hold commas and perhaps quotes.
std::string quoted(const std::string& text) {
    std::string all = "\"";
    for (const char letter : text)
        all += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return all + "\"";
}

}  // namespace

std::string as_csv(const CalibrationFindings& findings) {
    std::string csv =
        "sweep,series,setting,value,trial,delta_rel,delta_sigma_rel,focal_rel,focal_sigma_rel,"
        "projection_px,projection_predicted_px,direction_rad,direction_parallel_rad,corner_sigma_"
        "px,"
        "rms_px,held_out_px,halves_ratio,bend_significance,time_s,refused\n";
    for (const CalibrationSetting& setting : findings.settings)
        for (const CalibrationTrial& trial : setting.trials) {
            csv += fmt::format("{},{},{},{:.9g},{},", setting.sweep, setting.series,
                               setting.setting, setting.value, trial.trial);
            const CalibrationErrors& errors = trial.errors;
            if (!trial.refused.empty()) {
                csv += ",,,,,,,,,,,,,," + quoted(trial.refused) + "\n";
                continue;
            }
            csv += fmt::format(
                "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},",
                errors.delta_rel.error, errors.delta_rel.sigma, errors.focal_rel.error,
                errors.focal_rel.sigma, errors.projection_px, errors.projection_predicted_px,
                errors.direction_rad, errors.direction_parallel_rad, trial.corner_sigma_px,
                trial.rms_px);
            csv += trial.checks
                       ? fmt::format("{:.9g},{:.9g},{:.9g},", trial.checks->held_out_px,
                                     trial.checks->halves_ratio, trial.checks->bend_significance)
                       : std::string(",,,");
            csv += fmt::format("{:.9g},\n", trial.time_s);
        }
    return csv;
}

}  // namespace nearfield::bench
