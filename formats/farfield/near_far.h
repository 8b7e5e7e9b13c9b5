// SPDX-License-Identifier: Apache-2.0
/// How far away a lamp may be taken for a point, the reason to measure near fields; or for whatever
/// else stands for it.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"

#include <glm/glm.hpp>

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace nearfield::farfield {

struct NearFarOptions {
    int size = 33;  // directions along x and along y, odd, 3 ... 501
    /// Directions span this angle from the axis along x and y each; by default what holds 99 % of
    /// the light that goes forwards, 80 degrees at most.
    std::optional<double> half_angle_deg;
    std::array<double, 3> errors{0.01, 0.05, 0.10};  // relative, ascending
    /// What stands for the lamp: irradiance at a receiver. By default a point, intensity /
    /// distance^2.
    std::function<double(const model::Receiver&)> stand_in;
};

/// Direction (i, j) is that of (tan h, tan v, 1) with h and v even from - to + half angle;
/// [row = j][column = i].
struct NearFarMap {
    std::array<double, 3> errors{};
    double half_angle_deg = 0;
    int size = 0;
    glm::dvec3 center_m{0.0};  // from which distances are measured: light_center_m
    double lamp_size_m = 0;
    std::vector<double> intensity, sigma;  // cd or W/sr
    /// [k]: beyond how many metres the stand-in errs by less than errors[k] on a surface that faces
    /// the center. NaN where the lamp is dark: below 1 % of the largest intensity. Infinite
    /// where it errs more at 1024 lamp sizes still.
    std::array<std::vector<double>, 3> distance_m;
    /// [k]: the same distance for half of the light that goes forwards, and for 95 % of it.
    std::array<double, 3> median_m{}, p95_m{};
};

/// Distances are tried from 1024 lamp sizes down to 1/4, half as far every second time, and
/// interpolated in their logarithms. Throws Error for options out of range and for a lamp that
/// does not shine forwards. Cost: up to 25 irradiances a direction.
NearFarMap near_far_map(const LightField& lightfield, const NearFarOptions& options = {});

}  // namespace nearfield::farfield
