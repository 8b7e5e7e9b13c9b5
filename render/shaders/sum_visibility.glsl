// SPDX-License-Identifier: Apache-2.0
// What of U's cells a receiver sees, for the windowed sum: each cell is asked for once a pixel.
// Columns of cells are kept as long as a basis function covers them: n of them, in a ring.
//
// HAS_SHADOWS alone: every cell's own light by its own visibility ("shares"). With SHADOW_PDIS: an
// image's light by the plain mean over the cells that it covers (Lu, Pacanowski, Granier 2015,
// 6.2). RING_CELLS: at least n (H + n - 1).
// CELLS_FROM_BUFFER: visibility is read from a buffer [row][column] of U's cells, for tests.
//
// CELLS_APART, by moments: every cell's visibility is in the weights of its texels.
#if defined(HAS_SHADOWS) && !defined(SHADOW_PDIS) && !defined(BY_PIECES)
#define CELLS_APART
#endif

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

float visibility_of_cell(int column, int row) { return ring_of_cells[place_in_ring(column, row)]; }

// Whether light arrives through any of the cells in a row that basis column k covers.
bool is_any_seen(int k, int row) {
#ifdef SHADOW_PDIS
    bool is_seen = true;
#else
    bool is_seen = false;
#endif
    for (int column = k; column < k + cell_count(); ++column)
        is_seen = is_seen || visibility_of_cell(column, row) > 0.0;
    return is_seen;
}

// What weighs on the image in basis column k and row l, through cell (cell_x, cell_y) of its support.
float visibility(int k, int l, int cell_x, int cell_y) {
#if defined(SHADOW_PDIS)
    int n = cell_count();
    float sum = 0.0;
    for (int column = k; column < k + n; ++column)
        for (int row = l; row < l + n; ++row)
            sum += visibility_of_cell(column, row);
    return sum / float(n * n);
#elif defined(CELLS_APART)
    return 1.0;
#else
    return visibility_of_cell(k + cell_x, l + cell_y);
#endif
}

#else
void see_columns_of(int k, vec3 world_m, vec3 normal) {}
bool is_any_seen(int k, int row) { return true; }
float visibility(int k, int l, int cell_x, int cell_y) { return 1.0; }
#endif
