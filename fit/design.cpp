// SPDX-License-Identifier: Apache-2.0
#include "fit/design.h"

#include "fit/axis_design.h"
#include "formats/files/error.h"
#include "formats/model/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::fit {
namespace {

void check_optics(const Slab& planes, const Optics& optics) {
    const auto refuse = [](const std::string& field, const char* expected, double got) {
        throw Error{"optics cannot be used", "optics: " + field, expected, fmt::format("{}", got)};
    };
    if (optics.position_m.empty())
        refuse("position_m", "at least one", 0);
    for (std::size_t k = 0; k < optics.position_m.size(); ++k)
        if (const glm::dvec3 p = optics.position_m[k];
            !(p.z < -0.5 * planes.delta_m && std::isfinite(p.x + p.y + p.z)))
            refuse(fmt::format("position_m[{}].z", k), "behind the middle between S and U", p.z);
    if (optics.sensor == Sensor::Pinhole && !(optics.pinhole_area_m2 > 0.0))
        refuse("pinhole_area_m2", "> 0", optics.pinhole_area_m2);
    for (int d = 0; d < 2 && optics.sensor == Sensor::Filter; ++d)
        if (!(optics.filter_pitch_m[d] > 0.0))
            refuse("filter_pitch_m", "> 0", optics.filter_pitch_m[d]);
    if (optics.sensor == Sensor::Filter &&
        (optics.filter_x.cells.empty() || optics.filter_y.cells.empty()))
        refuse("filter_x, filter_y", "at least one cell", 0);
}

// Whether all positions lie on U itself: then they look the same from every texel.
bool is_on_u(const Slab& planes, const Optics& optics) {
    constexpr double kSamePlane = 1e-12;  // of delta
    return optics.filter_slope == glm::dvec2(0.0) &&
           std::all_of(optics.position_m.begin(), optics.position_m.end(), [&](glm::dvec3 p) {
               return std::abs(p.z + planes.delta_m) <= kSamePlane * planes.delta_m;
           });
}

// A run of one texel and measurement, before all runs get the same width.
struct AxisRun {
    double u_m = 0;
    std::vector<double> value;       // [m]
    AxisNodes nodes;                 // empty where not needed
    std::vector<double> node_value;  // [node][m]
};

// The position seen from s on U, by the line through both:
//
//     u = s + (x + x' - s) delta / d,   d = -(z + slope x'),   x' from the filter's center
//
// and du/dx' at x' = 0 for the pitch.
AxisRun axis_run(const Slab& planes,
                 const Optics& optics,
                 const AxisBasis& basis,
                 int dimension,
                 std::size_t k,
                 double s_m) {
    const glm::dvec3 position = optics.position_m[k];
    const double enlarged = planes.delta_m / -position.z;
    const double from_s_m = position[dimension] - s_m;
    AxisRun run;
    run.u_m = s_m + from_s_m * enlarged;
    if (optics.sensor != Sensor::Filter) {
        run.value = values_at(basis, run.u_m);
        return run;
    }
    const double stretch =
        enlarged * (1.0 + optics.filter_slope[dimension] * from_s_m / -position.z);
    const AxisFilter filter{dimension == 0 ? &optics.filter_x : &optics.filter_y, run.u_m,
                            optics.filter_pitch_m[dimension] * stretch};
    AxisNodes nodes = axis_nodes(basis, filter);
    run.value = axis_integrals(basis, nodes);
    if (planes.weighting == Weighting::Radiance) {
        for (std::size_t g = 0; g < nodes.u_m.size(); ++g)
            for (const double phi : values_at(basis, nodes.u_m[g]))
                run.node_value.push_back(nodes.weight_m[g] * phi);
        run.nodes = std::move(nodes);
    }
    return run;
}

// First and one past the last entry that is not 0; an empty run is the first entry.
std::pair<int, int> extent(const std::vector<double>& value) {
    const auto is_set = [](double x) { return x != 0.0; };
    const auto begin = std::find_if(value.begin(), value.end(), is_set);
    if (begin == value.end())
        return {0, 1};
    const auto end = std::find_if(value.rbegin(), value.rend(), is_set).base();
    return {static_cast<int>(begin - value.begin()), static_cast<int>(end - value.begin())};
}

// Nodes beyond a run's own have weight 0.
void append_nodes(AxisDesign& axis, const AxisRun& run, int basis_count, int first) {
    for (int g = 0; g < axis.node_count; ++g) {
        const bool is_used = static_cast<std::size_t>(g) < run.nodes.u_m.size();
        axis.node_m.push_back(is_used ? run.nodes.u_m[static_cast<std::size_t>(g)] : run.u_m);
        for (int q = 0; q < axis.width; ++q)
            axis.node_value.push_back(
                is_used ? run.node_value[static_cast<std::size_t>(g * basis_count + first + q)]
                        : 0.0);
    }
}

AxisDesign axis_design(const Slab& planes, const Optics& optics, int dimension) {
    const AxisBasis basis = axis_basis(planes, dimension);
    AxisDesign axis;
    axis.texel_count = is_on_u(planes, optics) ? 1 : planes.texels[dimension];
    std::vector<AxisRun> runs;
    for (int t = 0; t < axis.texel_count; ++t) {
        const double s_m = planes.s_min_m[dimension] + (t + 0.5) * planes.texel_m()[dimension];
        for (std::size_t k = 0; k < optics.position_m.size(); ++k)
            runs.push_back(axis_run(planes, optics, basis, dimension, k, s_m));
    }
    axis.width = 1;
    for (const AxisRun& run : runs) {
        const auto [begin, end] = extent(run.value);
        axis.width = std::max(axis.width, end - begin);
        axis.node_count = std::max(axis.node_count, static_cast<int>(run.nodes.u_m.size()));
    }
    for (const AxisRun& run : runs) {
        const int first = std::min(extent(run.value).first, basis.count - axis.width);
        axis.first.push_back(first);
        axis.u_m.push_back(run.u_m);
        axis.value.insert(axis.value.end(), run.value.begin() + first,
                          run.value.begin() + first + axis.width);
        append_nodes(axis, run, basis.count, first);
    }
    return axis;
}

// Least and most of the sum of all functions shifted by whole pitches, on one cell.
std::pair<double, double> ripple_along(const Profile& profile) {
    // phi's pieces, moved onto the cell [0, 1) of x - c + n/2, add up to a parabola.
    const double n = static_cast<double>(profile.cells.size());
    double a0 = 0, a1 = 0, a2 = 0;
    for (std::size_t c = 0; c < profile.cells.size(); ++c) {
        const double x0 = static_cast<double>(c) - 0.5 * n;
        const auto& [p0, p1, p2] = profile.cells[c];
        a0 += p0 + x0 * (p1 + x0 * p2);
        a1 += p1 + 2.0 * x0 * p2;
        a2 += p2;
    }
    double least = std::min(a0, a0 + a1 + a2), most = std::max(a0, a0 + a1 + a2);
    if (const double x = a2 == 0.0 ? -1.0 : -0.5 * a1 / a2; x > 0.0 && x < 1.0) {
        least = std::min(least, a0 + x * (a1 + x * a2));
        most = std::max(most, a0 + x * (a1 + x * a2));
    }
    return {least, most};
}

}  // namespace

Design make_design(const Slab& planes, const Optics& optics) {
    check_optics(planes, optics);
    Design design;
    design.grid = planes.grid;
    design.texels = planes.texels;
    design.s_min_m = planes.s_min_m;
    design.texel_m = planes.texel_m();
    design.delta_m = planes.delta_m;
    design.measurement_count = static_cast<int>(optics.position_m.size());
    design.sensor = optics.sensor;
    design.weighting = planes.weighting;
    design.scale = optics.sensor == Sensor::Pinhole ? optics.pinhole_area_m2 : 1.0;
    design.x = axis_design(planes, optics, 0);
    design.y = axis_design(planes, optics, 1);
    return design;
}

Ripple basis_ripple(const Slab& planes) {
    const auto [least, most] = ripple_along(planes.profile);
    return {least * least, most * most};
}

}  // namespace nearfield::fit
