// SPDX-License-Identifier: Apache-2.0
/// What `bench environment` measures: filtered importance sampling of an environment and its
/// shadows against traced samples of it, beside the baselines of the papers that they come from.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace nearfield::bench {

struct EnvironmentSweepOptions {
    std::string folder;   // of the outputs; there must be one
    std::string picture;  // latitude-longitude, .hdr or .exr; empty: a hall by formula
    std::string mesh;     // a scene whose first mesh is the uneven surface; empty: a knobby ball
    bool quick = false;   // small frames and noisy references: no conclusions
    std::vector<std::string> studies = {};  // of environment_studies(); none: all
};

/// Names of what may be measured alone.
std::vector<std::string> environment_studies();

/// One picture against its reference, over pixels that show a surface.
struct EnvironmentRow {
    std::string study;    // of environment_studies()
    std::string subject;  // exponent, roughness, triangles
    std::string method;
    int samples = 0;       // filtered samples, far lamps, directions
    double rms = 0;        // relative: render::relative_error
    double rms_mean = 0;   // root mean square of the difference over the reference's mean
    double rms_toned = 0;  // of 1 - exp(-L / mean), as displayed
    double lab = 0;        // render::lab_difference
    double bias = 0;       // sum over the reference's, less 1
    double spark = 0;      // the largest difference upwards over the reference's mean
    double time_s = 0;     // of the environment's passes
};

/// Filtered lookups in maps of all directions, luminance over the picture's mean.
struct MapRow {
    std::string map;                     // "paraboloids", "cube"
    double solid_angle_sr = 0;           // that lookups stand for
    double error_rms = 0;                // to the mean over a cap of it
    double jump_rms = 0, jump_most = 0;  // from one side to the other where maps or faces meet
};

/// What a map shows about a cube's corner, luminance.
struct SeamPicture {
    std::string map;
    double solid_angle_sr = 0;
    int side_px = 0;
    std::vector<double> luminance;  // [row][column]
};

struct EnvironmentFindings {
    std::vector<EnvironmentRow> rows;
    std::vector<MapRow> maps;
    std::vector<SeamPicture> seams;
    std::string picture, mesh, device;
    int frame_px = 0, reference_samples = 0;
    double time_s = 0;
};

/// Throws Error if the picture, the mesh or an OpenGL context cannot be had.
EnvironmentFindings run_environment_sweeps(const EnvironmentSweepOptions& options,
                                           const std::function<void(double fraction)>& progress);

struct EnvironmentSetup {
    std::string command_line, machine;
    bool quick = false;
};

/// A line a row.
std::string as_csv(const EnvironmentFindings& findings);

/// {"kind": "environment", ..., "results": [...]}.
std::string as_json(const EnvironmentFindings& findings, const EnvironmentSetup& setup);

/// What follows from the rows, in sentences with their numbers; the papers' claims first.
std::vector<std::string> conclusions(const EnvironmentFindings& findings);

/// One self-contained page, without scripts.
void write_page(const EnvironmentFindings& findings,
                const EnvironmentSetup& setup,
                const std::string& path);

}  // namespace nearfield::bench
