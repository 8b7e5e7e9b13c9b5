// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield {

// glTF's metallic-roughness model has no exact Phong counterpart; this mapping keeps three things:
// a dielectric of roughness 1 is Lambert's with the base color as albedo, a metal reflects its base
// color without diffuse part, and diffuse + specular <= 1. alpha = roughness^2 (glTF 2.0, appendix
// B); an exponent of 2/alpha^2 - 2 gives Phong's lobe about the half vector the width of GGX
// (Walter et al. 2007); about the mirror direction it is a quarter.
Reflectance reflectance(const Material& material) {
    constexpr float kDielectricF0 = 0.04F;  // glTF 2.0, appendix B.2: index of refraction 1.5
    constexpr float kLargestExponent =
        1e4F;  // lobe of 0.8 degrees; narrower ones need a mirror, not samples

    const float alpha = material.roughness * material.roughness;
    const float dielectric = kDielectricF0 * (1.0F - alpha);
    Reflectance result;
    result.diffuse = material.base_color * ((1.0F - material.metallic) * (1.0F - dielectric));
    result.specular = glm::mix(glm::vec3(dielectric), material.base_color, material.metallic);
    const float half_vector_exponent = 2.0F / std::max(alpha * alpha, 1e-6F) - 2.0F;
    result.exponent = std::min(0.25F * half_vector_exponent, kLargestExponent);
    return result;
}

bool is_excluded(const Scene& scene, const LuminaireInstance& luminaire, const Instance& instance) {
    const std::string& mesh_name = scene.meshes[static_cast<std::size_t>(instance.mesh)].name;
    return std::any_of(
        luminaire.excludes.begin(), luminaire.excludes.end(),
        [&](const std::string& name) { return name == instance.name || name == mesh_name; });
}

double uniform_scale(const glm::dmat4& matrix, const std::string& where) {
    // Relative difference that files with matrices in float show.
    constexpr double kTolerance = 1e-5;

    const glm::dmat3 linear(matrix);
    const glm::dmat3 gram = glm::transpose(linear) * linear;
    const double square = (gram[0][0] + gram[1][1] + gram[2][2]) / 3.0;
    double worst = 0.0;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            worst = std::max(worst, std::abs(gram[column][row] - (column == row ? square : 0.0)));
    if (!(square > 0.0) || !(worst <= 2.0 * kTolerance * square))
        throw Error{"cannot place a luminaire", where, "one scale factor > 0 for all axes",
                    fmt::format("factors {:.6g}, {:.6g}, {:.6g}{}", std::sqrt(gram[0][0]),
                                std::sqrt(gram[1][1]), std::sqrt(gram[2][2]),
                                worst > 0.0 ? " or axes that are not square" : "")};
    return std::copysign(std::sqrt(square), glm::determinant(linear));
}

}  // namespace nearfield
