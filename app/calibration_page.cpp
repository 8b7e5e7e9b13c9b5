// SPDX-License-Identifier: Apache-2.0
#include "app/calibration_page.h"

#include <fmt/format.h>

#include <cmath>

namespace nearfield::app {
namespace {

report::Section first_section(const calibrate::Calibration& calibration) {
    report::Section section{"In short", {}, {}, {}, {}};
    if (calibration.flags.empty())
        section.paragraphs.emplace_back("Nothing was found that needs your attention.");
    report::Table flags{"What needs attention", {"what", "what to do"}, {}};
    for (const calibrate::Flag& flag : calibration.flags)
        flags.rows.push_back({flag.what, flag.advice});
    if (!flags.rows.empty())
        section.tables.push_back(std::move(flags));
    report::Table times{"What it took", {"stage", "time, s"}, {}};
    if (calibration.geometry) {
        times.rows.push_back({"finding boards", fmt::format("{:.2f}", calibration.boards_s)});
        times.rows.push_back({"geometry", fmt::format("{:.2f}", calibration.geometry->time_s)});
    }
    if (calibration.radiometry)
        times.rows.push_back({"radiometry", fmt::format("{:.2f}", calibration.radiometry->time_s)});
    section.tables.push_back(std::move(times));
    return section;
}

report::Section more_section(const calibrate::Geometry& geometry) {
    report::Section section{"What more pictures would buy", {}, {}, {}, {}};
    section.paragraphs.emplace_back(
        "Predicted by counting views of one kind twice, without taking them: a column per kind.");
    report::Table table{"Sigma", {"parameter", "now"}, {}};
    for (const calibrate::MoreViews& more : geometry.more_views)
        table.columns.push_back(more.what);
    for (std::size_t k = 0;
         k < geometry.parameters.size() && k < geometry.more_views.front().sigma.size(); ++k) {
        std::vector<std::string> row = {geometry.parameters[k].name,
                                        fmt::format("{:.2g}", geometry.parameters[k].sigma)};
        for (const calibrate::MoreViews& more : geometry.more_views)
            row.push_back(fmt::format("{:.2g}", more.sigma[k]));
        table.rows.push_back(std::move(row));
    }
    section.tables.push_back(std::move(table));
    return section;
}

}  // namespace

void add_drawing(report::Section& section, const std::optional<report::Image>& image) {
    constexpr const char* kNoGnuplot =
        "A drawing is missing here: gnuplot is not installed or failed (Debian package "
        "gnuplot-nox).";
    if (image)
        section.images.push_back(*image);
    else if (section.paragraphs.empty() || section.paragraphs.back() != kNoGnuplot)
        section.paragraphs.emplace_back(kNoGnuplot);
}

report::Table parameter_table(const std::vector<rig::Parameter>& parameters) {
    report::Table table{
        "Value and standard deviation", {"parameter", "value", "sigma", "relative"}, {}};
    for (const rig::Parameter& parameter : parameters)
        table.rows.push_back(
            {parameter.name, fmt::format("{:.7g}", parameter.value),
             fmt::format("{:.2g}", parameter.sigma),
             parameter.value == 0
                 ? ""
                 : fmt::format("{:.1e}", parameter.sigma / std::abs(parameter.value))});
    return table;
}

report::Page calibration_page(const calibrate::Calibration& calibration,
                              const std::string& command) {
    report::Page page{"Calibration", "How well the bench is known, and from what.", {}};
    page.sections.push_back(first_section(calibration));
    const auto add_all = [&page](std::vector<report::Section> sections) {
        for (report::Section& section : sections)
            page.sections.push_back(std::move(section));
    };
    if (calibration.geometry) {
        add_all(geometry_sections(*calibration.geometry));
        if (!calibration.geometry->more_views.empty())
            page.sections.push_back(more_section(*calibration.geometry));
    }
    if (calibration.radiometry)
        add_all(radiometry_sections(*calibration.radiometry));
    page.sections.push_back({"How it was made", {}, {}, {}, command});
    return page;
}

}  // namespace nearfield::app
