// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"

namespace nearfield::model {

/// What profiles a pitch apart add up to at their centers: 1 where they sum to one.
double overlap(const Profile& profile);

}  // namespace nearfield::model
