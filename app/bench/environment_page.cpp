// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment.h"
#include "formats/files/provenance.h"
#include "formats/report/page.h"
#include "formats/report/plot.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace nearfield::bench {
namespace {

struct StudyText {
    const char *study, *title, *paper, *here;
};

constexpr StudyText kStudies[] = {
    {"sphere", "Error against samples, on a sphere",
     "\"While both methods converge at a rate of N^-1/2, filtered BRDF IS has a lower RMS overall, "
     "especially on more glossy materials.\" \"The proposed filtering affords using only a small "
     "number of samples (40-50 in practice) for visually and numerically acceptable results.\" Of "
     "few samples and low-frequency BRDFs \"environment map importance sampling provides more "
     "pleasing images\" (sphere under Grace, 2008). How its RMS is defined it does not say.",
     "A ball of Phong's lobe. fis: the paper's; suns apart: small bright parts are summed one by "
     "one beside N samples, up to 32; gems: one level more, after its own clamp (2007); mfis: "
     "level by the "
     "density's mean over what a sample stands for (Tokuyoshi 2016); far lamps: "
     "N directions by luminance. No shadows."},
    {"mesh", "The same on an uneven surface",
     "\"On complex geometry, undersampling appears as blurring and dulling of the highlights. "
     "However, visually acceptable results are found around 50 samples per pixel.\" More samples "
     "are required than on the sphere for the same RMS.",
     "The mesh named above."},
    {"anisotropic", "Brushed metal",
     "\"The isotropic filter approximation breaks down when rendering more anisotropic materials\" "
     "(Ward, 0.01 and 0.29). Filters by derivatives are \"almost always worse than with isotropic "
     "filtering, except for highly anisotropic BRDFs\", and ten times slower.",
     "A ball of Ward's lobe, brushed around its axis. Along the longer axis: up to 16 lookups."},
    {"visibility", "Shadows",
     "\"After 16 visibility samples, most of the error originates from the low-pass filter used to "
     "remove the spatial aliasing from the undersampled shadow maps\"; compared with a fit of "
     "10,000 samples, the best that such harmonics can do.",
     "The uneven surface, white and matt, on a floor, against traced samples. rays: the fit of so "
     "many directions by a ray each (the CPU); maps: by orthographic maps of 512 x 512 (OpenGL). "
     "The fit of most rays shows the harmonics' own error, maps less rays the maps'."},
    {"time", "Time on the graphics card against triangles",
     "\"Both times vary close to linearly with respect to the number of samples\" (figure 2).",
     "Least of three: rendering N maps, fitting them pixel by pixel, 40 filtered samples."}};

std::vector<std::string> subjects_of(const EnvironmentFindings& findings,
                                     const std::string& study) {
    std::vector<std::string> subjects;
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == study &&
            std::find(subjects.begin(), subjects.end(), row.subject) == subjects.end())
            subjects.push_back(row.subject);
    return subjects;
}

report::Plot plot_of(const EnvironmentFindings& findings,
                     const std::string& study,
                     const std::string& subject,
                     double EnvironmentRow::*value,
                     const std::string& label) {
    report::Plot plot;
    plot.title = subject;
    plot.x_label = "samples";
    plot.y_label = label;
    plot.log_x = plot.log_y = true;
    for (const EnvironmentRow& row : findings.rows) {
        if (row.study != study || row.subject != subject || row.method == "reference")
            continue;
        auto curve = std::find_if(plot.curves.begin(), plot.curves.end(),
                                  [&](const report::Curve& one) { return one.name == row.method; });
        if (curve == plot.curves.end()) {
            report::Curve added;
            added.name = row.method;
            added.marks = report::Marks::Dots;
            curve = plot.curves.insert(plot.curves.end(), added);
        }
        curve->x.push_back(row.samples);
        curve->y.push_back(row.*value);
    }
    return plot;
}

void add_plots(const EnvironmentFindings& findings,
               const std::string& study,
               report::Section& section) {
    const bool is_time = study == "time";
    for (const std::string& subject : subjects_of(findings, study)) {
        const auto rms =
            report::draw(plot_of(findings, study, subject,
                                 is_time ? &EnvironmentRow::time_s : &EnvironmentRow::rms,
                                 is_time ? "time, s" : "relative RMS"),
                         study + ", " + subject);
        if (rms)
            section.images.push_back(*rms);
        if (is_time)
            continue;
        const auto lab = report::draw(
            plot_of(findings, study, subject, &EnvironmentRow::lab, "mean Lab difference"),
            study + ", " + subject + ", Lab");
        if (lab)
            section.images.push_back(*lab);
    }
    section.columns = 2;
    if (section.images.empty())
        section.paragraphs.emplace_back(
            "gnuplot is not installed or failed, so plots are missing (Debian package "
            "gnuplot-nox).");
}

report::Section study_section(const EnvironmentFindings& findings, const StudyText& text) {
    report::Section section{text.title, {}, {}, {}, {}};
    section.paragraphs = {std::string("The paper: ") + text.paper,
                          std::string("Here: ") + text.here};
    add_plots(findings, text.study, section);
    report::Table table{"Errors against the traced reference",
                        {"", "method", "N", "relative RMS", "RMS over the mean", "RMS as displayed",
                         "mean Lab difference", "light too much", "time"},
                        {}};
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == text.study)
            table.rows.push_back(
                {row.subject, row.method, fmt::format("{}", row.samples),
                 fmt::format("{:.3g}", row.rms), fmt::format("{:.3g}", row.rms_mean),
                 fmt::format("{:.3g}", row.rms_toned), fmt::format("{:.3g}", row.lab),
                 fmt::format("{:.2g} %", 100.0 * row.bias),
                 fmt::format("{:.3g} ms", 1e3 * row.time_s)});
    section.tables.push_back(std::move(table));
    return section;
}

}  // namespace

std::string as_csv(const EnvironmentFindings& findings) {
    std::string text = "study,subject,method,samples,rms,rms_mean,rms_toned,lab,bias,time_s\n";
    for (const EnvironmentRow& row : findings.rows)
        text += fmt::format("{},\"{}\",\"{}\",{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n",
                            row.study, row.subject, row.method, row.samples, row.rms, row.rms_mean,
                            row.rms_toned, row.lab, row.bias, row.time_s);
    return text;
}

std::string as_json(const EnvironmentFindings& findings, const EnvironmentSetup& setup) {
    nlohmann::ordered_json json = {{"kind", "environment"},
                                   {"program", program_version()},
                                   {"command", setup.command_line},
                                   {"machine", setup.machine},
                                   {"device", findings.device},
                                   {"picture", findings.picture},
                                   {"mesh", findings.mesh},
                                   {"quick", setup.quick},
                                   {"frame_px", findings.frame_px},
                                   {"reference_samples", findings.reference_samples},
                                   {"time_s", findings.time_s},
                                   {"conclusions", conclusions(findings)},
                                   {"results", nlohmann::ordered_json::array()}};
    for (const EnvironmentRow& row : findings.rows)
        json["results"].push_back({{"study", row.study},
                                   {"subject", row.subject},
                                   {"method", row.method},
                                   {"samples", row.samples},
                                   {"rms", row.rms},
                                   {"rms_mean", row.rms_mean},
                                   {"rms_toned", row.rms_toned},
                                   {"lab", row.lab},
                                   {"bias", row.bias},
                                   {"time_s", row.time_s}});
    return json.dump(1) + "\n";
}

void write_page(const EnvironmentFindings& findings,
                const EnvironmentSetup& setup,
                const std::string& path) {
    report::Page page;
    page.title = "What light from the environment costs and loses";
    page.summary =
        "Filtered samples, far lamps and fitted shadows against traced samples. Made by " +
        program_version() + ".";
    report::Section what{"What was measured", {}, {}, {}, {}};
    what.paragraphs = {
        fmt::format(
            "Light of {} on a ball and on {}, {} x {} pixels, against {} samples of sky and BRDF "
            "each, with a ray where there are shadows. \"reference\": two of those with other "
            "random numbers, so that what is below is noise. The paper: Krivanek and Colbert, "
            "Real-time shading with filtered importance sampling, 2008; what its text states is "
            "quoted, nothing is read off its plots.",
            findings.picture, findings.mesh, findings.frame_px, findings.frame_px,
            findings.reference_samples),
        "Relative RMS: of a/b - 1 where b is above a thousandth of the brightest. RMS over the "
        "mean: of a - b "
        "over b's mean. RMS as displayed: of 1 - exp(-L/mean). Lab: mean CIELAB difference of "
        "that."};
    if (setup.quick)
        what.paragraphs.emplace_back(
            "A quick run: small frames, noisy references, no conclusions.");
    page.sections = {what};
    report::Section claims{"What follows", conclusions(findings), {}, {}, {}};
    page.sections.push_back(claims);
    for (const StudyText& text : kStudies)
        page.sections.push_back(study_section(findings, text));
    report::Section provenance{"Machine and command", {}, {}, {}, {}};
    provenance.preformatted =
        fmt::format("{}\n{}\n{}, {}\n{:.0f} s in all\n", setup.command_line, program_version(),
                    setup.machine, findings.device, findings.time_s);
    page.sections.push_back(provenance);
    report::write_page(page, path);
}

}  // namespace nearfield::bench
