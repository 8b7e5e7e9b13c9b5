// SPDX-License-Identifier: Apache-2.0
#include "app/bench/shadows.h"
#include "formats/files/provenance.h"
#include "formats/report/page.h"
#include "formats/report/plot.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>

namespace nearfield::bench {
namespace {

struct ShadowSweepText {
    const char *sweep, *title, *setting, *explanation;
};

constexpr std::array<ShadowSweepText, 4> kSweeps = {{
    {"eye", "Where maps are rendered from", "eye",
     "A map stands for a cell of the plane U that light leaves. \"cell\": it is rendered from the "
     "middle of the cell's light. \"paper\": from the mean of the images' medians on the plane S, "
     "as published in 2015: what stands between U and S is missed, and shadows are displaced."},
    {"maps", "Number of maps", "maps a lamp",
     "Cells whose light is near each other share a map. Fewer maps: penumbrae fall into steps."},
    {"map-px", "Size of a map", "pixels a side", "Finer maps: sharper borders of shadows."},
    {"pcf", "Filter", "taps",
     "Percentage-closer filtering: the share of so many of a map's pixels that nothing stands "
     "before."},
}};

std::string ms(double time_s) {
    return fmt::format("{:.{}f} ms", 1e3 * time_s, time_s < 0.1 ? 1 : 0);
}

report::Section what_this_is(const ShadowFindings& findings, const ShadowSetup& setup) {
    report::Section section{"What was measured", {}, {}, {}, {}};
    section.paragraphs = {
        fmt::format("How far are pictures whose shadows come from shadow maps from one whose "
                    "shadows come from rays? Scene: {}, camera {}, {} x {} pixels, all "
                    "surfaces white and matt.",
                    setup.scene, findings.camera, findings.size_px.x, findings.size_px.y),
        fmt::format("The traced picture takes {} rays a pixel and lamp and {:.3g} s. Difference is "
                    "the mean color difference (CIELAB, 1976, after 1 - exp(-L / mean)) over "
                    "pixels that light reaches. Two traced pictures with other random numbers are "
                    "{:.3g} apart: what is below that is noise of the reference. Without any "
                    "shadows the picture is {:.3g} away.",
                    findings.samples, findings.traced_s, findings.lab_noise, findings.lab_without),
        fmt::format("Time is that of the passes on {}, the least of several runs: rendering all "
                    "maps, which a scene that does not change needs once, and summing the lamps' "
                    "light with visibility by maps ({} without shadows).",
                    findings.device, ms(findings.light_without_s))};
    return section;
}

report::Plot plot_of(const ShadowFindings& findings) {
    report::Plot plot;
    plot.title = "Difference against time";
    plot.x_label = "maps and light, ms";
    plot.y_label = "mean Lab difference";
    plot.log_x = plot.log_y = true;
    for (const ShadowSweepText& text : kSweeps) {
        report::Curve curve;
        curve.name = text.setting;
        curve.marks = report::Marks::Dots;
        for (const ShadowResult& result : findings.results)
            if (result.sweep == text.sweep) {
                curve.x.push_back(1e3 * (result.maps_s + result.light_s));
                curve.y.push_back(result.lab);
            }
        plot.curves.push_back(std::move(curve));
    }
    return plot;
}

report::Section overview(const ShadowFindings& findings) {
    report::Section section{"Difference against time", {}, {}, {}, {}};
    section.paragraphs.emplace_back(
        "Lower left is better. Each curve varies one setting; the others are the default ones.");
    if (const auto image = report::draw(plot_of(findings), "A point a setting of the tables."))
        section.images.push_back(*image);
    else
        section.paragraphs.emplace_back(
            "gnuplot is not installed or failed, so the plot is missing (Debian package "
            "gnuplot-nox).");
    return section;
}

report::Section sweep(const ShadowFindings& findings, const ShadowSweepText& text) {
    report::Section section{text.title, {text.explanation}, {}, {}, {}};
    report::Table table{"Each setting's difference and time",
                        {text.setting, "mean Lab difference", "maps", "light", "memory of maps"},
                        {}};
    for (const ShadowResult& result : findings.results)
        if (result.sweep == text.sweep)
            table.rows.push_back({result.setting, fmt::format("{:.3g}", result.lab),
                                  ms(result.maps_s), ms(result.light_s),
                                  fmt::format("{:.3g} MB", 1e-6 * result.bytes)});
    section.tables.push_back(std::move(table));
    return section;
}

}  // namespace

std::string as_json(const ShadowFindings& findings, const ShadowSetup& setup) {
    nlohmann::ordered_json json = {{"kind", "shadows"},
                                   {"program", program_version()},
                                   {"command", setup.command_line},
                                   {"machine", setup.machine},
                                   {"device", findings.device},
                                   {"scene", setup.scene},
                                   {"camera", findings.camera},
                                   {"width", findings.size_px.x},
                                   {"height", findings.size_px.y},
                                   {"samples", findings.samples},
                                   {"lab_noise", findings.lab_noise},
                                   {"lab_without_shadows", findings.lab_without},
                                   {"light_without_shadows_s", findings.light_without_s},
                                   {"traced_s", findings.traced_s},
                                   {"time_s", findings.time_s},
                                   {"results", nlohmann::ordered_json::array()}};
    for (const ShadowResult& result : findings.results)
        json["results"].push_back({{"sweep", result.sweep},
                                   {"setting", result.setting},
                                   {"maps", result.options.maps},
                                   {"map_px", result.options.map_px},
                                   {"pcf_taps", result.options.pcf_taps},
                                   {"lab", result.lab},
                                   {"maps_s", result.maps_s},
                                   {"light_s", result.light_s},
                                   {"bytes", result.bytes}});
    return json.dump(1) + "\n";
}

void write_page(const ShadowFindings& findings, const ShadowSetup& setup, const std::string& path) {
    report::Page page;
    page.title = "What shadow maps cost and lose";
    page.summary =
        "Shadows of near-field lamps by maps against rays. Made by " + program_version() + ".";
    page.sections = {what_this_is(findings, setup), overview(findings)};
    for (const ShadowSweepText& text : kSweeps)
        page.sections.push_back(sweep(findings, text));
    report::Section provenance{"Machine and command", {}, {}, {}, {}};
    provenance.preformatted =
        fmt::format("{}\n{}\n{}, {}\n{:.0f} s in all\n", setup.command_line, program_version(),
                    setup.machine, findings.device, findings.time_s);
    page.sections.push_back(provenance);
    report::write_page(page, path);
}

}  // namespace nearfield::bench
