// SPDX-License-Identifier: Apache-2.0
/// Lobes in double, written from their papers in angles and complex numbers, without the shared
/// headers' rearrangements; and coordinates in which lobes of any width can be integrated.
#pragma once

#include "formats/shared/brdf.glsl.h"
#include "tests/support/random.h"

#include <glm/glm.hpp>

#include <functional>
#include <string>
#include <vector>

namespace nearfield::test {

/// A lobe to be tested, of weight 1 without diffuse part (GGX: Fresnel's factor is 1).
struct LobeCase {
    std::string name;
    shared::Brdf brdf;
};

/// Every kind, wide and narrow; the narrow ones of about 0.3 to 3 degrees.
std::vector<LobeCase> lobe_cases();

/// f_r of the lobe. Directions above the surface, in the local frame.
double oracle_lobe(const shared::Brdf& brdf, glm::dvec3 to_light, glm::dvec3 to_viewer);

/// A viewer at an angle to the normal and an azimuth.
glm::vec3 viewer_at(double angle_rad, double azimuth_rad = 0.7);

/// Middle of the lobe: where the light is mirrored, or Lafortune's axis.
glm::dvec3 lobe_middle(const shared::Brdf& brdf, glm::vec3 to_viewer);

/// The unit square (u, v) as directions about a lobe's middle, u outwards, v around; smooth, and so
/// stretched that a lobe of any width is resolved; it covers the hemisphere. GGX and Ward: by the
/// half vector's slopes in units of alpha; else by the hemisphere's projection.
class LobeMap {
  public:
    LobeMap(const shared::Brdf& brdf, glm::vec3 to_viewer);

    struct Point {
        glm::dvec3 direction;
        double solid_angle;  // d omega/(du dv)
    };
    Point at(double u, double v) const;
    glm::dvec2 inverse(glm::dvec3 direction) const;

  private:
    Point half_vector_at(double u, double v) const;
    glm::dvec2 half_vector_inverse(glm::dvec3 direction) const;
    double largest_share(double azimuth) const;

    bool is_of_half_vectors_;
    glm::dvec2 alpha_;
    glm::dvec3 to_viewer_;
    glm::dvec3 middle_;
    double scale_ = 1.0;
};

/// Uniform in [0, 1)^2, of 24 bits as the renderers' numbers are.
glm::vec2 random_pair(support::Random& random);

/// Integral over u0 ... u1, v0 ... v1 of the map by Gauss' rule with `order` nodes a side.
double integrate(const LobeMap& map,
                 glm::dvec4 u0_u1_v0_v1,
                 int order,
                 const std::function<double(glm::dvec3)>& value);

/// Over the whole map, by `pieces` x `pieces` parts of 8 x 8 nodes.
double integrate(const LobeMap& map, int pieces, const std::function<double(glm::dvec3)>& value);

}  // namespace nearfield::test
