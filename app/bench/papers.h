// SPDX-License-Identifier: Apache-2.0
/// What `bench papers` measures: figures 5, 7 to 13 and the numbers in the text of a published
/// paper, again, on lamps of the same sizes.
///
/// Source  Lu, Pacanowski, Granier, "Position-dependent importance sampling of light field
///         luminaires", 2015 ("PDIS").
#pragma once

#include "app/bench/papers_scene.h"
#include "formats/report/page.h"

#include <glm/glm.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::bench {

struct PapersOptions {
    std::string folder;  // made where it does not exist; files of other names stay
    bool quick = false;  // smaller lamps and pictures: seconds, and no conclusions
    int frame_px = 0;    // width of samplers' frames, 4 : 3; 0: 240, quick 32. Others follow
};

/// One measured setting. What was not measured is empty.
struct PapersRow {
    std::string figure;  // "5", "7" ... "13", "2" (frame rates), "all" (samplers), "tables"
    std::string lamp;    // "9x7", "5x5", "11x9"
    std::string view;    // camera
    std::string device;  // "CPU", or what OpenGL calls it
    std::string method;  // sampler or pass
    std::string setting;
    int samples = 0;  // of a pixel and lamp; 0: none, exact
    glm::ivec2 size_px{0};
    std::optional<double> time_s;                         // of a frame, best of several; all cores
    std::optional<double> lab;                            // mean difference: render::lab_difference
    std::optional<double> rms_rel, p95_rel, largest_rel;  // render::RelativeError
    std::optional<double> share;                          // of the frame's time
    std::optional<double> bytes;
};

/// A picture of a figure; `file` is its name in the folder.
struct PapersPicture {
    std::string figure, file;
    report::Image image;
};

struct PapersFindings {
    std::vector<PapersLamp> lamps;
    std::vector<PapersRow> rows;
    std::vector<PapersPicture> pictures;
    glm::ivec2 size_px{0}, small_px{0}, render_px{0};
    std::string gl_device;  // empty: no OpenGL context, and gl_missing says why
    std::string gl_missing;
    double exact_s = 0;  // the exact light of the main view in double: what errors are against
    double time_s = 0;
};

/// Called with what is being measured and how far all is.
using PapersProgress = std::function<void(const std::string& what, double fraction)>;

/// Writes the lamps' light fields, scenes and pictures into the folder as it goes. Throws Error
/// where a file cannot be written.
PapersFindings run_papers(const PapersOptions& options, const PapersProgress& progress);

/// How a run was made, for the reader of the files.
struct PapersSetup {
    std::string command_line;
    std::string machine;  // CPU and cores
    bool quick = false;
};

/// One line a row, all figures.
std::string as_csv(const PapersFindings& findings);

/// One self-contained page, without scripts.
void write_page(const PapersFindings& findings, const PapersSetup& setup, const std::string& path);

/// Rows of a figure in order; lamp and method empty: of all.
std::vector<const PapersRow*> rows_of(const PapersFindings& findings,
                                      const std::string& figure,
                                      const std::string& lamp = "",
                                      const std::string& method = "");

}  // namespace nearfield::bench
