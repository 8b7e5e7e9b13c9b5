// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/environment.h"
#include "formats/report/page.h"

namespace nearfield::bench {

/// Adds a study's plots to its section: errors over samples; of "time" times, over triangles too.
void add_plots(const EnvironmentFindings& findings,
               const std::string& study,
               report::Section& section);

}  // namespace nearfield::bench
