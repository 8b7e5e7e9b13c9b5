// SPDX-License-Identifier: Apache-2.0
/// What `bench shadows` measures: pictures by shadow maps against pictures by traced rays, over the
/// maps' number, size and filter.
#pragma once

#include "formats/scene/scene.h"
#include "render/gpu/shadow_views.h"

#include <glm/glm.hpp>

#include <functional>
#include <string>
#include <vector>

namespace nearfield::bench {

struct ShadowSweepOptions {
    std::string camera;          // by name; empty: the first
    glm::ivec2 size_px{320, 0};  // height 0: by the camera's aspect ratio
    int samples = 1024;          // of the traced picture, of a pixel and lamp, >= 2
    int repeats = 3;             // of each setting: its least times count
    std::vector<int> maps = {1, 2, 4, 8, 16, 32};  // all come always
    std::vector<int> map_px = {48, 96, 192, 384, 768};
};

/// One setting's picture.
struct ShadowResult {
    std::string sweep;    // "eye", "maps", "map-px", "pcf"
    std::string setting;  // what is varied, as text
    render::ShadowMapOptions options;
    double lab = 0;      // difference to the traced picture: render::lab_difference
    double maps_s = 0;   // rendering all lamps' maps
    double light_s = 0;  // light sums with visibility by maps
    double bytes = 0;    // of the maps
};

struct ShadowFindings {
    std::vector<ShadowResult> results;  // sweep by sweep, each in order
    double lab_noise = 0;               // between two traced pictures with other random numbers
    double lab_without = 0;             // of a picture without shadows
    double light_without_s = 0;
    double traced_s = 0;  // of the traced picture, all in all
    std::string device;   // that rendered maps
    std::string camera;
    glm::ivec2 size_px{0};
    int samples = 0;
    double time_s = 0;
};

/// Pictures of irradiance, as if all surfaces were white and matt: the light sum has no noise, so
/// that all differences are of visibility. Throws Error where the scene calls for no shadows, or as
/// the renderers do.
ShadowFindings run_shadow_sweeps(const Scene& scene,
                                 const ShadowSweepOptions& options,
                                 const std::function<void(double fraction)>& progress);

/// What was measured and how, for the reader of the files.
struct ShadowSetup {
    std::string scene;
    std::string command_line;
    std::string machine;  // CPU and cores
};

/// {"kind": "shadows", ..., "results": [...]}.
std::string as_json(const ShadowFindings& findings, const ShadowSetup& setup);

/// One self-contained page, without scripts.
void write_page(const ShadowFindings& findings, const ShadowSetup& setup, const std::string& path);

}  // namespace nearfield::bench
