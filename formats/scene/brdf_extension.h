// SPDX-License-Identifier: Apache-2.0
/// The material extension NEARFIELD_brdf: its models and their members (docs/scenes.md).
#pragma once

#include "formats/scene/scene.h"

#include <array>
#include <string>

namespace nearfield::gltf {

constexpr const char* kBrdfExtension = "NEARFIELD_brdf";

/// Below it a lobe is a mirror's: 0.1 degrees, and float directions have few digits left.
constexpr float kSmallestBrdfAlpha = 1e-3F, kLargestBrdfAlpha = 1.0F;
/// A lobe of 0.06 degrees.
constexpr float kLargestBrdfExponent = 1e6F;

/// A model: its name in files, its kind, and its members of shape besides the colors (nullptr:
/// none).
struct BrdfModel {
    const char* name;
    shared::uint kind;
    std::array<const char*, 2> shape;
};

constexpr std::array<BrdfModel, 5> kBrdfModels = {
    {{"phong", shared::kBrdfPhong, {"exponent", nullptr}},
     {"ggx", shared::kBrdfGgx, {"alpha", nullptr}},
     {"ward", shared::kBrdfWard, {"alpha", nullptr}},
     {"lafortune", shared::kBrdfLafortune, {"exponent", "cosines"}},
     {"halfway_disk", shared::kBrdfHalfwayDisk, {"exponent", nullptr}}}};

/// nullptr where there is none.
const BrdfModel* find_brdf_model(const std::string& name);
const BrdfModel& brdf_model(shared::uint kind);

/// "phong, ggx, ..."
std::string brdf_model_names();

/// A material's lobe before the extension's members are read: colors and roughness from glTF's own
/// factors.
shared::Brdf default_brdf(const Material& material, shared::uint kind);

}  // namespace nearfield::gltf
