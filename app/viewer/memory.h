// SPDX-License-Identifier: Apache-2.0
/// What the viewer keeps from one run to the next: where its window was.
#pragma once

#include "app/viewer/window.h"

#include <optional>

namespace nearfield::viewer {

/// In $XDG_CONFIG_HOME/nearfield/viewer.json, or ~/.config/... Nothing where there is no such file,
/// or it is not understood.
std::optional<WindowPlace> remembered_place();
/// What cannot be written is not remembered.
void remember_place(const WindowPlace& place);

}  // namespace nearfield::viewer
