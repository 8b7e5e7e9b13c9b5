// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration_points.h"
#include "app/bench/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace nearfield::bench {
namespace {

using Sentences = std::vector<std::string>;
using Points = std::vector<CalibrationPoint>;

struct PowerLaw {
    double at_one = 0, exponent = 0;  // y = at_one * x^exponent
};

/// Least squares on logarithms of the medians.
PowerLaw power_law(const Points& points,
                   const std::function<double(const CalibrationPoint&)>& y_of) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (const CalibrationPoint& point : points) {
        const double log_x = std::log(point.value), log_y = std::log(y_of(point));
        n += 1.0;
        x += log_x;
        y += log_y;
        xx += log_x * log_x;
        xy += log_x * log_y;
    }
    const double exponent = (n * xy - x * y) / (n * xx - x * x);
    return {std::exp((y - exponent * x) / n), exponent};
}

double delta_median(const CalibrationPoint& point) {
    return point.delta_rel.size.median;
}
double focal_median(const CalibrationPoint& point) {
    return point.focal_rel.size.median;
}
double projection_median(const CalibrationPoint& point) {
    return point.projection_px.size.median;
}

Sentences conclude_noise(const CalibrationFindings& findings) {
    const Points points = points_of(findings, "noise");
    const PowerLaw delta = power_law(points, delta_median), focal = power_law(points, focal_median),
                   projection = power_law(points, projection_median);
    const auto at = [](const PowerLaw& law) { return law.at_one * std::pow(0.1, law.exponent); };
    return {fmt::format(
        "Errors grow with the noise of corners to the power {:.2f} (delta), {:.2f} (focal length) "
        "and {:.2f} (projection); 1 is in proportion. At 0.1 px half of the calibrations are "
        "within {} of delta, {} of the focal length, and {:.2g} px RMS over the picture.",
        delta.exponent, focal.exponent, projection.exponent, percent_text(at(delta)),
        percent_text(at(focal)), at(projection))};
}

Sentences conclude_boards(const CalibrationFindings& findings) {
    const Points points = points_of(findings, "boards");
    const CalibrationPoint &few = points.front(), &many = points.back();
    return {fmt::format(
        "From {} to {} free views the predicted sigma of delta falls from {} to {}, that of the "
        "focal length from {} to {}; the lens' error over the picture falls from {:.2g} to {:.2g} "
        "px. To the power of the number of views: {:.2f}, {:.2f} and {:.2f}; -0.5 is what as good "
        "views would do that were independent.",
        few.setting, many.setting, percent_text(few.delta_rel.predicted),
        percent_text(many.delta_rel.predicted), percent_text(few.focal_rel.predicted),
        percent_text(many.focal_rel.predicted), projection_median(few), projection_median(many),
        power_law(points, [](const CalibrationPoint& p) { return p.delta_rel.predicted; }).exponent,
        power_law(points, [](const CalibrationPoint& p) { return p.focal_rel.predicted; }).exponent,
        power_law(points, projection_median).exponent)};
}

// Settings of a sweep share their trials: pooled, they are no more independent than one.
Sentences conclude_sigma(const CalibrationFindings& findings) {
    const double band = 3.0 / std::sqrt(2.0 * findings.trials);
    const auto verdict = [&](const char* what, const Points& points,
                             const ErrorSize CalibrationPoint::*error) {
        double sum = 0.0;
        for (const CalibrationPoint& point : points)
            sum += (point.*error).scale * (point.*error).scale;
        const double scale = std::sqrt(sum / static_cast<double>(points.size()));
        return fmt::format("{} {:.2f} ({})", what, scale,
                           std::abs(scale - 1.0) <= band ? "agrees with 1"
                           : scale > 1.0                 ? "sigmas are too small"
                                                         : "sigmas are too large");
    };
    Points points = points_of(findings, "noise");
    for (const CalibrationPoint& point : points_of(findings, "boards"))
        points.push_back(point);
    return {fmt::format(
        "RMS of error over predicted sigma, over noise and boards: {}, {}, {}. With {} trials it "
        "is itself only known to {:.2f} (three sigmas).",
        verdict("delta", points, &CalibrationPoint::delta_rel),
        verdict("focal length", points, &CalibrationPoint::focal_rel),
        verdict("projection", points, &CalibrationPoint::projection_px), findings.trials, band)};
}

Sentences conclude_bend(const CalibrationFindings& findings) {
    const Points ignored = points_of(findings, "bend", "bend ignored");
    const Points estimated = points_of(findings, "bend", "bend estimated");
    Sentences sentences = {fmt::format(
        "Ignored, a bend of {} moves delta by {} and the focal length by {}; estimated, errors are "
        "{} and {}, against {} and {} with a flat board that is taken for flat.",
        ignored.back().setting, percent_text(delta_median(ignored.back())),
        percent_text(focal_median(ignored.back())), percent_text(delta_median(estimated.back())),
        percent_text(focal_median(estimated.back())), percent_text(delta_median(ignored.front())),
        percent_text(focal_median(ignored.front())))};
    constexpr double kMisled = 2.0;
    const auto misled =
        std::find_if(ignored.begin(), ignored.end(), [](const CalibrationPoint& point) {
            return point.delta_rel.scale > kMisled || point.focal_rel.scale > kMisled;
        });
    if (misled == ignored.end())
        sentences.emplace_back("No bend that was tried takes errors beyond twice their sigmas.");
    else
        sentences.push_back(fmt::format(
            "From {} on errors are beyond their sigmas (delta {:.2g} times, focal length {:.2g} "
            "times): sigmas do not know of what the model leaves out. Calibration's own test of "
            "the bend says {:.2g} sigmas there, and {:.2g} for a flat board.",
            misled->setting, misled->delta_rel.scale, misled->focal_rel.scale,
            misled->checks->bend_significance, ignored.front().checks->bend_significance));
    return sentences;
}

Sentences conclude_tilt(const CalibrationFindings& findings) {
    const Points points = points_of(findings, "tilt");
    Sentences sentences;
    for (const CalibrationPoint& point : points)
        if (point.setting == "1 degree")
            sentences.push_back(fmt::format(
                "A tilt of 1 degree that is called parallel: directions of rays are wrong by "
                "{:.2g} mrad RMS, {:.2g} with the tilt that calibration finds.",
                1e3 * point.direction_parallel_rad.median, 1e3 * point.direction_rad.median));
    const auto pays = std::find_if(points.begin(), points.end(), [](const CalibrationPoint& point) {
        return point.direction_rad.median < point.direction_parallel_rad.median;
    });
    if (pays == points.begin())
        sentences.emplace_back(
            "The tilt that is found is the better one even where there is none.");
    else if (pays != points.end())
        sentences.push_back(fmt::format(
            "With two boards on U and corner noise of 0.05 px the found tilt is better than none "
            "from {} on ({:.2g} against {:.2g} mrad); at {} these are {:.2g} and {:.2g} mrad.",
            pays->setting, 1e3 * pays->direction_rad.median,
            1e3 * pays->direction_parallel_rad.median, points.front().setting,
            1e3 * points.front().direction_rad.median,
            1e3 * points.front().direction_parallel_rad.median));
    return sentences;
}

Sentences conclude_lens(const CalibrationFindings& findings) {
    constexpr double kNoticed = 1.1;
    Sentences sentences;
    std::vector<std::string> truths;
    for (const CalibrationPoint& point : points_of(findings, "lens"))
        if (truths.empty() || truths.back() != point.series)
            truths.push_back(point.series);
    for (const std::string& truth : truths) {
        const Points points = points_of(findings, "lens", truth);
        const auto right =
            std::find_if(points.begin(), points.end(),
                         [&](const CalibrationPoint& point) { return point.setting == truth; });
        if (right == points.end())
            continue;
        std::string text = fmt::format("A {} lens as what it is: {:.2g} px over the picture", truth,
                                       projection_median(*right));
        for (const CalibrationPoint& point : points) {
            if (point.setting == truth)
                continue;
            const double held_out = point.checks->held_out_px / right->checks->held_out_px;
            text += fmt::format(
                "; as {}: {:.2g} px and delta off by {} instead of {}, held-out "
                "views {:.2f} times as far off ({})",
                point.setting, projection_median(point), percent_text(delta_median(point)),
                percent_text(delta_median(*right)), held_out,
                held_out > kNoticed ? "it shows" : "it does not show");
        }
        sentences.push_back(text + ".");
    }
    return sentences;
}

}  // namespace

std::vector<std::string> calibration_conclusions(const CalibrationFindings& findings,
                                                 const std::string& sweep) {
    const std::map<std::string, Sentences (*)(const CalibrationFindings&)> all = {
        {"noise", conclude_noise}, {"boards", conclude_boards}, {"sigma", conclude_sigma},
        {"bend", conclude_bend},   {"tilt", conclude_tilt},     {"lens", conclude_lens}};
    return all.at(sweep)(findings);
}

}  // namespace nearfield::bench
