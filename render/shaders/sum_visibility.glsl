// SPDX-License-Identifier: Apache-2.0
// What of U's cells a receiver sees, for the windowed sum: each cell is asked for once a pixel.
// Columns of cells are kept as long as a basis function covers them: n of them, in a ring.
//
// HAS_SHADOWS alone: every cell's own light by its own visibility ("shares"). With SHADOW_PDIS: an
// image's light by the plain mean over the cells that it covers (Lu, Pacanowski, Granier 2015,
// 6.2). RING_CELLS: at least n (H + n - 1).
// CELLS_FROM_BUFFER: visibility is read from a buffer [row][column] of U's cells, for tests.
#ifdef HAS_SHADOWS

#ifdef CELLS_FROM_BUFFER
layout(std430, binding = 6) readonly restrict buffer CellVisibility { float cells_seen[]; };
float cell_visibility(ivec2 cell, vec3 world_m, vec3 normal) {
    return cells_seen[cell.y * (slab.grid_texels.x + cell_count() - 1) + cell.x];
}
#else
#include "render/shaders/shadows.glsl"
#endif

#ifndef RING_CELLS
#define RING_CELLS 256
#endif
float ring_of_cells[RING_CELLS];

int place_in_ring(int column, int row) { return column % cell_count() * cells_along(1) + row; }

// Before the images of basis column k: the cells that none of the columns before it covered.
void see_columns_of(int k, vec3 world_m, vec3 normal) {
    for (int column = k == 0 ? 0 : k + cell_count() - 1; column < k + cell_count(); ++column)
        for (int row = 0; row < cells_along(1); ++row)
            ring_of_cells[place_in_ring(column, row)] =
                cell_visibility(ivec2(column, row), world_m, normal);
}

// Of cell (cell_x, cell_y) of the support of the image in basis column k and row l.
float visibility(int k, int l, int cell_x, int cell_y) {
#ifdef SHADOW_PDIS
    int n = cell_count();
    float sum = 0.0;
    for (int column = k; column < k + n; ++column)
        for (int row = l; row < l + n; ++row)
            sum += ring_of_cells[place_in_ring(column, row)];
    return sum / float(n * n);
#else
    return ring_of_cells[place_in_ring(k + cell_x, l + cell_y)];
#endif
}

#else
void see_columns_of(int k, vec3 world_m, vec3 normal) {}
float visibility(int k, int l, int cell_x, int cell_y) { return 1.0; }
#endif
