// SPDX-License-Identifier: Apache-2.0
/// A glTF document on its way to a Scene. Each function reads one kind of part and throws Error
/// with file and JSON place; they are called in this order.
#pragma once

#include "formats/scene/gltf_guard.h"
#include "formats/scene/scene.h"

#include <tiny_gltf.h>

#include <cstddef>
#include <string>
#include <vector>

namespace nearfield::gltf {

constexpr const char* kLuminaireExtension = "NEARFIELD_luminaire";
constexpr const char* kEnvironmentExtension = "NEARFIELD_environment";

/// The document and what its parts have become.
struct Reading {
    std::string path, base_folder;
    tinygltf::Model model;
    Scene scene;
    std::vector<std::vector<int>> meshes_of;  // scene meshes (one a primitive) of each glTF mesh

    std::string at(const std::string& place) const { return path + ": " + place; }
};

void read_materials(Reading& reading);

/// Index of the scene's material for a primitive; glTF's default material is appended where it is
/// needed.
int material_index(Reading& reading, int index, const std::string& where);

void read_meshes(Reading& reading);

/// Instances, cameras and luminaires.
void read_nodes(Reading& reading);

/// Of the scene that is shown.
void read_environment(Reading& reading);

}  // namespace nearfield::gltf
