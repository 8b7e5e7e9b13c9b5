// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"

#include <cstddef>
#include <string>

namespace nearfield {

/// How many coefficients and sigmas were changed.
struct Repairs {
    std::size_t negative = 0;      // now 0
    std::size_t not_a_number = 0;  // now 0
    std::size_t infinite = 0;      // now the largest finite value of their image and channel

    std::size_t count() const { return negative + not_a_number + infinite; }
    bool operator==(const Repairs&) const = default;
};

/// Makes every coefficient and sigma finite and >= 0.
Repairs repair(LightField& lightfield);

/// Reads a light field as read_lightfield() does, but keeps NaN, infinite and negative values for
/// repair().
LightField read_broken_lightfield(const std::string& path);

}  // namespace nearfield
