// SPDX-License-Identifier: Apache-2.0
/// The report of a fit.
#pragma once

#include "app/fit_light.h"
#include "fit/fit_capture.h"
#include "formats/report/page.h"

#include <string>

namespace nearfield::app {

/// `fit` has planes; coefficients are not asked for.
report::Page fit_page(const fit::CaptureFit& fit,
                      const FitLight& light,
                      const std::string& command);

}  // namespace nearfield::app
