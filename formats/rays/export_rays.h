// SPDX-License-Identifier: Apache-2.0
/// A light field as a ray file: rays of equal flux, drawn by model::Emission, written as they come.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/rays/ray_writer.h"

#include <cstdint>
#include <functional>
#include <string>

namespace nearfield::rays {

/// Where a ray's position lies on its line.
enum class RayStart {
    S,       // on the image plane of its slab
    U,       // on the basis plane behind it
    Sphere,  // where it leaves a sphere around the luminaire's origin
};

/// The file's axis that the luminaire's +z becomes; the others follow cyclically, so that the frame
/// stays right-handed.
enum class LightAxis { PlusX, MinusX, PlusY, MinusY, PlusZ, MinusZ };

struct ExportOptions {
    RayFormat format = RayFormat::Tm25;
    std::uint64_t rays = 1'000'000;
    std::uint32_t seed = 0;
    RayStart start = RayStart::S;
    double sphere_radius_m = 0;
    LightAxis axis = LightAxis::PlusZ;
    glm::dvec3 origin_m{0.0};  // where the luminaire's origin lies in the file
    bool has_color = true;     // where light field and format have it
    std::function<void(double fraction)> progress;
};

/// Writes the file. The rays' sum is the light field's flux. Rays are a function of light field,
/// seed and number alone, whatever the number of threads. Throws Error where the sphere does not
/// hold all slabs, or as RayWriter.
void export_rays(const LightField& lightfield,
                 const std::string& path,
                 const ExportOptions& options);

/// Rotation that takes the luminaire's axes to the file's.
glm::dmat3 file_from_luminaire(LightAxis axis);

/// The radius of the smallest sphere around the luminaire's origin that holds the planes' lit
/// rectangles of all slabs.
double enclosing_radius_m(const LightField& lightfield);

}  // namespace nearfield::rays
