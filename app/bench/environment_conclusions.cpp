// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace nearfield::bench {
namespace {

struct Metric {
    const char* name;
    double EnvironmentRow::*value;
};

constexpr Metric kMetrics[] = {{"relative RMS", &EnvironmentRow::rms},
                               {"RMS over the mean", &EnvironmentRow::rms_mean},
                               {"RMS as displayed", &EnvironmentRow::rms_toned},
                               {"Lab", &EnvironmentRow::lab}};

const EnvironmentRow* find(const EnvironmentFindings& findings,
                           const std::string& study,
                           const std::string& subject,
                           const std::string& method,
                           int samples) {
    const auto row = std::find_if(findings.rows.begin(), findings.rows.end(), [&](const auto& one) {
        return one.study == study && one.subject == subject && one.method == method &&
               one.samples == samples;
    });
    return row == findings.rows.end() ? nullptr : &*row;
}

/// Where a method is not better than far lamps on the sphere, of exponents of 20 and more.
std::string against_lamps(const EnvironmentFindings& findings,
                          const std::string& method,
                          const Metric& metric) {
    std::string exceptions;
    int all = 0, lost = 0;
    for (const EnvironmentRow& row : findings.rows) {
        if (row.study != "sphere" || row.method != method || row.subject == "exponent 5")
            continue;
        const EnvironmentRow* lamps =
            find(findings, "sphere", row.subject, "far lamps", row.samples);
        ++all;
        if (lamps == nullptr || row.*metric.value < lamps->*metric.value)
            continue;
        ++lost;
        exceptions +=
            fmt::format("{}{}, N = {} ({:.2g} against {:.2g})", exceptions.empty() ? "" : "; ",
                        row.subject, row.samples, row.*metric.value, lamps->*metric.value);
    }
    return fmt::format(
        "{}, {}: better than as many far lamps in {} of {} settings of exponents 20 and more{}",
        method, metric.name, all - lost, all,
        exceptions.empty() ? "." : ", not at " + exceptions + ".");
}

std::string at_fifty(const EnvironmentFindings& findings, const std::string& method) {
    std::string text;
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == "sphere" && row.method == method && row.samples == 50)
            text += fmt::format("{}{}: {:.3g} %, {:.3g} %, {:.3g} %", text.empty() ? "" : "; ",
                                row.subject, 100.0 * row.rms, 100.0 * row.rms_mean,
                                100.0 * row.rms_toned);
    return text.empty()
               ? ""
               : fmt::format("{} at N = 50, relative RMS, over the mean, as displayed: {}.", method,
                             text);
}

std::string of_visibility(const EnvironmentFindings& findings) {
    std::string text;
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == "visibility")
            text += fmt::format("{}{} {}: {:.3g}", text.empty() ? "" : ", ", row.method,
                                row.samples, row.lab);
    return "Shadows, Lab difference to traced ones: " + text + ".";
}

}  // namespace

std::vector<std::string> conclusions(const EnvironmentFindings& findings) {
    std::vector<std::string> sentences;
    for (const char* method : {"fis", "fis, suns apart", "mfis, suns apart"})
        for (const Metric& metric : kMetrics)
            sentences.push_back(against_lamps(findings, method, metric));
    for (const char* method : {"fis", "fis, suns apart", "mfis", "mfis, suns apart", "far lamps"})
        if (const std::string text = at_fifty(findings, method); !text.empty())
            sentences.push_back(text);
    sentences.push_back(of_visibility(findings));
    return sentences;
}

}  // namespace nearfield::bench
