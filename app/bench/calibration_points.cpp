// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::bench {
namespace {

using Values = std::vector<double>;

double quantile_of_sorted(const Values& sorted, double share) {
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    const double part = at - static_cast<double>(below);
    return sorted[below] * (1.0 - part) + sorted[above] * part;
}

Quartiles quartiles(Values values) {
    std::sort(values.begin(), values.end());
    return {quantile_of_sorted(values, 0.25), quantile_of_sorted(values, 0.5),
            quantile_of_sorted(values, 0.75)};
}

template <typename ValueOf>
Quartiles quartiles_of(const std::vector<const CalibrationTrial*>& trials, ValueOf value_of) {
    Values values;
    for (const CalibrationTrial* trial : trials)
        values.push_back(value_of(*trial));
    return quartiles(std::move(values));
}

template <typename ErrorOf>
ErrorSize error_size(const std::vector<const CalibrationTrial*>& trials, ErrorOf error_of) {
    ErrorSize all;
    all.size = quartiles_of(
        trials, [&](const CalibrationTrial& trial) { return std::abs(error_of(trial).error); });
    all.predicted = quartiles_of(trials, [&](const CalibrationTrial& trial) {
                        return error_of(trial).sigma;
                    }).median;
    double sum = 0.0;
    for (const CalibrationTrial* trial : trials) {
        const CheckedError error = error_of(*trial);
        sum += error.error * error.error / (error.sigma * error.sigma);
    }
    all.scale = std::sqrt(sum / static_cast<double>(trials.size()));
    return all;
}

std::optional<CalibrationChecks> checks_medians(
    const std::vector<const CalibrationTrial*>& trials) {
    if (!trials.front()->checks)
        return std::nullopt;
    const auto median = [&](double CalibrationChecks::*member) {
        return quartiles_of(trials,
                            [&](const CalibrationTrial& trial) { return (*trial.checks).*member; })
            .median;
    };
    return CalibrationChecks{median(&CalibrationChecks::held_out_px),
                             median(&CalibrationChecks::halves_ratio),
                             median(&CalibrationChecks::bend_significance)};
}

CalibrationPoint point_of(const CalibrationSetting& setting,
                          const std::vector<const CalibrationTrial*>& trials) {
    CalibrationPoint point;
    point.series = setting.series;
    point.setting = setting.setting;
    point.value = setting.value;
    point.calibrated = static_cast<int>(trials.size());
    point.refused = static_cast<int>(setting.trials.size() - trials.size());
    point.delta_rel =
        error_size(trials, [](const CalibrationTrial& trial) { return trial.errors.delta_rel; });
    point.focal_rel =
        error_size(trials, [](const CalibrationTrial& trial) { return trial.errors.focal_rel; });
    point.projection_px = error_size(trials, [](const CalibrationTrial& trial) {
        return CheckedError{trial.errors.projection_px, trial.errors.projection_predicted_px};
    });
    point.direction_rad = quartiles_of(
        trials, [](const CalibrationTrial& trial) { return trial.errors.direction_rad; });
    point.direction_parallel_rad = quartiles_of(
        trials, [](const CalibrationTrial& trial) { return trial.errors.direction_parallel_rad; });
    point.time_s = quartiles_of(trials, [](const CalibrationTrial& trial) { return trial.time_s; });
    point.checks = checks_medians(trials);
    return point;
}

}  // namespace

std::vector<CalibrationPoint> points_of(const CalibrationFindings& findings,
                                        const std::string& sweep,
                                        const std::string& series) {
    std::vector<CalibrationPoint> points;
    for (const CalibrationSetting& setting : findings.settings) {
        if (setting.sweep != sweep || (!series.empty() && setting.series != series))
            continue;
        std::vector<const CalibrationTrial*> trials;
        for (const CalibrationTrial& trial : setting.trials)
            if (trial.refused.empty())
                trials.push_back(&trial);
        if (!trials.empty())
            points.push_back(point_of(setting, trials));
    }
    return points;
}

}  // namespace nearfield::bench
