// SPDX-License-Identifier: Apache-2.0
/// What `bench fit` measures: how near a fitted light field comes to its lamp, against what a
/// measurement costs: positions, exposures, frames; against filter, basis, planes and smoothness;
/// and the solver's time beside that of general ones.
///
/// The lamp is the headlight by formula. What the screen would see behind the filter is integrated
/// over its lens; a sensor's electrons are drawn and merged; no pictures are made. Luminance alone.
#pragma once

#include "app/bench/fit_settings.h"
#include "app/bench/fit_solvers.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nearfield::bench {

struct FitSweepOptions {
    bool quick = false;  // few settings and texels: seconds, and no conclusions
    std::uint32_t seed = 0;
};

/// Irradiance errors are relative RMS over receivers that see 1 % of the largest intensity.
struct FitResult {
    FitSetting setting;
    int positions = 0;      // that were measured
    double lambda = 0;      // that was used
    double noise_rms = 0;   // against the fit of noise-free measurements
    double basis_rms = 0;   // of that fit against the formula: what basis and texels miss
    double total_rms = 0;   // of the fit against the formula
    double flux_rel = 0;    // fit over formula, less 1
    double coverage = 0;    // share of receivers within three sigma of the noise-free fit
    double chi_square = 0;  // by degree of freedom
    double kkt_worst = 0;
    double factorizations = 0;  // a texel
    double texel_us = 0;        // of a core, sigma included
};

struct FitFindings {
    std::vector<FitResult> results;  // sweep by sweep, each in order
    SolverComparison solvers;
    glm::ivec2 texels{0};
    int receivers = 0;  // that count
    double time_s = 0;
};

FitFindings run_fit_sweeps(const FitSweepOptions& options,
                           const std::function<void(double fraction)>& progress);

/// How a run was made, for the reader of the files.
struct FitSetup {
    std::string command_line;
    std::string machine;  // CPU and cores
    bool quick = false;
};

/// One line a setting: sweep,setting,value,..., the members of FitResult.
std::string as_csv(const FitFindings& findings);

/// {"kind": "fit", ..., "results": [the same names], "solvers": [...]}.
std::string as_json(const FitFindings& findings, const FitSetup& setup);

/// One self-contained page, without scripts.
void write_page(const FitFindings& findings, const FitSetup& setup, const std::string& path);

}  // namespace nearfield::bench
