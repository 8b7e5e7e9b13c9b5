// SPDX-License-Identifier: Apache-2.0
#include "formats/report/page.h"

#include "app/bench/cases.h"
#include "app/bench/files.h"
#include "app/bench/page_plots.h"
#include "app/bench/summary.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::bench {
namespace {

constexpr const char* kNoGnuplot =
    "gnuplot is not installed or failed, so the plots of this section are missing (Debian package "
    "gnuplot-nox).";

void add_plot(report::Section& section, const std::optional<report::Image>& image) {
    if (image)
        section.images.push_back(*image);
    else if (section.paragraphs.empty() || section.paragraphs.back() != kNoGnuplot)
        section.paragraphs.emplace_back(kNoGnuplot);
}

report::Section what_this_is(const Findings& findings, const Setup& setup) {
    report::Section section{"What was measured", {}, {}, {}, {}};
    section.paragraphs = {
        fmt::format("How much light does a lamp send to a point? Lamp: {}. Points: {}.", setup.lamp,
                    setup.receivers),
        "The lamp is known as images, one for every place of its lens, and each point sees a "
        "window of every "
        "image. The methods below (\"samplers\") add up what is in these windows: \"sum\" all of "
        "it, or all "
        "of a coarser image; the others a number K of random samples.",
        "Error is each result against the same sum in double precision, relative to it, over all "
        "points "
        "that get at least a thousandth of the brightest one's light: the root of its mean square "
        "(RMS) "
        "over points and repeated runs with other random numbers. Time is wall time a point, the "
        "best of "
        "several runs, all in one run of this program, on the same threads (" +
            fmt::format("{}, {} used).", setup.machine, findings.threads)};
    return section;
}

std::string arrival_text(const std::optional<CostPoint>& arrival) {
    return arrival ? time_text(arrival->time_us) : "never";
}

std::string speedup_text(const SamplerSummary& summary, std::size_t goal, const char* baseline) {
    for (const Speedup& speedup : summary.speedups[goal])
        if (speedup.baseline == baseline && summary.sampler != baseline && speedup.ratio)
            return (speedup.baseline_arrives ? "" : "more than ") +
                   fmt::format("{:.3g} x", *speedup.ratio);
    return "";
}

report::Section verdict(const Findings& findings) {
    report::Section section{"What an error costs", {}, {}, {}, {}};
    const std::vector<SamplerSummary> summaries = summarize(findings);
    section.paragraphs = sentences(summaries);
    section.paragraphs.emplace_back(
        "Times between two measured settings are interpolated on logarithmic axes. \"More than\": "
        "the "
        "baseline never gets there; the ratio is to the time after which it was given up. \"Where "
        "it "
        "ends\" is the largest K tried, or the exact sum.");
    for (std::size_t goal = 0; goal < kGoals_rel.size(); ++goal) {
        report::Table table{
            fmt::format("Time a point to an error of {}", percent_text(kGoals_rel[goal])),
            {"sampler", "time", "with K or Q of", "faster than pdis", "faster than uniform",
             "where it ends"},
            {}};
        for (const SamplerSummary& summary : summaries) {
            const auto& arrival = summary.arrivals[goal];
            table.rows.push_back({summary.sampler, arrival_text(arrival),
                                  !arrival            ? ""
                                  : arrival->size > 0 ? fmt::format("{:.0f}", arrival->size)
                                                      : "exact",
                                  speedup_text(summary, goal, "pdis"),
                                  speedup_text(summary, goal, "uniform"),
                                  fmt::format("{} after {}", percent_text(summary.end.error_rel),
                                              time_text(summary.end.time_us))});
        }
        section.tables.push_back(table);
    }
    return section;
}

report::Section samplers_explained() {
    report::Section section{"The samplers", {}, {}, {}, {}};
    section.tables.push_back(
        {"What each does",
         {"name", "how it works"},
         {{"uniform",
           "as many samples in every image, anywhere in its window: the simplest baseline"},
          {"precomputed",
           "samples by the images' brightness alone, the same points of the lamp for every "
           "receiver"},
          {"pdis",
           "position-dependent importance sampling as published in 2015: rounds the number of "
           "samples of "
           "each image, so that dim images are left out when K is small, and draws one coordinate "
           "from the "
           "whole column: some error stays however large K is"},
          {"systematic",
           "one evenly spaced set of samples through all windows' exact contents: no bias for any "
           "K"},
          {"cells", "the same by cells of the lens, weighted by the basis function"},
          {"sum",
           "no samples: adds all texels in the windows, on images coarsened until a window is at "
           "most Q "
           "texels wide; without Q exact"}}});
    return section;
}

report::Table table_of(const std::vector<const Result*>& results, const SweepText& text) {
    const bool has_blocks = std::any_of(results.begin(), results.end(), [](const Result* result) {
        return result->block_rms.has_value();
    });
    report::Table table{
        "",
        {text.curve_name, text.setting_name, "RMS error", "half below", "95 % below", "largest",
         "mean (bias)", "time a point", "of it tables", "reads a point"},
        {}};
    if (has_blocks)
        table.columns.emplace_back("RMS of 4 x 4 means");
    for (const Result* result : results) {
        const render::RelativeError& error = result->error;
        std::vector<std::string> row = {
            result->of.curve,
            result->of.setting,
            percent_text(error.rms),
            percent_text(error.p50),
            percent_text(error.p95),
            percent_text(error.largest),
            percent_text(error.bias),
            time_text(result->time_us),
            result->of.method.sampling ? time_text(result->look_us) : "",
            fmt::format("{:.0f}", result->reads)};
        if (has_blocks)
            row.push_back(percent_text(*result->block_rms));
        table.rows.push_back(std::move(row));
    }
    return table;
}

report::Section curves(const Findings& findings) {
    report::Section section{"Error against time and against K", {}, {}, {}, {}};
    section.paragraphs.emplace_back(
        "Lower left is better. Circles mark settings that no other beats in both error and time. "
        "Bars: the "
        "smallest and largest error of the repeated runs.");
    add_plot(section,
             report::draw(error_against_time(findings), "Error against wall time a point."));
    add_plot(
        section,
        report::draw(error_against_k(findings),
                     "Error against the number of samples K (Q of the sum has another meaning: "
                     "it is not shown)."));
    report::Table table = table_of(results_of(findings, "samplers"), text_of("samplers"));
    table.caption =
        "All settings. \"Of it tables\": what comes before the first sample, looking up the light "
        "in "
        "every window; the rest is drawing samples. Reads: of tables and texels.";
    section.tables.push_back(std::move(table));
    return section;
}

report::Section steps(const Findings& findings) {
    report::Section section{"Where the time goes", {}, {}, {}, {}};
    section.paragraphs.emplace_back(
        "Before a sampler draws, it looks up how much light every window holds; that costs the "
        "same whatever K "
        "is. Then every sample costs its share.");
    add_plot(
        section,
        report::draw(time_against_k(findings),
                     "Time a point against K: level where looking up the windows dominates, rising "
                     "where samples do. The level line is the exact sum."));
    return section;
}

report::Section knob(const Findings& findings, const std::string& sweep) {
    const SweepText text = text_of(sweep);
    report::Section section{text.title, {text.explanation}, {}, {}, {}};
    const std::vector<const Result*> results = results_of(findings, sweep);
    add_plot(section,
             report::draw(knob_plot(findings, sweep),
                          "The table's settings, joined in its order; lower left is better."));
    report::Table table = table_of(results, text);
    table.caption = "Each setting's error and time";
    section.tables.push_back(std::move(table));
    return section;
}

report::Section pictures(const WallPictures& wall) {
    report::Section section{"On a wall", {}, {}, {}, {}};
    section.columns = 2;
    section.paragraphs.push_back(fmt::format(
        "A wall {:.3g} m ahead of the lamp, {} x {} pixels, each sampler in about the time that "
        "the "
        "exact sum takes ({} a pixel). Left: illuminance. Right: its error, from black (0.1 %) to "
        "white (100 %); white is also where there is hardly any light.",
        wall.wall.z_m, wall.wall.size.x, wall.wall.size.y,
        time_text(wall.pictures.front().time_us)));
    for (const WallPicture& picture : wall.pictures) {
        const std::string settings =
            picture.size == 0
                ? std::string("exact")
                : fmt::format("{} = {}", picture.sampler == "sum" ? "Q" : "K", picture.size);
        add_plot(section, report::draw(light_map(wall, picture),
                                       fmt::format("{}, {}: {} a pixel", picture.sampler, settings,
                                                   time_text(picture.time_us))));
        add_plot(section, report::draw(error_map(wall, picture),
                                       fmt::format("{}: RMS error {}, largest {}", picture.sampler,
                                                   percent_text(picture.error.rms),
                                                   percent_text(picture.error.largest))));
    }
    return section;
}

report::Section provenance(const Findings& findings, const Setup& setup) {
    report::Section section{"Machine and command", {}, {}, {}, {}};
    section.preformatted =
        fmt::format("{}\n{}\n{}, {} used\n{:.0f} s in all\n", setup.command_line, program_version(),
                    setup.machine, findings.threads, findings.time_s);
    if (findings.skipped > 0)
        section.paragraphs.push_back(fmt::format(
            "Settings left out by --time-limit-s, the most costly ones: {}.", findings.skipped));
    return section;
}

}  // namespace

void write_page(const Findings& findings, const Setup& setup, const std::string& path) {
    report::Page page;
    page.title = "What accuracy costs in time";
    page.summary = "Ways to compute the light of a near-field lamp: error against time. Made by " +
                   program_version() + ".";
    page.sections.push_back(what_this_is(findings, setup));
    if (!results_of(findings, "samplers").empty()) {
        page.sections.push_back(verdict(findings));
        page.sections.push_back(samplers_explained());
        page.sections.push_back(curves(findings));
        page.sections.push_back(steps(findings));
    }
    if (!findings.pictures.pictures.empty())
        page.sections.push_back(pictures(findings.pictures));
    for (const std::string& sweep : sweep_names())
        if (sweep != "samplers" && !results_of(findings, sweep).empty())
            page.sections.push_back(knob(findings, sweep));
    page.sections.push_back(provenance(findings, setup));
    report::write_page(page, path);
}

}  // namespace nearfield::bench
