// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment_plots.h"

#include "formats/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace nearfield::bench {
namespace {

std::vector<std::string> subjects_of(const EnvironmentFindings& findings,
                                     const std::string& study) {
    std::vector<std::string> subjects;
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == study &&
            std::find(subjects.begin(), subjects.end(), row.subject) == subjects.end())
            subjects.push_back(row.subject);
    return subjects;
}

/// The plot's curve of that name, added if it is not there.
report::Curve& curve_of(report::Plot& plot, const std::string& name) {
    const auto found = std::find_if(plot.curves.begin(), plot.curves.end(),
                                    [&](const report::Curve& one) { return one.name == name; });
    if (found != plot.curves.end())
        return *found;
    report::Curve added;
    added.name = name;
    added.marks = report::Marks::Dots;
    return plot.curves.emplace_back(added);
}

report::Plot logarithmic(const std::string& title, const char* x_label, const char* y_label) {
    report::Plot plot;
    plot.title = title;
    plot.x_label = x_label;
    plot.y_label = y_label;
    plot.log_x = plot.log_y = true;
    return plot;
}

/// One of a subject's numbers over the number of samples, a curve for each method.
report::Plot sample_plot(const EnvironmentFindings& findings,
                         const std::string& study,
                         const std::string& subject,
                         double EnvironmentRow::*value,
                         const char* label) {
    report::Plot plot = logarithmic(subject, "samples", label);
    for (const EnvironmentRow& row : findings.rows) {
        if (row.study != study || row.subject != subject || row.method == "reference")
            continue;
        report::Curve& curve = curve_of(plot, row.method);
        curve.x.push_back(row.samples);
        curve.y.push_back(row.*value);
    }
    return plot;
}

/// Time over triangles, a curve for each number of maps.
report::Plot triangle_plot(const EnvironmentFindings& findings) {
    report::Plot plot = logarithmic("against triangles", "triangles", "time, s");
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == "time") {
            report::Curve& curve = curve_of(plot, fmt::format("{} maps", row.samples));
            curve.x.push_back(std::stod(row.subject));  // "98 triangles"
            curve.y.push_back(row.time_s);
        }
    return plot;
}

}  // namespace

void add_plots(const EnvironmentFindings& findings,
               const std::string& study,
               report::Section& section) {
    const auto add = [&](const report::Plot& plot, const std::string& caption) {
        if (const auto image = report::draw(plot, caption))
            section.images.push_back(*image);
    };
    const std::vector<std::string> subjects = subjects_of(findings, study);
    const bool is_time = study == "time";
    for (const std::string& subject : subjects) {
        const std::string caption = study + ", " + subject;
        if (!is_time) {
            add(sample_plot(findings, study, subject, &EnvironmentRow::rms, "relative RMS"),
                caption);
            add(sample_plot(findings, study, subject, &EnvironmentRow::lab, "mean Lab difference"),
                caption + ", Lab");
        }
        if (is_time || (study == "sphere" && subject == subjects.front()))
            add(sample_plot(findings, study, subject, &EnvironmentRow::time_s, "time, s"),
                caption + ", time");
    }
    if (is_time)
        add(triangle_plot(findings), "time, against triangles");
    section.columns = 2;
    if (section.images.empty())
        section.paragraphs.emplace_back(
            "gnuplot is not installed or failed, so plots are missing (Debian package "
            "gnuplot-nox).");
}

}  // namespace nearfield::bench
