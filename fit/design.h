// SPDX-License-Identifier: Apache-2.0
/// What measurements see of a light field's coefficients: the design matrices G, b = G c.
///
/// Slab frame, metres: S is z = 0, U is z = -delta_m. Through the point u of U towards the texel s
/// goes f_s(u) = L(u -> s) cos^4(theta) / delta^2 per area of U. Measurement k at position
/// X_k = (x, y, z) sees of the texel
///
///     filter    E on S behind a transmission Phi^:  b_k(s) = integral of f_s Phi^_k du     lx
///     pinhole   E on S behind a hole of area a:     b_k(s) = a f_s(u_k)                    lx
///     camera    L towards its center:               b_k(s) = L(u_k -> s)                   cd m^-2
///
/// with L = w sum_m C_m(s) Phi_m(u), w = delta^2 / cos^4(theta) or 1 (Weighting). Images and basis
/// functions are counted m = row * W + column.
///
/// A filter that does not lie on U (X_k.z != -delta_m, or a plane tilted against S) is projected on
/// U from the texel's center: its position and width then differ from texel to texel.
/// Source    model.md: Goesele, Granier, Heidrich, Seidel, "Accurate light source acquisition and
///           rendering", 2003.
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <vector>

namespace nearfield::fit {

enum class Sensor { Filter, Pinhole, Camera };

/// What stands at U, and where. Profiles and pitch are the filter's alone.
struct Optics {
    Sensor sensor = Sensor::Filter;
    std::vector<glm::dvec3> position_m;  // [k], slab frame, z near -delta_m; in any order
    /// Transmission along x and y, argument in units of `filter_pitch_m` from the center. Its axes
    /// are the slab's: a turn of alpha about z changes entries of G by alpha / 30 times the largest
    /// (B-splines on pitches 10 % apart; 5e-4 at one degree).
    Profile filter_x, filter_y;
    glm::dvec2 filter_pitch_m{0};
    /// dz/dx and dz/dy of the filter's plane in the slab. Along each axis alone: the shear that a
    /// slope adds across the other axis is neglected.
    glm::dvec2 filter_slope{0};
    double pinhole_area_m2 = 0;
};

/// One axis' part of G for every texel along it and every measurement: a run of `width` numbers
/// that belong to basis functions `first` ... `first + width - 1`.
struct AxisDesign {
    int texel_count = 1;  // 1: the same for all texels
    int width = 0;
    std::vector<int> first;          // [texel][k]
    std::vector<double> value;       // [texel][k][width]
    std::vector<double> u_m;         // [texel][k]: center of the position, seen on U
    int node_count = 0;              // quadrature nodes, where the axes cannot be integrated apart
    std::vector<double> node_m;      // [texel][k][node]
    std::vector<double> node_value;  // [texel][k][node][width]: weight * transmission * phi
};

/// G of all texels.
struct Design {
    glm::ivec2 grid{0};
    glm::ivec2 texels{0};
    glm::dvec2 s_min_m{0}, texel_m{0};
    double delta_m = 0;
    int measurement_count = 0;
    Sensor sensor = Sensor::Filter;
    Weighting weighting = Weighting::Irradiance;
    double scale = 1;  // of all entries: a pinhole's area
    AxisDesign x, y;

    int basis_count() const { return grid.x * grid.y; }
    /// Whether G differs from texel to texel.
    bool is_varying() const;
};

/// Throws Error naming "optics" and the field: no position, a position on or before S, a pitch or
/// area that is not positive.
/// Cost    irradiance weighting, filter off U: (w + h) runs a measurement; radiance weighting
///         behind a filter keeps its quadrature nodes: 1.2 kB a measurement, texel column and row.
Design make_design(const Slab& planes, const Optics& optics);

/// G of one texel: measurement k's entries stand in a rectangle of `height` rows of the basis grid,
/// `stride` numbers each (a multiple of 8, zeros at the end).
struct TexelDesign {
    glm::ivec2 grid{0};
    int measurement_count = 0;
    int width = 0, height = 0, stride = 0;
    std::vector<int> first;     // [k]: basis function m of the rectangle's first entry
    std::vector<double> value;  // [k][height][stride]

    /// Measurements by their rectangle's first column on the grid, then by its first row; where
    /// those of a column and row begin among them, and an end.
    std::vector<int> by_corner;
    std::vector<int> corner_begin;  // [column * grid.y + row]

    std::size_t block(int k) const {
        return static_cast<std::size_t>(k) * static_cast<std::size_t>(height * stride);
    }
};

/// Writes G of texel (i, j) over what was in `texel`, whose memory is used again. Exact but for
/// radiance weighting behind a filter: three Gauss nodes a piece there, 1e-5 of the largest entry.
/// Cost    11 x 9 positions, B-splines: 6 us; radiance weighting behind a filter takes 324 nodes a
///         position.
void fill_texel_design(const Design& design, int i, int j, TexelDesign& texel);

/// G as a matrix, [k][m].
std::vector<double> dense(const TexelDesign& texel);

/// (G c)_k; c is [m].
double predicted(const TexelDesign& texel, int k, const std::vector<double>& coeffs);

/// Least and largest value of sum_m Phi_m over the part of U that is covered by as many functions
/// as the middle is: 1 and 1 for profiles that sum to one.
struct Ripple {
    double least = 0, most = 0;
};
Ripple basis_ripple(const Slab& planes);

}  // namespace nearfield::fit
