// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/json_field.h"
#include "sample_data/bench/bench.h"

#include <string>

namespace nearfield::sample_data {

/// A bench, a pose as JSON; matrices row by row.
Json to_json(const Bench& bench);
Json to_json(const Rigid& rigid);

/// Throws Error naming place and key; `where` is the file. Keys that are left out keep their
/// defaults; unknown ones are refused.
Bench bench_from_json(const Json& json, const std::string& where);

}  // namespace nearfield::sample_data
