// SPDX-License-Identifier: Apache-2.0
/// What can be asked of a lamp, whether it is a light field or a photometric file.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/photometry/photometry.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace nearfield::farfield {

/// Directions are in the luminaire's frame, of unit length. Sigma is 0 where unknown.
struct LampView {
    double flux = 0, flux_sigma = 0;
    std::function<double(const glm::dvec3&direction)> intensity, intensity_sigma;
    const LightField* lightfield = nullptr;  // null: known from afar alone
};

/// The lamp must outlive its view.
LampView view_of(const LightField& lightfield);
LampView view_of(const photometry::Photometry& photometry);

/// A direction and how much flux it stands for, any scale.
struct WeightedDirection {
    glm::dvec3 direction{0, 0, 1};
    double weight = 1;
};

/// `count` directions where the lamp shines: a light field's are drawn, of equal weight; a table's
/// cover the sphere, weighted by intensity.
std::vector<WeightedDirection> lit_directions(const LampView& lamp, int count, std::uint32_t seed);

/// Where the light leaves: the mean point of rays, in the luminaire's frame, on the plane (S or U)
/// where each slab's rectangle is smaller.
glm::dvec3 light_center_m(const LightField& lightfield);

/// Diagonal of the first slab's smaller rectangle.
double lamp_size_m(const LightField& lightfield);

/// The value below which a part of all weight lies.
double weighted_quantile(std::vector<std::pair<double, double>> value_weight, double part);

}  // namespace nearfield::farfield
