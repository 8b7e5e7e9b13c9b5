// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/document.h"

#include <string>
#include <vector>

namespace nearfield::viewer {

/// A document with what it was before and after what was undone: whole documents, which share what
/// they have in common.
struct History {
    struct Step {
        Document document;
        std::string name;  // of the edit that led away from it
    };
    Document now;
    std::vector<Step> past, future;
    int gesture = 0;  // of the last edit
};

/// Applies an edit. Edits of one gesture (a drag, a slider held; its number, 0: on its own) are
/// undone together. The oldest of more than 500 steps are forgotten.
void edit(History& history, const Edit& edit, int gesture = 0);

/// False where there is nothing to undo or to redo.
bool undo(History& history);
bool redo(History& history);

}  // namespace nearfield::viewer
