// SPDX-License-Identifier: Apache-2.0
/// A command among simulated devices.
#pragma once

#include "sample_data/bench/bench.h"

#include <string>
#include <vector>

namespace nearfield::app {

/// Makes a V4L2 and a USB3 Vision camera, a luxmeter, a lamp's supply and a stage before the bench,
/// runs the command among them and returns its exit code (128 and the signal where one killed it).
/// "nearfield" is this program. Throws Error where the command cannot be started.
int run_among_devices(const sample_data::Prepared& prepared,
                      bool fast,
                      const std::vector<std::string>& command);

}  // namespace nearfield::app
