// SPDX-License-Identifier: Apache-2.0
/// Small TM-25 files and ray sets that tests make for themselves.
#pragma once

#include "formats/rays/ray_set.h"

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::test {

/// What goes into a TM-25 file; the writer adds nothing and checks nothing.
struct RayFile {
    std::string magic = "TM25";
    std::int32_t version = 2013, spectral_data = 0;
    float luminous_flux_lm = 0, radiant_flux_w = 0, wavelength_nm = 0;
    std::uint64_t ray_count = 0;
    /// position, direction, radiant flux, wavelength, luminous flux, Stokes, tristimulus, spectrum
    /// index
    std::vector<std::int32_t> flags = {1, 1, 0, 0, 1, 0, 0, 0};
    std::vector<std::vector<std::pair<float, float>>> tables;
    std::vector<std::vector<float>> rows;  // one a ray
};

std::string to_bytes(const RayFile& file);

/// Position mm, direction, luminous flux of every ray.
RayFile to_file(const std::vector<rays::Ray>& rays);

/// Writes bytes to a file of this name in the working directory; returns the name.
std::string write_bytes(const std::string& name, const std::string& bytes);

/// Uniform in [0, 1): splitmix64 of seed and index.
double uniform(std::uint64_t seed, std::uint64_t index);

/// A Lambertian disk of radius_m in the plane z = z_m around the origin, towards +z; equal flux a
/// ray, total flux_lm. Ray r starts `run_m` times a random number beyond the disk, along its
/// direction.
std::vector<rays::Ray> lambertian_disk(std::size_t count,
                                       double radius_m,
                                       double z_m,
                                       double flux_lm,
                                       std::uint64_t seed,
                                       double run_m = 0.0);

}  // namespace nearfield::test
