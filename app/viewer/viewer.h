// SPDX-License-Identifier: Apache-2.0
/// The viewer's state, and what changes it. No window, no OpenGL: what draws reads it and calls
/// what is declared here.
#pragma once

#include "app/viewer/develop.h"
#include "app/viewer/files.h"
#include "app/viewer/gizmo.h"
#include "app/viewer/history.h"
#include "app/viewer/light.h"
#include "app/viewer/view.h"
#include "app/viewer/worker.h"

#include <glm/glm.hpp>

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::viewer {

/// What a click in the picture does next.
enum class Tool { Select, Aim, Measure };

/// A state that was kept to compare with, or a picture's file.
struct KeptState {
    std::string name;
    std::shared_ptr<const Frame> frame;
    Mixed mixed;
};

/// What was shown last, for the graph.
struct Shot {
    double time_s = 0;
    std::optional<double> error_rel;  // none of drafts, which do not estimate it
};

struct Viewer {
    History history;
    bool is_open = false;                // a document is there
    int saved_changes = 0, changes = 0;  // counts edits; equal: nothing is unsaved
    int autosaved_changes = 0;

    View view;
    Look look;
    int dial = kDefaultDial;
    std::optional<int> selected, solo;  // ids
    bool has_lamps_axes = false, shows_map = false, shows_panels = true, shows_help = false;
    Tool tool = Tool::Select;

    std::optional<Drag> drag;
    std::optional<Handle> hot;                                // under the mouse
    int gesture = 0;                                          // the last that began
    std::optional<std::pair<glm::dvec2, glm::dvec2>> region;  // of the picture, 0 ... 1
    std::optional<glm::dvec2> mouse;                          // over the picture, 0 ... 1

    std::optional<KeptState> kept;
    double split = 0.5;  // of the picture's width: left of it what was kept

    Progress progress;
    std::shared_ptr<const Frame> frame;  // that `mixed` is of
    Mixed mixed;
    Developed developed;
    std::optional<Difference> difference;  // to what was kept
    std::deque<Shot> shots;                // the last 120
    bool is_stale = false;                 // mixed and developed are not of what is asked for
    int serial = 0;                        // of the last request

    std::string message;  // of the last thing that went wrong or right
};

/// Takes up a document that was opened.
void take(Viewer& viewer, Opened opened);

/// Edits; see edit().
void change(Viewer& viewer, const Edit& edit, int gesture = 0);
void undo(Viewer& viewer);
void redo(Viewer& viewer);
int begin_gesture(Viewer& viewer);
bool is_unsaved(const Viewer& viewer);
/// Throws Error.
void save(Viewer& viewer, const std::string& path);

/// Compares with what is shown from now on.
void keep_state(Viewer& viewer);
/// Compares with a picture that `nearfield render` wrote, .exr. Throws Error where it cannot be
/// read or has no default layer of three channels.
void compare_with(Viewer& viewer, const std::string& path);

/// What is to be rendered for a picture of that size, numbered.
Request request_of(const Viewer& viewer, glm::ivec2 size_px);

/// Takes up what the renderer has done, and mixes and develops it where anything of that changed:
/// true where there are other pixels to show. Cost at 1280 x 720: some 10 ns a pixel and lamp to
/// mix, 50 to develop.
bool refresh(Viewer& viewer, const Progress& progress);

/// Where a lamp or a surface under the mouse is read; nothing where there is none.
std::optional<Reading> reading_under_mouse(const Viewer& viewer);
/// The point of a surface at a place of the picture (0 ... 1).
std::optional<glm::dvec3> surface_at(const Viewer& viewer, glm::dvec2 at);
std::optional<RegionStatistics> region_statistics(const Viewer& viewer);

/// What went wrong, or else the last message.
const std::string& said(const Viewer& viewer);

/// Estimated error of what is shown: mean of (sigma + bias) / radiance over lit pixels, without
/// those that see a lamp itself.
double error_of(const Frame& frame, const Mixed& mixed);

}  // namespace nearfield::viewer
