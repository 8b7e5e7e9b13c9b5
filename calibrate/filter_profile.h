// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"
#include "formats/rig/lens.h"

#include <glm/glm.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nearfield::calibrate {

/// A picture of the filter against an even source, divided by the flat field of that source.
struct FilterPicture {
    glm::ivec2 position{0};           // of the stage: column, row
    std::vector<float> transmission;  // [row][column]; of the pixel's own color
    std::vector<float> sigma;         // 0: not to be used
};

/// Where a view of the filter shows its center. Frame of plane U: x and y in the plane, that of
/// `camera_from_u`.
struct FilterCenter {
    glm::ivec2 position{0};
    glm::dvec2 center_px{0}, center_u_m{0};
    glm::dmat2 covariance_px2{0.0};
    double chi2_per_pixel = 0;
    std::size_t pixels = 0;
};

/// The measured profile along one axis of the filter, for people.
struct ProfilePoint {
    double x = 0;  // in pitches, from the center
    double value = 0, sigma = 0, fitted = 0;
};

struct FilterProfileResult {
    Profile profile;                       // "measured", peak 1 at its center
    std::vector<double> peak, peak_sigma;  // transmission at the center, [color]
    std::vector<FilterCenter> centers;
    double turn_rad = 0, turn_sigma_rad = 0;  // the filter's x axis against U's
    double chi2 = 0;
    std::size_t pixels = 0;
    int parameters = 0;
    std::vector<ProfilePoint> along_x, along_y;
    double nominal_deviation = 0;                // largest, of the peak; against the nominal basis
    double nominal_sigmas = 0;                   // the same in sigmas
    double asymmetry = 0, asymmetry_sigmas = 0;  // of x against y, RMS of their difference
    int jumps = 0;                               // knots where the profile is not continuous
};

/// What is known before.
struct FilterGeometry {
    rig::Lens lens;
    Rigid camera_from_u;        // of a frame in the filter's plane
    glm::dvec2 pitch_m{0};      // the profile's unit of length along the filter's axes
    double turn_guess_rad = 0;  // to 20 degrees or so
    double psf_sigma_px = 0.7;  // of the lens; the pixel's own square comes besides
};

/// Fits  T(u) = peak phi(x) phi(y),  x and y in pitches along the filter's axes from its center,
/// phi quadratic on each of `nominal`'s cells, its centroid at 0: peak, phi, turn and every view's
/// center at once, by Gauss and Newton's iteration. A pixel sees phi blurred by its square and the
/// lens' core, and so is the model: moments of truncated gaussians, so edges and knots are no
/// special case. Where neighboring cells meet within 3 sigma or half a percent, they are made to
/// meet.
///
/// In      color_of: of a value, 0 ... colors - 1
/// Throws  Error where a view shows no filter (its light is nowhere above 5 sigma), where it is cut
///         off by the picture's border, or where the fit does not converge.
/// Memory  the pixels about the filter of all views, 48 bytes each.
FilterProfileResult filter_profile_of(std::span<const FilterPicture> pictures,
                                      const FilterGeometry& geometry,
                                      const Profile& nominal,
                                      int colors,
                                      const std::vector<int>& color_of);

/// Integral of the gaussian of sigma s about x times 1, t, t^2 over lower <= t <= upper.
glm::dvec3 blurred_moments(double x, double s, double lower, double upper);

}  // namespace nearfield::calibrate
