// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

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

bool has_study(const EnvironmentFindings& findings, const std::string& study) {
    return std::any_of(findings.rows.begin(), findings.rows.end(),
                       [&](const EnvironmentRow& row) { return row.study == study; });
}

/// What as many samples as an error calls for gain: the error of a fixed number of about as many
/// (the nearest above), beside it.
std::string of_counts(const EnvironmentFindings& findings,
                      const std::string& study,
                      const std::string& subject) {
    std::string text;
    for (const EnvironmentRow& row : findings.rows) {
        if (row.study != study || row.subject != subject ||
            row.method != "fis, suns apart, by error")
            continue;
        const EnvironmentRow* fixed = nullptr;
        for (const EnvironmentRow& one : findings.rows)
            if (one.study == study && one.subject == subject && one.method == "fis, suns apart" &&
                one.samples >= row.samples && (fixed == nullptr || one.samples < fixed->samples))
                fixed = &one;
        if (fixed != nullptr)
            text +=
                fmt::format("{}{} on the mean {:.3g} % (Lab {:.2g}), fixed {} {:.3g} % ({:.2g})",
                            text.empty() ? "" : "; ", row.samples, 100.0 * row.rms, row.lab,
                            fixed->samples, 100.0 * fixed->rms, fixed->lab);
    }
    return text.empty() ? ""
                        : fmt::format("By error, {}, {}, relative RMS: {}.", study, subject, text);
}

/// Light and sparks of small suns, worst of all.
std::string of_suns(const EnvironmentFindings& findings, const std::string& method) {
    double most = 0.0, spark = 0.0;
    for (const EnvironmentRow& row : findings.rows)
        if (row.study == "suns" && row.method == method) {
            most = std::max(most, std::abs(row.bias));
            spark = std::max(spark, row.spark);
        }
    return fmt::format(
        "Small suns, {}: light off by up to {:.2g} %, sparks of up to {:.2g} of the "
        "mean.",
        method, 100.0 * most, spark);
}

std::string of_maps(const EnvironmentFindings& findings) {
    std::string text;
    for (const MapRow& row : findings.maps)
        text += fmt::format("{}{} at {:g} sr: error {:.2g}, jumps {:.2g} (largest {:.2g})",
                            text.empty() ? "" : "; ", row.map, row.solid_angle_sr, row.error_rms,
                            row.jump_rms, row.jump_most);
    return "Filtered lookups, over the mean: " + text + ".";
}

}  // namespace

std::vector<std::string> conclusions(const EnvironmentFindings& findings) {
    std::vector<std::string> sentences;
    for (const char* method : {"fis", "fis, suns apart", "mfis, suns apart"})
        for (const Metric& metric : kMetrics)
            if (has_study(findings, "sphere"))
                sentences.push_back(against_lamps(findings, method, metric));
    for (const char* method : {"fis", "fis, suns apart", "mfis", "mfis, suns apart", "far lamps"})
        if (const std::string text = at_fifty(findings, method); !text.empty())
            sentences.push_back(text);
    std::vector<std::pair<std::string, std::string>> subjects;
    for (const EnvironmentRow& row : findings.rows)
        if (subjects.empty() || subjects.back() != std::pair(row.study, row.subject))
            subjects.emplace_back(row.study, row.subject);
    for (const auto& [study, subject] : subjects)
        if (const std::string text = of_counts(findings, study, subject); !text.empty())
            sentences.push_back(text);
    if (has_study(findings, "suns"))
        for (const char* method : {"fis", "fis, suns apart", "unfiltered", "far lamps"})
            sentences.push_back(of_suns(findings, method));
    if (!findings.maps.empty())
        sentences.push_back(of_maps(findings));
    if (has_study(findings, "visibility"))
        sentences.push_back(of_visibility(findings));
    return sentences;
}

}  // namespace nearfield::bench
