// SPDX-License-Identifier: Apache-2.0
/// The measurements of `bench papers`, figure by figure; each adds its rows and pictures.
#pragma once

#include "app/bench/papers.h"

#include <string>
#include <vector>

namespace nearfield::bench {

/// Lamp of that name ("9x7").
const PapersLamp& lamp_of(const PapersFindings& findings, const std::string& name);

/// Light on white matt surfaces without shadows, by samplers on the CPU.
void measure_search(const PapersOptions& options, PapersFindings& findings);       // figure 5
void measure_sequences(const PapersOptions& options, PapersFindings& findings);    // 8
void measure_k_max(const PapersOptions& options, PapersFindings& findings);        // 9
void measure_precomputed(const PapersOptions& options, PapersFindings& findings);  // 11
void measure_uniform(const PapersOptions& options, PapersFindings& findings);      // 12
void measure_convergence(const PapersOptions& options, PapersFindings& findings);  // 13
void measure_samplers(const PapersOptions& options, PapersFindings& findings);     // all of them

/// Whole frames, by the renderers.
void measure_shadows(const PapersOptions& options, PapersFindings& findings);  // figure 7
void measure_frames(const PapersOptions& options, PapersFindings& findings);   // 2 and 10

/// Luminance of a frame, [row from below][column], as a PNG in the folder, tone mapped as in the
/// paper so that the reference's mean is 1. Returns it for the page.
report::Image write_view(const std::string& path,
                         const std::string& caption,
                         glm::ivec2 size_px,
                         const std::vector<float>& y,
                         const std::vector<float>& reference_y);

/// The relative error of a frame in false color; nothing where gnuplot is missing.
std::optional<report::Image> draw_error(const std::string& title,
                                        glm::ivec2 size_px,
                                        const std::vector<float>& y,
                                        const std::vector<float>& reference_y);

}  // namespace nearfield::bench
