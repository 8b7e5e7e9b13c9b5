// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene.h"

#include "formats/files/error.h"
#include "formats/scene/brdf_extension.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield {

shared::Brdf brdf(const Material& material) {
    return material.given_brdf ? *material.given_brdf
                               : gltf::default_brdf(material, shared::kBrdfPhong);
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
