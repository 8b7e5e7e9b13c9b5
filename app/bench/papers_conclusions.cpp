// SPDX-License-Identifier: Apache-2.0
#include "app/bench/papers_text.h"
#include "app/bench/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

namespace nearfield::bench {
namespace {

using Sentences = std::vector<std::string>;

// The first row of a figure that has these; empty: any. None where it was not measured.
const PapersRow* find_row(const PapersFindings& findings,
                          const std::string& figure,
                          const std::string& method,
                          const std::string& setting,
                          const std::string& view = "") {
    for (const PapersRow* row : rows_of(findings, figure, "", method))
        if ((setting.empty() || row->setting == setting) && (view.empty() || row->view == view))
            return row;
    return nullptr;
}

std::string lab_text(const PapersRow& row) {
    return fmt::format("{:.3g}", row.lab.value_or(0.0));
}

std::string frame_text(const PapersRow& row) {
    return time_text(1e6 * row.time_s.value_or(0.0));
}

double ratio(std::optional<double> a, std::optional<double> b) {
    return a && b && *b > 0.0 ? *a / *b : 0.0;
}

Sentences on_search(const PapersFindings& findings) {
    const PapersRow* secant = find_row(findings, "5", "pdis", "secant, depth 3");
    const PapersRow* bisection = find_row(findings, "5", "pdis", "bisection, depth 3");
    const PapersRow* whole = find_row(findings, "5", "pdis", "bisection, to the end");
    return {
        fmt::format("At depth 3 the secant search is at {} Lab and bisection at {}; searched "
                    "to the end bisection is at {} in {:.2f} times its time at depth 3.",
                    lab_text(*secant), lab_text(*bisection), lab_text(*whole),
                    ratio(whole->time_s, bisection->time_s))};
}

Sentences on_shadows(const PapersFindings& findings) {
    const PapersRow* paper = find_row(findings, "7", "eye", "paper");
    const PapersRow* cell = find_row(findings, "7", "eye", "cell");
    if (paper == nullptr)
        return {"Not measured: there is no OpenGL context (" + findings.gl_missing + ")."};
    return {fmt::format(
        "Maps from the paper's positions on S differ from rays by {} Lab, from the cells' middles "
        "on U by {}: {:.2g} times nearer. Without any shadows the difference is {}; two traced "
        "pictures with other random numbers are {} apart.",
        lab_text(*paper), lab_text(*cell), ratio(paper->lab, cell->lab),
        lab_text(*find_row(findings, "7", "none", "")),
        lab_text(*find_row(findings, "7", "rays", "")))};
}

Sentences on_sequences(const PapersFindings& findings) {
    Sentences sentences;
    for (const PapersRow* halton : rows_of(findings, "8", "", "systematic"))
        if (halton->setting == "halton")
            for (const PapersRow* independent : rows_of(findings, "8", "", "systematic"))
                if (independent->setting == "independent" &&
                    independent->samples == halton->samples)
                    sentences.push_back(fmt::format(
                        "K = {}: independent samples are at {} Lab, Halton's at {}: {:.2g} times "
                        "nearer.",
                        halton->samples, lab_text(*independent), lab_text(*halton),
                        ratio(independent->lab, halton->lab)));
    return sentences;
}

Sentences on_k_max(const PapersFindings& findings) {
    const PapersRow* without = find_row(findings, "9", "pdis", "no limit");
    const PapersRow* with = find_row(findings, "9", "pdis", "K_max 7");
    return {
        fmt::format("The limit takes {:.2f} of the time ({:.2f} in the paper) and moves the "
                    "frame by {} Lab; against exact light it goes from {} to {}.",
                    ratio(with->time_s, without->time_s), 11.6 / 13.5,
                    lab_text(*find_row(findings, "9", "pdis", "between the two")),
                    lab_text(*without), lab_text(*with))};
}

Sentences on_passes(const PapersFindings& findings) {
    std::map<std::string, std::string> frames;  // device, method: its passes in words
    for (const PapersRow* row : rows_of(findings, "10")) {
        std::string& text = frames[row->method + " on " + row->device];
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", row->setting,
                            percent_text(row->share.value_or(0.0)));
    }
    Sentences sentences;
    for (const auto& [name, text] : frames)
        sentences.push_back(fmt::format("{}: {}.", name, text));
    return sentences;
}

Sentences on_precomputed(const PapersFindings& findings) {
    const PapersRow* precomputed = find_row(findings, "11", "precomputed", "");
    const PapersRow* pdis = find_row(findings, "11", "pdis", "K = 63");
    const PapersRow* sum = find_row(findings, "11", "sum", "");
    return {fmt::format(
        "pdis with 63 samples is at {} Lab in {}; {} precomputed samples are at {} in {} ({:.0f} "
        "times as long). The exact sum takes {}, {:.2g} times as long as the 63 samples.",
        lab_text(*pdis), frame_text(*pdis), precomputed->samples, lab_text(*precomputed),
        frame_text(*precomputed), ratio(precomputed->time_s, pdis->time_s), frame_text(*sum),
        ratio(sum->time_s, pdis->time_s))};
}

Sentences on_uniform(const PapersFindings& findings) {
    const PapersRow* pdis = find_row(findings, "12", "pdis", "K = 252");
    const PapersRow* uniform = find_row(findings, "12", "uniform", "K = 252");
    const PapersRow* more = find_row(findings, "12", "uniform", "K = 1008");
    const PapersRow* systematic = find_row(findings, "12", "systematic", "K = 252");
    return {fmt::format(
        "With 252 samples uniform is at {:.2f} times the Lab difference of pdis (2.4 in the "
        "paper) in {:.2f} of its time ({:.2f}); with 1008 at {:.2f} times, in {:.2f} of its time "
        "({:.2f}). systematic is at {:.2f} times, in {:.2f} of its time.",
        ratio(uniform->lab, pdis->lab), ratio(uniform->time_s, pdis->time_s), 84.0 / 118.0,
        ratio(more->lab, pdis->lab), ratio(more->time_s, pdis->time_s), 201.0 / 118.0,
        ratio(systematic->lab, pdis->lab), ratio(systematic->time_s, pdis->time_s))};
}

Sentences on_convergence(const PapersFindings& findings) {
    Sentences sentences;
    for (const char* view : {"driver", "bird"})
        for (const char* method : {"pdis", "systematic"}) {
            const PapersRow* few = find_row(findings, "13", method, "K = 100", view);
            const PapersRow* many = find_row(findings, "13", method, "K = 400", view);
            sentences.push_back(fmt::format(
                "Camera {}, {}: four times as many samples divide the difference by {:.2f} ({} to "
                "{} Lab).{}",
                view, method, ratio(few->lab, many->lab), lab_text(*few), lab_text(*many),
                std::string(method) == "pdis"
                    ? fmt::format(" The paper's: by {:.2f}.",
                                  std::string(view) == "driver" ? 1.12 / 0.53 : 0.81 / 0.36)
                    : std::string()));
        }
    return sentences;
}

Sentences on_samplers(const PapersFindings& findings) {
    Sentences sentences;
    const PapersRow* sum = find_row(findings, "all", "sum", "exact");
    std::vector<const PapersRow*> rows;
    for (const PapersRow* row : rows_of(findings, "all"))
        if (row->samples == 200)
            rows.push_back(row);
    std::sort(rows.begin(), rows.end(),
              [](const PapersRow* a, const PapersRow* b) { return *a->lab < *b->lab; });
    std::string order;
    for (const PapersRow* row : rows)
        order += fmt::format("{}{} {} Lab in {}", order.empty() ? "" : ", ", row->method,
                             lab_text(*row), frame_text(*row));
    sentences.push_back(fmt::format("With 200 samples: {}. The exact sum: {} Lab in {}.", order,
                                    lab_text(*sum), frame_text(*sum)));
    sentences.push_back(fmt::format(
        "References here are exact: the frame's light in double takes {:.3g} s on this machine; "
        "the paper's reference of 63 M samples (figure 11) took 12 hours.",
        findings.exact_s));
    return sentences;
}

Sentences on_frames(const PapersFindings& findings) {
    Sentences sentences = {"Two lamps of 11 x 9 images:"};
    for (const PapersRow* row : rows_of(findings, "2", "2 x 11x9")) {
        const auto pixels = static_cast<double>(row->size_px.x * row->size_px.y);
        sentences.push_back(fmt::format("{} on {}, {} x {} pixels: {}, {} a pixel.", row->method,
                                        row->device, row->size_px.x, row->size_px.y,
                                        frame_text(*row), time_text(1e6 * *row->time_s / pixels)));
    }
    constexpr double kPaper_s = 1.0 / 9.0, kPaper_px = 1024.0 * 768.0;
    sentences.push_back(fmt::format("The paper's 9 fps on a GTX 580: {} a pixel.",
                                    time_text(1e6 * kPaper_s / kPaper_px)));
    return sentences;
}

Sentences on_tables(const PapersFindings& findings) {
    Sentences sentences;
    const std::map<std::string, double> paper_s = {
        {"bike", 0.513}, {"car1", 0.129}, {"car2", 0.527}};
    for (const PapersLamp& lamp : findings.lamps)
        sentences.push_back(fmt::format("{}: {} here, {:.2g} of the paper's time for {}.",
                                        lamp.name, time_text(1e6 * lamp.tables_s),
                                        lamp.tables_s / paper_s.at(lamp.paper), lamp.paper));
    return sentences;
}

}  // namespace

std::vector<std::string> conclusions(const PapersFindings& findings, const std::string& figure) {
    const std::map<std::string, std::function<Sentences(const PapersFindings&)>> all = {
        {"tables", on_tables}, {"2", on_frames},       {"5", on_search},    {"7", on_shadows},
        {"8", on_sequences},   {"9", on_k_max},        {"10", on_passes},   {"11", on_precomputed},
        {"12", on_uniform},    {"13", on_convergence}, {"all", on_samplers}};
    return all.at(figure)(findings);
}

}  // namespace nearfield::bench
