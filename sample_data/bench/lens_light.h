// SPDX-License-Identifier: Apache-2.0
/// Irradiance behind the filter by quadrature over the lamp's lens:
///
///     E_m(s) = integral over the lens of L(a -> s) T_m(u) cos(lens) cos(receiver) / |s - a|^2 da
///
/// with u where the ray from a to s meets the filter's plane. Radiance does not change along a ray,
/// so this is model.md's integral over U with du carried to the lens, where facets and rim lie.
#pragma once

#include "sample_data/bench/places.h"
#include "sample_data/bench/ray_lamp.h"

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace nearfield::sample_data {

/// Colors that something sees: weights of the scene's R, G, B. One for a monochrome camera or a
/// photometer, three for a mosaic.
using SeenColors = std::vector<glm::dvec3>;

/// The lamp on the bench, ready to be integrated.
struct LensLight {
    const Bench* bench = nullptr;
    const Places* places = nullptr;
    RayLamp lamp;
    Rigid bench_from_emitter;
    std::vector<ApertureRow> rows;  // nodes on the lens; y.weight_m * x.weight_m is their area
};

/// Nodes resolve the lamp's features as seen from points `distance_m` away, `step` times coarser
/// than the default.
LensLight make_lens_light(
    const Bench& bench, const Places& places, RayLamp lamp, double distance_m, double step);

/// What arrives along a line of points.
struct LineLight {
    std::vector<double> open;       // [color][i]: nothing on U
    std::vector<double> positions;  // [position][color][i]
};

/// Irradiance, weighed by colors, on points of a plane with this normal (towards the lamp; all in
/// bench). Points should be evenly spaced: transmission and tangent.y are interpolated linearly
/// over blocks of up to 32 (an error of second order, part of the estimate in the truth).
/// position_count: 0 for the open lamp alone.
LineLight line_light(const LensLight& light,
                     std::span<const glm::dvec3> points_bench,
                     glm::dvec3 normal_bench,
                     const SeenColors& colors,
                     int position_count);

/// The same behind a hole of the plate in one position: [color][i]. Seven nodes on the disk, exact
/// for radiance that is a polynomial of degree 5 there.
std::vector<double> hole_light(const LensLight& light,
                               std::span<const glm::dvec3> points_bench,
                               glm::dvec3 normal_bench,
                               const SeenColors& colors,
                               glm::dvec2 hole_filter_m);

/// Radiance weighed by colors, along a ray through a point of bench in its direction of travel:
/// [color].
std::vector<double> ray_light(const LensLight& light,
                              glm::dvec3 through_bench,
                              glm::dvec3 direction_bench,
                              const SeenColors& colors);

}  // namespace nearfield::sample_data
