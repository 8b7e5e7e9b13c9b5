// SPDX-License-Identifier: Apache-2.0
#include "app/bench/page_plots.h"
#include "app/bench/papers_text.h"
#include "app/bench/summary.h"
#include "formats/files/provenance.h"
#include "formats/report/plot.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::bench {
namespace {

std::string text_or_empty(const std::optional<double>& value, const char* format) {
    return value ? fmt::format(fmt::runtime(format), *value) : std::string();
}

std::string percent_or_empty(const std::optional<double>& value) {
    return value ? percent_text(*value) : std::string();
}

std::string megabytes(const std::optional<double>& value) {
    return value ? fmt::format("{:.3g} MB", 1e-6 * *value) : std::string();
}

std::string pixel_time(const PapersRow& row) {
    const double pixels = static_cast<double>(row.size_px.x) * row.size_px.y;
    return row.time_s && pixels > 0.0 ? time_text(1e6 * *row.time_s / pixels) : std::string();
}

struct PapersColumn {
    const char* title;
    std::string (*text)(const PapersRow&);
};

const std::vector<PapersColumn>& papers_columns() {
    static const std::vector<PapersColumn> columns = {
        {"lamp", [](const PapersRow& row) { return row.lamp; }},
        {"camera", [](const PapersRow& row) { return row.view; }},
        {"device", [](const PapersRow& row) { return row.device; }},
        {"method", [](const PapersRow& row) { return row.method; }},
        {"setting", [](const PapersRow& row) { return row.setting; }},
        {"K",
         [](const PapersRow& row) {
             return row.samples > 0 ? fmt::format("{}", row.samples) : "";
         }},
        {"pixels",
         [](const PapersRow& row) {
             return row.size_px.x > 0 ? fmt::format("{} x {}", row.size_px.x, row.size_px.y) : "";
         }},
        {"time",
         [](const PapersRow& row) { return row.time_s ? time_text(1e6 * *row.time_s) : ""; }},
        {"a pixel", pixel_time},
        {"share", [](const PapersRow& row) { return percent_or_empty(row.share); }},
        {"mean Lab", [](const PapersRow& row) { return text_or_empty(row.lab, "{:.3g}"); }},
        {"RMS error", [](const PapersRow& row) { return percent_or_empty(row.rms_rel); }},
        {"95 % below", [](const PapersRow& row) { return percent_or_empty(row.p95_rel); }},
        {"largest", [](const PapersRow& row) { return percent_or_empty(row.largest_rel); }},
        {"memory", [](const PapersRow& row) { return megabytes(row.bytes); }},
        {"the paper", [](const PapersRow& row) { return stated(row); }},
    };
    return columns;
}

// Columns in which every row has the same or nothing are left out; the same is said once.
report::Table papers_table(const std::vector<const PapersRow*>& rows) {
    report::Table table;
    table.rows.resize(rows.size());
    for (const PapersColumn& column : papers_columns()) {
        std::vector<std::string> cells;
        cells.reserve(rows.size());
        for (const PapersRow* row : rows)
            cells.push_back(column.text(*row));
        const bool is_same = std::all_of(cells.begin(), cells.end(),
                                         [&](const std::string& cell) { return cell == cells[0]; });
        if (is_same && rows.size() > 1) {
            if (!cells[0].empty())
                table.caption += fmt::format("{}{}: {}", table.caption.empty() ? "" : ", ",
                                             column.title, cells[0]);
            continue;
        }
        table.columns.emplace_back(column.title);
        for (std::size_t k = 0; k < rows.size(); ++k)
            table.rows[k].push_back(std::move(cells[k]));
    }
    return table;
}

// Lab difference against time, a curve a sampler.
std::optional<report::Image> samplers_plot(const PapersFindings& findings) {
    report::Plot plot;
    plot.title = "Difference against time";
    plot.x_label = "time of a frame, ms";
    plot.y_label = "mean Lab difference";
    plot.log_x = plot.log_y = true;
    std::vector<std::string> methods;
    for (const PapersRow* row : rows_of(findings, "all"))
        if (std::find(methods.begin(), methods.end(), row->method) == methods.end())
            methods.push_back(row->method);
    for (const std::string& method : methods) {
        report::Curve curve;
        curve.name = method;
        curve.marks = report::Marks::Dots;
        for (const PapersRow* row : rows_of(findings, "all", "", method)) {
            curve.x.push_back(1e3 * *row->time_s);
            curve.y.push_back(*row->lab);
        }
        plot.curves.push_back(std::move(curve));
    }
    return report::draw(
        plot, "Lower left is better. Samplers with K = 12, 50, 200, 800; the sum is one point.");
}

std::string size_text(glm::ivec2 size) {
    return fmt::format("{} x {}", size.x, size.y);
}

report::Section papers_introduction(const PapersFindings& findings, const PapersSetup& setup) {
    report::Section section{"What was measured", {}, {}, {}, {}};
    section.paragraphs = {
        "Figures and numbers of Lu, Pacanowski and Granier, \"Position-dependent importance "
        "sampling of light field luminaires\" (2015), measured again. The paper's lamps are not "
        "to be had: this project's synthetic headlight stands in, as light fields of the same "
        "numbers of images, texels and the same bases. So numbers stand beside the paper's, but "
        "are not of the same light, scene or machine; ratios within a table are what to compare. "
        "The paper: 1024 x 768 pixels, a GTX 580 on an Intel Core i7 920.",
        fmt::format(
            "Machine: {}; OpenGL: {}. Samplers are measured on {} (figures 8 and 11: {}) pixels "
            "of the demo's road, white and matt, one lamp, no shadows, by all threads of the CPU; "
            "their light against the exact sum in double at the same points. Whole frames are of "
            "{} pixels. Times are the best of two frames, those of renderers of one.",
            setup.machine,
            findings.gl_device.empty() ? "none (" + findings.gl_missing + ")" : findings.gl_device,
            size_text(findings.size_px), size_text(findings.small_px),
            size_text(findings.render_px)),
        "Lab: the mean color difference (CIELAB, 1976) over lit pixels, after the paper's tone "
        "mapping 1 - exp(-L / mean). Errors in percent: relative to the exact light, over pixels "
        "brighter than a thousandth of the brightest. uniform, precomputed and pdis are as "
        "published, with the same Halton points in every pixel (section 6.3); systematic, cells "
        "and sum are this project's."};
    if (setup.quick)
        section.paragraphs.emplace_back(
            "This is a quick run on small lamps and frames: its numbers show that everything runs, "
            "and nothing else.");
    report::Table lamps{
        "The lamps: one headlight, planes 0.5 m apart. Window: what a basis "
        "function shows of its image to a distant point, texels",
        {"name", "the paper's", "images", "texels", "basis", "pitch", "window"},
        {}};
    for (const PapersLamp& lamp : findings.lamps) {
        const Slab& slab = lamp.lightfield.slabs.front();
        const glm::dvec2 window =
            static_cast<double>(slab.profile.cells.size()) * slab.pitch_m / slab.texel_m();
        lamps.rows.push_back(
            {lamp.name, lamp.paper, size_text(slab.grid), size_text(slab.texels), slab.profile.name,
             fmt::format("{:.3g} x {:.3g} mm", 1e3 * slab.pitch_m.x, 1e3 * slab.pitch_m.y),
             fmt::format("{:.0f} x {:.0f}", window.x, window.y)});
    }
    section.tables.push_back(std::move(lamps));
    return section;
}

report::Section papers_section(const PapersFindings& findings, const FigureText& text) {
    report::Section section{text.title, {}, {}, {}, {}};
    section.columns = 2;
    section.paragraphs = {std::string("The paper: ") + text.paper,
                          std::string("Here: ") + text.here};
    std::string follows = "What follows:";
    for (const std::string& sentence : conclusions(findings, text.figure))
        follows += " " + sentence;
    section.paragraphs.push_back(follows);
    const std::string figure = text.figure;
    if (figure == "all")
        if (auto plot = samplers_plot(findings))
            section.images.push_back(std::move(*plot));
    for (const PapersPicture& picture : findings.pictures)
        if (picture.figure == figure)
            section.images.push_back(picture.image);
    const std::vector<const PapersRow*> rows = rows_of(findings, figure);
    if (!rows.empty())
        section.tables.push_back(papers_table(rows));
    return section;
}

std::string csv_number(const std::optional<double>& value) {
    return value ? fmt::format("{:.9g}", *value) : std::string();
}

// Names of devices hold commas.
std::string csv_text(const std::string& text) {
    return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

}  // namespace

std::string as_csv(const PapersFindings& findings) {
    std::string csv =
        "figure,lamp,view,device,method,setting,samples,width,height,time_s,lab,rms_rel,p95_rel,"
        "max_rel,share,bytes\n";
    for (const PapersRow& row : findings.rows)
        csv +=
            fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", row.figure, row.lamp,
                        row.view, csv_text(row.device), row.method, csv_text(row.setting),
                        row.samples, row.size_px.x, row.size_px.y, csv_number(row.time_s),
                        csv_number(row.lab), csv_number(row.rms_rel), csv_number(row.p95_rel),
                        csv_number(row.largest_rel), csv_number(row.share), csv_number(row.bytes));
    return csv;
}

void write_page(const PapersFindings& findings, const PapersSetup& setup, const std::string& path) {
    report::Page page;
    page.title = "A paper's figures, measured again";
    page.summary =
        "Position-dependent importance sampling of light field luminaires (2015) on this "
        "machine. Made by " +
        program_version() + ".";
    page.sections.push_back(papers_introduction(findings, setup));
    for (const FigureText& text : figure_texts())
        page.sections.push_back(papers_section(findings, text));
    report::Section provenance{"Machine and command", {}, {}, {}, {}};
    provenance.preformatted = fmt::format(
        "{}\n{}\n{}, {}\n{:.0f} s in all\n", setup.command_line, program_version(), setup.machine,
        findings.gl_device.empty() ? "no OpenGL" : findings.gl_device, findings.time_s);
    page.sections.push_back(provenance);
    report::write_page(page, path);
}

}  // namespace nearfield::bench
