// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/capture/capture.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield::app {

/// kind "capture": plan, frames, missing, sessions, events, rejects; "damaged" where verified
/// (docs/formats.md, "info --json").
nlohmann::ordered_json describe(const capture::Capture& capture,
                                const std::optional<std::vector<int>>& damaged);

/// The same for people.
std::string capture_text(const capture::Capture& capture,
                         const std::optional<std::vector<int>>& damaged);

}  // namespace nearfield::app
