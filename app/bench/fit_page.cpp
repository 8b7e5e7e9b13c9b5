// SPDX-License-Identifier: Apache-2.0
#include "app/bench/fit.h"
#include "app/bench/summary.h"
#include "formats/files/provenance.h"
#include "formats/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace nearfield::bench {
namespace {

struct FitSweepText {
    const char *sweep, *title, *varied, *explanation;
    bool is_log;
};

constexpr std::array<FitSweepText, 9> kFitSweeps = {{
    {"positions", "Number of positions", "positions",
     "The stage's steps always cover the lens: more positions are finer steps, a narrower filter "
     "and more basis functions. Each gathers less light.",
     true},
    {"missing", "Missing positions", "share of positions",
     "Left out at random; smoothness has to bridge them.", false},
    {"exposures", "Exposures", "exposures of a position",
     "The shortest brings the brightest light to three quarters of saturation, each other is four "
     "times as long as the one before.",
     false},
    {"frames", "Frames", "frames of each exposure",
     "Averaged: as many times the electrons, and less read noise.", true},
    {"filter", "Width of the filter", "filter's pitch over the stage's steps",
     "A B-spline whose width does not follow the stage's steps. Wide filters overlap: they gather "
     "more light and say less about where it came from.",
     false},
    {"basis", "Basis", "", "Basis functions on the same positions, behind the same filter.", false},
    {"delta", "Distance of the planes", "delta, m",
     "A basis function on U blurs directions by its pitch over delta.", true},
    {"lambda", "Smoothness", "lambda", "Given, not chosen by cross-validation as everywhere else.",
     true},
    {"model-error", "The model's own error", "share of a texel's brightest position",
     "Added to every measurement's sigma. Too little: what the basis cannot show is called signal "
     "where positions are dark and their counts well known. Too much: the dark is not used.",
     true},
}};

std::vector<const FitResult*> results_of(const FitFindings& findings, const std::string& sweep) {
    std::vector<const FitResult*> results;
    for (const FitResult& result : findings.results)
        if (result.setting.sweep == sweep)
            results.push_back(&result);
    return results;
}

report::Plot plot_of(const std::vector<const FitResult*>& results, const FitSweepText& text) {
    report::Plot plot;
    plot.title = "Irradiance, relative RMS";
    plot.x_label = text.varied;
    plot.y_label = "%";
    plot.log_x = text.is_log;
    plot.log_y = true;
    const auto add = [&](const char* name, const char* color, const double FitResult::*error) {
        report::Curve curve;
        curve.name = name;
        curve.color = color;
        curve.marks = report::Marks::Dots;
        for (const FitResult* result : results) {
            curve.x.push_back(result->setting.value);
            curve.y.push_back(100 * result->*error);
        }
        plot.curves.push_back(std::move(curve));
    };
    add("noise", "#0072b2", &FitResult::noise_rms);
    add("basis and texels", "#e69f00", &FitResult::basis_rms);
    add("all", "#d55e00", &FitResult::total_rms);
    return plot;
}

report::Table table_of(const std::vector<const FitResult*>& results) {
    report::Table table{
        "Irradiance: relative RMS over receivers. Noise: against the fit of noise-free data; "
        "basis: of that fit against the formula; time: of a core, a texel, with sigmas",
        {"setting", "positions", "lambda", "noise", "basis", "all", "flux", "within 3 sigma",
         "chi-square", "KKT residual", "factorizations", "time"},
        {}};
    for (const FitResult* result : results)
        table.rows.push_back(
            {result->setting.setting, fmt::format("{}", result->positions),
             fmt::format("{:g}", result->lambda), percent_text(result->noise_rms),
             percent_text(result->basis_rms), percent_text(result->total_rms),
             fmt::format("{:+.2f} %", 100 * result->flux_rel),
             fmt::format("{:.1f} %", 100 * result->coverage),
             fmt::format("{:.2f}", result->chi_square), fmt::format("{:.0e}", result->kkt_worst),
             fmt::format("{:.1f}", result->factorizations), time_text(result->texel_us)});
    return table;
}

// Which setting comes nearest to the formula, and which has least noise.
std::string conclusion(const std::vector<const FitResult*>& results) {
    const auto least = [&](const double FitResult::*error) {
        return *std::min_element(
            results.begin(), results.end(),
            [&](const FitResult* a, const FitResult* b) { return a->*error < b->*error; });
    };
    const FitResult *nearest = least(&FitResult::total_rms),
                    *quietest = least(&FitResult::noise_rms);
    return fmt::format("Nearest to the lamp: {} ({}). Least noise: {} ({}).",
                       nearest->setting.setting, percent_text(nearest->total_rms),
                       quietest->setting.setting, percent_text(quietest->noise_rms));
}

report::Section sweep_section(const FitFindings& findings, const FitSweepText& text) {
    report::Section section{text.title, {text.explanation}, {}, {}, {}};
    const std::vector<const FitResult*> results = results_of(findings, text.sweep);
    section.paragraphs.push_back(conclusion(results));
    if (*text.varied != '\0') {
        if (const auto image = report::draw(plot_of(results, text), text.title))
            section.images.push_back(*image);
        else
            section.paragraphs.emplace_back(
                "gnuplot is not installed or failed, so the plot is missing (Debian package "
                "gnuplot-nox).");
    }
    section.tables.push_back(table_of(results));
    return section;
}

report::Section solver_section(const SolverComparison& comparison) {
    report::Section section{"The solver's time", {}, {}, {}, {}};
    section.paragraphs = {
        "Non-negative least squares of the reference lamp (11 x 9 images, B-splines) behind a "
        "filter off U by up to half a millimetre, a camera's noise, no smoothing. Lawson-Hanson: "
        "columns come in one at a time from none; \"fresh\" factorizes all that are in by "
        "Householder QR at every exchange, as lsqnonneg and most short programs do; \"updated\" "
        "keeps one factorization by reflections and rotations, as the authors' program does. "
        "Times are of a core, on the same texels in this run; the difference is the largest of a "
        "coefficient, relative to its texel's largest."};
    report::Table solvers{"", {"solver", "a texel", "times the first", "difference", "texels"}, {}};
    for (const SolverTime& solver : comparison.solvers)
        solvers.rows.push_back(
            {solver.name, time_text(solver.texel_us), fmt::format("{:.3g}", solver.times_ours),
             fmt::format("{:.0e}", solver.difference), fmt::format("{}", solver.texels)});
    report::Table wholes{"All texels and channels",
                         {"", "texels", "channels", "wall time", "threads", "time of all cores",
                          "a texel and channel", "factorizations", "free", "KKT residual"},
                         {}};
    for (const auto& [name, cost] : comparison.wholes)
        wholes.rows.push_back(
            {name, fmt::format("{} x {}", cost.texels, cost.texels),
             fmt::format("{}", cost.channels), fmt::format("{:.1f} s", cost.wall_s),
             fmt::format("{}", cost.threads), fmt::format("{:.1f} s", cost.cpu_s),
             time_text(cost.texel_us), fmt::format("{:.2f}", cost.factorizations),
             fmt::format("{:.1f}", cost.free_coefficients), fmt::format("{:.0e}", cost.kkt_worst)});
    section.tables = {solvers, wholes};
    return section;
}

report::Section introduction(const FitFindings& findings, const FitSetup& setup) {
    report::Section section{"What was measured", {}, {}, {}, {}};
    section.paragraphs = {
        fmt::format(
            "A headlight that is known by formula is measured behind a B-spline filter at 11 x 9 "
            "positions that cover its lens, planes 0.2 m apart, and fitted: B-splines, {} x {} "
            "texels, smoothness by cross-validation. Each section varies one of these. The camera "
            "has 12 bits, 2.4 electrons and 2.6 DN of read noise, a pixel a texel, three "
            "exposures.",
            findings.texels.x, findings.texels.y),
        fmt::format(
            "Error is the relative RMS of illuminance at {} receivers facing the lamp 1 to 25 m "
            "away, within its beam. Noise: against the fit of the same measurements without noise, "
            "same weights and smoothness; basis and texels: of that fit against the formula, what "
            "no camera can mend; all: of the fit against the formula.",
            findings.receivers)};
    if (setup.quick)
        section.paragraphs.emplace_back(
            "This is a quick run of few texels: its numbers show that everything runs, and nothing "
            "else.");
    return section;
}

}  // namespace

void write_page(const FitFindings& findings, const FitSetup& setup, const std::string& path) {
    report::Page page;
    page.title = "How good a fitted light field is, and what it costs";
    page.summary =
        "Errors of a measured light field against positions, exposures, filter, basis, planes and "
        "smoothness. Made by " +
        program_version() + ".";
    page.sections = {introduction(findings, setup)};
    for (const FitSweepText& text : kFitSweeps)
        page.sections.push_back(sweep_section(findings, text));
    page.sections.push_back(solver_section(findings.solvers));
    report::Section provenance{"Machine and command", {}, {}, {}, {}};
    provenance.preformatted = fmt::format("{}\n{}\n{}\n{:.0f} s in all\n", setup.command_line,
                                          program_version(), setup.machine, findings.time_s);
    page.sections.push_back(provenance);
    report::write_page(page, path);
}

}  // namespace nearfield::bench
