// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration_points.h"
#include "app/bench/summary.h"
#include "formats/files/provenance.h"
#include "formats/report/plot.h"

#include <fmt/format.h>

#include <array>

namespace nearfield::bench {
namespace {

// Half of normal errors are below this times sigma.
constexpr double kMedianOfSigma = 0.6744897501960817;

struct CalibrationSweepText {
    const char *sweep, *title, *varied, *explanation;
    double unit;  // values are divided by it for plots
    bool is_log;
};

constexpr std::array<CalibrationSweepText, 5> kSweepTexts = {{
    {"noise", "Noise of corners", "corner noise, px",
     "Gaussian, along each axis, the same for all corners.", 1.0, true},
    {"boards", "Number of boards", "free views",
     "Views of the board held freely in front of the camera, besides two on S and two on U.", 1.0,
     true},
    {"bend", "A bent board", "bend, mm",
     "The board is a bowl: at the middle of its left and right edge it is this far from flat, at "
     "the middle of its upper and lower edge half of it. Ignored: calibrated as if it were flat. "
     "Estimated: its shape is among what is fitted.",
     1e-3, false},
    {"tilt", "Planes that are not parallel", "tilt of U against S, degrees",
     "Calibration finds the tilt and the filter's positions with it; \"called parallel\" takes the "
     "same positions to lie at equal distance from S. Direction: of the ray from a position "
     "through where a pixel sees S.",
     3.14159265358979324 / 180.0, false},
    {"lens", "The wrong lens model", "",
     "A wide lens of each model, fitted as each model; 20 free views. Held-out: calibration's own "
     "check, the residuals of views that the lens was not fitted to. Halves: how far lenses from "
     "two halves of the views are apart, over what their sigmas predict.",
     1.0, false},
}};

report::Curve measured_curve(const std::string& name, const std::string& color) {
    report::Curve curve;
    curve.name = name;
    curve.marks = report::Marks::Dots;
    curve.color = color;
    return curve;
}

void add_size(report::Curve& curve, double x, const Quartiles& size, double factor) {
    curve.x.push_back(x);
    curve.y.push_back(factor * size.median);
    curve.y_low.push_back(factor * size.low);
    curve.y_high.push_back(factor * size.high);
}

using Points = std::vector<CalibrationPoint>;

// An error's quartiles, and what predicted sigmas say of its median.
void add_error(report::Plot& plot,
               const CalibrationSweepText& text,
               const Points& points,
               const std::string& name,
               const std::string& color,
               const ErrorSize CalibrationPoint::*error,
               double factor,
               double median_of_sigma) {
    report::Curve measured = measured_curve(name, color);
    report::Curve predicted;
    predicted.name = name + ", predicted";
    predicted.color = color;
    for (const CalibrationPoint& point : points) {
        add_size(measured, point.value / text.unit, (point.*error).size, factor);
        predicted.x.push_back(point.value / text.unit);
        predicted.y.push_back(factor * median_of_sigma * (point.*error).predicted);
    }
    plot.curves.push_back(std::move(measured));
    plot.curves.push_back(std::move(predicted));
}

report::Plot empty_plot(const CalibrationSweepText& text,
                        const std::string& title,
                        const std::string& y_label) {
    report::Plot plot;
    plot.title = title;
    plot.x_label = text.varied;
    plot.y_label = y_label;
    plot.log_x = text.is_log;
    plot.log_y = true;
    return plot;
}

// The first series in color, the others after it: bend ignored, bend estimated.
std::vector<std::string> series_of(const Points& points) {
    std::vector<std::string> series;
    for (const CalibrationPoint& point : points)
        if (series.empty() || series.back() != point.series)
            series.push_back(point.series);
    return series;
}

std::vector<report::Plot> plots_of(const CalibrationFindings& findings,
                                   const CalibrationSweepText& text) {
    constexpr std::array<const char*, 2> kBlues = {"#0072b2", "#56b4e9"};
    constexpr std::array<const char*, 2> kReds = {"#d55e00", "#e69f00"};
    const Points all = points_of(findings, text.sweep);
    report::Plot numbers = empty_plot(text, "Delta and focal length", "relative error, %");
    report::Plot picture = empty_plot(text, "Lens over the picture", "RMS, px");
    report::Plot direction = empty_plot(text, "Directions of rays", "RMS, mrad");
    const std::vector<std::string> series = series_of(all);
    for (std::size_t k = 0; k < series.size() && k < kBlues.size(); ++k) {
        const Points points = points_of(findings, text.sweep, series[k]);
        const std::string of = series.size() > 1 ? ", " + series[k] : "";
        add_error(numbers, text, points, "delta" + of, kBlues[k], &CalibrationPoint::delta_rel,
                  100.0, kMedianOfSigma);
        add_error(numbers, text, points, "focal length" + of, kReds[k],
                  &CalibrationPoint::focal_rel, 100.0, kMedianOfSigma);
        add_error(picture, text, points, "projection" + of, kBlues[k],
                  &CalibrationPoint::projection_px, 1.0, 1.0);
        report::Curve found = measured_curve("as found" + of, kBlues[k]);
        report::Curve parallel = measured_curve("called parallel" + of, kReds[k]);
        for (const CalibrationPoint& point : points) {
            add_size(found, point.value / text.unit, point.direction_rad, 1e3);
            add_size(parallel, point.value / text.unit, point.direction_parallel_rad, 1e3);
        }
        direction.curves.push_back(std::move(found));
        direction.curves.push_back(std::move(parallel));
    }
    if (std::string(text.sweep) == "tilt")
        return {direction, numbers};
    return {numbers, picture};
}

std::string with_quartiles(const Quartiles& size, double factor) {
    return fmt::format("{:.2g} ({:.2g} ... {:.2g})", factor * size.median, factor * size.low,
                       factor * size.high);
}

report::Table calibration_table(const CalibrationFindings& findings,
                                const CalibrationSweepText& text) {
    const Points points = points_of(findings, text.sweep);
    report::Table table{
        "Medians over trials and quartiles; over sigma: RMS of error over its predicted sigma, 1 "
        "where sigmas are right",
        {"", "setting", "delta, %", "over sigma", "focal length, %", "over sigma", "projection, px",
         "over predicted", "directions, mrad", "called parallel", "time", "refused"},
        {}};
    const bool has_checks = !points.empty() && points.front().checks.has_value();
    if (has_checks)
        table.columns.insert(table.columns.end(),
                             {"held-out, px", "halves over predicted", "bend, sigmas"});
    for (const CalibrationPoint& point : points) {
        table.rows.push_back(
            {point.series, point.setting, with_quartiles(point.delta_rel.size, 100.0),
             fmt::format("{:.2g}", point.delta_rel.scale),
             with_quartiles(point.focal_rel.size, 100.0),
             fmt::format("{:.2g}", point.focal_rel.scale),
             with_quartiles(point.projection_px.size, 1.0),
             fmt::format("{:.2g}", point.projection_px.scale),
             with_quartiles(point.direction_rad, 1e3),
             fmt::format("{:.2g}", 1e3 * point.direction_parallel_rad.median),
             time_text(1e6 * point.time_s.median), fmt::format("{}", point.refused)});
        if (!has_checks)
            continue;
        std::vector<std::string> cells(3);
        if (point.checks)
            cells = {fmt::format("{:.3g}", point.checks->held_out_px),
                     fmt::format("{:.2g}", point.checks->halves_ratio),
                     fmt::format("{:.2g}", point.checks->bend_significance)};
        table.rows.back().insert(table.rows.back().end(), cells.begin(), cells.end());
    }
    return table;
}

report::Section sweep_section(const CalibrationFindings& findings,
                              const CalibrationSweepText& text) {
    report::Section section{text.title, {text.explanation}, {}, {}, {}};
    section.columns = 2;
    std::string follows = "What follows:";
    for (const std::string& sentence : calibration_conclusions(findings, text.sweep))
        follows += " " + sentence;
    section.paragraphs.push_back(follows);
    if (*text.varied != '\0')
        for (const report::Plot& plot : plots_of(findings, text)) {
            const auto image =
                report::draw(plot, plot.title +
                                       ": medians and quartiles over trials; lines without points: "
                                       "what the predicted sigmas say.");
            if (image)
                section.images.push_back(*image);
            else
                section.paragraphs.emplace_back(
                    "gnuplot is not installed or failed, so a plot is missing (Debian package "
                    "gnuplot-nox).");
        }
    section.tables.push_back(calibration_table(findings, text));
    return section;
}

report::Section calibration_introduction(const CalibrationFindings& findings,
                                         const CalibrationSetup& setup) {
    report::Section section{"What was measured", {}, {}, {}, {}};
    section.paragraphs = {
        fmt::format(
            "How good is a calibrated bench? Its truth is known here: a camera of 512 x 512 pixels "
            "0.8 m from S, U 0.2 m behind S and tilted by 0.29 degrees, a board of 8 x 6 squares "
            "of "
            "30 mm, a stage of 9 x 7 positions whose errors are 20 um. Where corners are seen is "
            "computed, and noise added: 0.05 px where not said otherwise. Each setting is "
            "calibrated {} times with other noise, other poses of the boards and other errors of "
            "the stage; all settings of a sweep have the same.",
            findings.trials),
        "Delta: distance of U from S. Projection: RMS over the picture of how far apart the found "
        "and the true lens see far points, once the camera is turned to bring them nearest. "
        "Predicted: from calibration's own sigmas; they tell what noise does, and not what the "
        "model leaves out. Time: of calibrate_geometry without its validation."};
    for (const std::string& sentence : calibration_conclusions(findings, "sigma"))
        section.paragraphs.push_back(sentence);
    if (setup.quick)
        section.paragraphs.emplace_back(
            "This is a quick run of few trials: its numbers show that everything runs, and nothing "
            "else.");
    return section;
}

}  // namespace

void write_page(const CalibrationFindings& findings,
                const CalibrationSetup& setup,
                const std::string& path) {
    report::Page page;
    page.title = "How good a calibration is";
    page.summary =
        "Errors of a bench's geometry against noise, boards, bends, tilts and lens models. Made "
        "by " +
        program_version() + ".";
    page.sections = {calibration_introduction(findings, setup)};
    for (const CalibrationSweepText& text : kSweepTexts)
        page.sections.push_back(sweep_section(findings, text));
    report::Section provenance{"Machine and command", {}, {}, {}, {}};
    provenance.preformatted = fmt::format("{}\n{}\n{}\n{:.0f} s in all\n", setup.command_line,
                                          program_version(), setup.machine, findings.time_s);
    page.sections.push_back(provenance);
    report::write_page(page, path);
}

}  // namespace nearfield::bench
