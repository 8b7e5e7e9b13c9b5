// SPDX-License-Identifier: Apache-2.0
/// The virtual bench as camera and stage without a wire, and as what a network camera sees.
#pragma once

#include "acquire/session.h"
#include "sample_data/bench/bench.h"

#include <string>

namespace nearfield::app {

/// Camera and stage of a bench's file, in this process: exposures take no time; time goes on by the
/// exposures.
acquire::Bench open_lab_bench(const std::string& path);

}  // namespace nearfield::app
