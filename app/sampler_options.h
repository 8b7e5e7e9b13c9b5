// SPDX-License-Identifier: Apache-2.0
/// Names of samplers, sequences and shifts as choices of options.
#pragma once

#include "formats/model/sampler.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::app {

/// "sum" (no sampler) first.
std::vector<std::pair<std::string, std::optional<model::Sampler>>> sampler_choices();
/// "automatic" (none) first.
std::vector<std::pair<std::string, std::optional<model::Sequence>>> sequence_choices();
std::vector<std::pair<std::string, model::Shift>> shift_choices();

}  // namespace nearfield::app
