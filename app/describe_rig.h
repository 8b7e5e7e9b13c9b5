// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/rig/rig.h"

#include <string>

namespace nearfield::app {

/// A rig in words: lens, planes, light, with sigma where it is known.
std::string rig_text(const rig::Rig& rig);

}  // namespace nearfield::app
