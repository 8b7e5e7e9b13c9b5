// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/rays/directions.h"
#include "formats/rays/ray_set.h"
#include "formats/rays/texel_flux.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::rays {

/// Everything is chosen from the rays where it is not given.
struct ConvertOptions {
    /// Planes of the first slab (+z), mm along the ray file's z, u < s. Default: S where the rays
    /// are narrowest, U behind all ray starts and at least 2 S rectangles away.
    std::optional<double> u_plane_mm, s_plane_mm;
    std::optional<glm::ivec2> grid;    // W x H of every slab; more: sharper directions, more noise
    std::optional<glm::ivec2> texels;  // w x h of every slab; more: sharper places, more noise
    /// 1: directions with z > 0; 5: all but those that go mainly towards -z; 6: all. Several slabs
    /// share directions out by slab_shares. Default: the fewest that lose < 1 %.
    std::optional<int> slabs;
    std::string basis = "bspline";
    bool color = true;       // R, G, B where the rays have color; else one channel Y
    std::uint64_t seed = 1;  // of the folds of cross-validation
    std::function<void(double fraction)> progress;
};

/// Throws Error on an option out of its range.
void check(const ConvertOptions& options);

/// A conversion that loses more of the flux than this is not good enough unless the user allows it.
constexpr double kMostDropped = 0.02;

struct SlabReport {
    std::string axis;      // "+z", "+x", ...
    std::size_t rays = 0;  // whole or in part
    double flux = 0;
    double u_plane_mm = 0, s_plane_mm = 0;  // along the axis, from the ray file's origin
    TexelChoice texels;
    DirectionChoice directions;
    double texel_mm = 0;         // larger side
    double pitch_deg = 0;        // what a pitch blurs directions by, on the axis
    double sigma_texel_rel = 0;  // flux-weighted mean of relative sigma of a texel's flux
};

/// Smallest and largest angle from the ray file's +z of the rays that something happened to.
struct AngleRange {
    double least_deg = 180, most_deg = 0;  // none: least > most

    void add(glm::vec3 direction);
};

struct ConvertReport {
    double flux_in = 0, flux_out = 0;  // lm or W
    double dropped_direction = 0, dropped_u = 0, dropped_s = 0;
    AngleRange direction_angles, s_angles, u_angles;  // of what was dropped
    std::size_t rays_in = 0;
    double rays_dropped = 0;  // a ray whose part in one slab is dropped counts by that part
    double sigma_flux = 0;    // of flux_out, from the number of rays
    std::vector<SlabReport> slabs;

    double dropped() const { return dropped_direction + dropped_u + dropped_s; }
    bool is_good_enough() const { return dropped() <= kMostDropped * flux_in; }
};

struct Conversion {
    LightField lightfield;
    ConvertReport report;
};

/// Estimates the light field whose samples are the rays.
///
/// In      rays in the ray file's frame.
/// Out     slabs in the luminaire's frame: the ray file's, moved along z so that the first slab's S
/// is at z = 0.
///         Irradiance weighting. Sum over images of coefficient times integral = flux of the rays
///         kept. sigma: for windows wider than the smoothing it is the rays' Poisson error, before
///         the lamp an upper bound, and up to a third too small far away, where a window is one
///         pitch (docs/ray_files.md, "Sigma"). A ray that slabs share gives each as much of its
///         variance as of its flux, so that whoever sees all of it sees the variance of one ray.
/// Throws  Error on an option out of range, and where a slab's rays do not allow planes.
/// Cost    O(rays); 28 bytes a ray of one slab at a time beside the light field.
Conversion to_lightfield(const RaySet& set, const ConvertOptions& options);

}  // namespace nearfield::rays
