// SPDX-License-Identifier: Apache-2.0
/// Parts of plan_from.
#pragma once

#include "formats/capture/plan.h"

#include <string>
#include <vector>

namespace nearfield::capture {

inline constexpr double kLongest_us = 600e6;  // ten minutes: a slip of the pen beyond
inline constexpr int kMostFrames = 1000;      // of one kind at one place

/// Throws Error naming the field where the number is out of range.
double number_within(const JsonField& field, double least, double most);
double optional_number(
    const JsonField& object, const std::string& key, double value, double least, double most);

/// Ascending, at least one.
std::vector<double> exposures_from(const JsonField& field);

/// Kinds of shots besides the positions' own; the plan's grid is known.
void read_flats(const JsonField& field, Plan& plan);
void read_targets(const JsonField& field, Plan& plan);
void read_filter_views(const JsonField& field, Plan& plan);

}  // namespace nearfield::capture
