// SPDX-License-Identifier: Apache-2.0
/// Sums over texels in double, which tables are tested against.
#pragma once

#include "formats/files/luminaire.h"

#include <glm/glm.hpp>

#include <cstddef>

namespace nearfield::test {

inline std::size_t to_size(int n) {
    return static_cast<std::size_t>(n);
}

/// A slab of W x H images on texels 1 mm wide and 2 mm high, from (-0.1, 0.3) m on.
Slab dark_slab(glm::ivec2 texels, glm::ivec2 grid = {1, 1}, const char* profile = "box");

/// Texel (i, j) of image m, one channel.
float& texel(Slab& slab, int m, int i, int j);

/// One image of size^2 texels over ten powers of ten, spread evenly in the logarithm; the upper
/// right quarter dark but for its faintest ones, as a lamp above its cut-off line.
Slab wide_range_slab(int size);

/// Texels [x0, x1) x [y0, y1).
struct Box {
    int x0, y0, x1, y1;
};

/// Integral of image 0 over a box.
double sum_box(const Slab& slab, const Box& box);

/// The same as a sampler takes it from summed-area tables: differences of hi and of lo; lo left out
/// where only one float is asked for.
double table_box(const SlabTables& tables, int width, const Box& box, bool has_lo);

/// Expects summed-area tables of size^2 texels over ten powers of ten to give random boxes that
/// hold at least 1e-9 of the light, half of them from a dark quarter, to 1e-4; and that hi alone
/// would not.
void expect_precise_boxes(int size, int tries);

}  // namespace nearfield::test
