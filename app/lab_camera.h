// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/bench/bench.h"
#include "sample_data/gige/camera.h"

namespace nearfield::app {

/// The virtual bench as what stands before the network camera.
gige::Lab lab_of(const sample_data::Prepared& prepared);

}  // namespace nearfield::app
