// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/brdf_extension.h"

#include <algorithm>

namespace nearfield::gltf {

const BrdfModel* find_brdf_model(const std::string& name) {
    const auto* found = std::find_if(kBrdfModels.begin(), kBrdfModels.end(),
                                     [&](const BrdfModel& model) { return name == model.name; });
    return found == kBrdfModels.end() ? nullptr : found;
}

const BrdfModel& brdf_model(shared::uint kind) {
    return *std::find_if(kBrdfModels.begin(), kBrdfModels.end(),
                         [&](const BrdfModel& model) { return kind == model.kind; });
}

std::string brdf_model_names() {
    std::string names;
    for (const BrdfModel& model : kBrdfModels)
        names += (names.empty() ? "" : ", ") + std::string(model.name);
    return names;
}

// glTF's metallic-roughness model has no exact Phong counterpart; this mapping keeps three things:
// a dielectric of roughness 1 is Lambert's with the base color as albedo, a metal reflects its base
// color without diffuse part, and diffuse + specular <= 1. alpha = roughness^2 (glTF 2.0, appendix
// B); an exponent of 2/alpha^2 - 2 gives Phong's lobe about the half vector the width of GGX
// (Walter et al. 2007); about the mirror direction it is a quarter.
shared::Brdf default_brdf(const Material& material, shared::uint kind) {
    constexpr float kDielectricF0 = 0.04F;  // glTF 2.0, appendix B.2: index of refraction 1.5
    // A lobe of 0.6 degrees: smoother glTF materials are mirrors, which need no light sampling.
    constexpr float kLargestExponent = 1e4F;

    const float alpha = material.roughness * material.roughness;
    // GGX knows Fresnel's and masking's share itself; Phong's dielectrics fade out with roughness.
    const float dielectric =
        kind == shared::kBrdfGgx ? kDielectricF0 : kDielectricF0 * (1.0F - alpha);
    const float below_surface = kind == shared::kBrdfGgx ? 1.0F : 1.0F - dielectric;
    shared::Brdf brdf{};
    brdf.kind = kind;
    brdf.diffuse = material.base_color * ((1.0F - material.metallic) * below_surface);
    brdf.specular = glm::mix(glm::vec3(dielectric), material.base_color, material.metallic);
    const float half_vector_exponent = 2.0F / std::max(alpha * alpha, 1e-6F) - 2.0F;
    brdf.exponent = std::min(0.25F * half_vector_exponent, kLargestExponent);
    brdf.alpha = glm::vec2(std::max(alpha, kSmallestBrdfAlpha));
    brdf.cosines = glm::vec3(-1.0F, -1.0F, 1.0F);
    return brdf;
}

}  // namespace nearfield::gltf
