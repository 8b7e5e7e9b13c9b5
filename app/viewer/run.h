// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/quality.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield::viewer {

struct ViewerOptions {
    std::string path;                // scene or luminaire
    std::vector<std::string> lamps;  // luminaires to add
    std::optional<glm::ivec2> size_px;
    std::string camera;  // by name; empty: the first
    int dial = kDefaultDial;
    std::optional<double> exposure_ev;
    std::string screenshot;         // .png or .exr, of the refined picture; empty: none
    std::string window_screenshot;  // .png, with panels
    bool exits = false;             // once the picture is refined and written
    bool remembers = true;          // place and dial, from one run to the next
    std::string trace;              // JSON lines of what is done and where widgets are; empty: none
};

/// Opens the window and stays until it is closed. Throws Error where there is no display, where the
/// file cannot be opened at the start, or where a screenshot cannot be written.
void run_viewer(const ViewerOptions& options);

}  // namespace nearfield::viewer
