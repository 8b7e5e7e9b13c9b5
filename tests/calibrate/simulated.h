// SPDX-License-Identifier: Apache-2.0
/// A bench made of numbers: where everything is, and the corners and filter centers that a camera
/// would see, with noise. Poses are products of matrices, none of the calibration's own formulas.
#pragma once

#include "calibrate/observations.h"
#include "formats/files/lightfield.h"
#include "formats/rig/lens.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace nearfield::test {

/// The truth.
struct SimulatedBench {
    rig::Lens lens;
    glm::ivec2 squares{8, 6};
    double square_m = 0.03;
    Rigid camera_from_slab;
    double delta_m = 0.2;
    glm::dvec2 u_tilt_rad{0.004, -0.006};
    glm::ivec2 grid{9, 7};
    glm::dvec2 pitch_m{0.02002, 0.02165};
    double skew_rad = 0.002;
    glm::dvec2 bend_m{0.0};                    // z = x of it * x^2 + y of it * y^2, see BoardBend
    std::vector<glm::dvec2> step_error_m;      // [row * columns + column]
    std::vector<Rigid> camera_from_board;      // [view]
    std::vector<capture::TargetPlane> planes;  // [view]
    std::vector<glm::ivec2> filter_positions;

    Rigid slab_from_u() const;
    /// A filter center in the slab's frame.
    glm::dvec3 center_slab(glm::ivec2 position) const;
};

struct SimulatedNoise {
    std::uint64_t seed = 1;
    double corner_px = 0;
    double filter_px = 0;
};

/// A lens with some of every distortion, 512 x 512 px.
rig::Lens simulated_lens(rig::LensModel model);

/// Two boards on S, two on U, `free_count` tilted ones between; nine filter views. The stage's
/// errors are drawn once with this sigma.
SimulatedBench simulated_bench(rig::LensModel model, int free_count, double step_sigma_m);

calibrate::Observations observed(const SimulatedBench& bench, const SimulatedNoise& noise);

/// Rotation about x, then y, then z.
glm::dmat3 turn_xyz(glm::dvec3 angle_rad);
Rigid operator*(const Rigid& a_from_b, const Rigid& b_from_c);

/// A standard normal number that is a hash of these.
double normal(std::uint64_t seed, std::uint64_t what, std::uint64_t index);

}  // namespace nearfield::test
