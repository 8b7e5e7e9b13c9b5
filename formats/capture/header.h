// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/capture/capture.h"

#include <string>

namespace nearfield::capture {

/// The content of capture.json.
std::string header_text(const CaptureHeader& header);

}  // namespace nearfield::capture
