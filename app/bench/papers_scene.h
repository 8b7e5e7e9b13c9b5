// SPDX-License-Identifier: Apache-2.0
/// The lamps and the scene of `bench papers`.
#pragma once

#include "app/bench/target.h"
#include "formats/files/luminaire.h"
#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace nearfield::bench {

/// A lamp of the sizes of one of the paper's (its table 1), and what it takes to make it ready.
struct PapersLamp {
    std::string name;   // "9x7"
    std::string paper;  // the paper's name of the lamp whose sizes these are: "bike"
    std::string uri;    // its light field's file in the folder
    LightField lightfield;
    double tables_s = 0;           // building the tables that samplers read, best of three
    double coefficient_bytes = 0;  // C_m
    double table_bytes = 0;        // all of them
};

/// The headlight of sample_data, planes 0.5 m apart, as 9 x 7 images of 300 x 300 texels with the
/// quadratic basis, 5 x 5 and 11 x 9 of 256 x 256 with B-splines; R G B. quick: smaller images of
/// the two latter. Writes the light fields. Cost: half a minute, 170 MB of files.
std::vector<PapersLamp> make_papers_lamps(const std::string& folder, bool quick);

/// The demo's road, lit by the left headlight alone or by both.
Scene make_papers_scene(const PapersLamp& lamp, const std::string& folder, int lamps);

/// What a camera sees of a scene with one lamp, as receivers: row by row from below; where it sees
/// nothing, a receiver behind the lamp, which gets no light.
struct View {
    std::string camera;
    Target target;
    double exact_s = 0;  // finding the target's light by the sum in double
};
View make_view(const Scene& scene, const std::string& camera, glm::ivec2 size_px, const Lamp& lamp);

}  // namespace nearfield::bench
