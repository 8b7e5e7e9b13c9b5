// SPDX-License-Identifier: Apache-2.0
/// The report of a fit.
#pragma once

#include "fit/fit_capture.h"
#include "formats/report/page.h"

#include <string>

namespace nearfield::app {

report::Page fit_page(const fit::CaptureFit& fit, const std::string& command);

}  // namespace nearfield::app
