// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/luminaire.h"

#include <glm/glm.hpp>

#include <cstddef>

namespace nearfield::model {

/// Builds a slab's tables from its coefficients, in double, stored as documented in SlabTables.
/// Cost    O(texels), bound by memory; parallel over images (TBB).
SlabTables build_tables(const Slab& slab);

/// One mip level from the one before: `planes` images (of all channels) of `from` texels, one after
/// the other.
MipLevel halve(const float* coeffs, glm::ivec2 from, std::size_t planes);

/// The light field, checked, with tables for every slab unless `lean`.
Luminaire pack(LightField lightfield, bool lean);

/// How many stored tables' values differ from those that C_m gives, by more than rounding: 1e-6 of
/// the value (positions: of S's extent), 2e-14 of a summed-area table's hi + lo. `worst_relative`
/// is relative to the same; 1 where C_m gives zero.
struct TableCheck {
    std::size_t values = 0, different = 0;
    double worst_relative = 0;
};
TableCheck verify_tables(const Luminaire& luminaire);

}  // namespace nearfield::model
