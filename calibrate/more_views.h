// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/observations.h"
#include "calibrate/robust_fit.h"

#include <string>
#include <vector>

namespace nearfield::calibrate {

/// A fit in which views of one kind count twice: what as many again would buy, with no step taken.
struct CountedTwice {
    std::string what;
    Fitted fitted;
    Observations observations;
};

/// One for every kind of view that there is.
std::vector<CountedTwice> counted_twice(const Fitted& fitted, const Observations& observations);

}  // namespace nearfield::calibrate
