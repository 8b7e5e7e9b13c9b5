// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/scene/brdf_extension.h"
#include "formats/scene/gltf_guard.h"
#include "formats/scene/reading.h"
#include "formats/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace nearfield {
namespace {

using gltf::kBrdfExtension, gltf::kEnvironmentExtension, gltf::kLuminaireExtension,
    gltf::kReadingScene, gltf::Reading;

tinygltf::Model load_model(const std::string& path, const gltf::GuardedFile& file) {
    tinygltf::TinyGLTF loader;
    // The library's own path expansion runs a shell's word expansion on names found in the file.
    loader.SetFsCallbacks({&tinygltf::FileExists,
                           [](const std::string& name, void* /*user*/) { return name; },
                           &tinygltf::ReadWholeFile, &tinygltf::WriteWholeFile, nullptr});
    tinygltf::Model model;
    std::string error, warning;
    bool loaded = false;
    try {
        if (file.is_binary) {
            const std::string glb = gltf::join_glb(file);
            loaded = loader.LoadBinaryFromMemory(
                &model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
                static_cast<unsigned>(glb.size()), file.base_folder);
        } else {
            loaded = loader.LoadASCIIFromString(&model, &error, &warning, file.json.data(),
                                                static_cast<unsigned>(file.json.size()),
                                                file.base_folder);
        }
    } catch (const std::exception& failure) {
        error = failure.what();
    }
    if (!loaded)
        throw Error{kReadingScene, path, "glTF 2.0", error.substr(0, 200)};
    return model;
}

void check_extensions(const Reading& reading) {
    for (const std::string& name : reading.model.extensionsRequired)
        if (name != kLuminaireExtension && name != kBrdfExtension && name != kEnvironmentExtension)
            throw Error{kReadingScene, reading.at("extensionsRequired"),
                        fmt::format("{}, {} or {}", kLuminaireExtension, kBrdfExtension,
                                    kEnvironmentExtension),
                        name.substr(0, 60)};
    const auto& used = reading.model.extensionsUsed;
    const auto demand = [&](const char* name, bool is_used) {
        if (is_used && std::find(used.begin(), used.end(), name) == used.end())
            throw Error{kReadingScene, reading.at("extensionsUsed"), name, "none"};
    };
    demand(kLuminaireExtension, !reading.scene.luminaires.empty());
    demand(kEnvironmentExtension, reading.scene.environment.has_value());
    demand(kBrdfExtension,
           std::any_of(reading.scene.materials.begin(), reading.scene.materials.end(),
                       [](const Material& material) { return material.given_brdf.has_value(); }));
}

/// A name that excludes nothing is a typing error that would show as a shadow.
void check_excludes(const Reading& reading) {
    std::set<std::string> names;
    for (const Instance& instance : reading.scene.instances) {
        names.insert(instance.name);
        names.insert(reading.scene.meshes[static_cast<std::size_t>(instance.mesh)].name);
    }
    for (const LuminaireInstance& lamp : reading.scene.luminaires)
        for (const std::string& name : lamp.excludes)
            if (names.count(name) == 0)
                throw Error{
                    kReadingScene,
                    reading.at(fmt::format("{} '{}', excludes", kLuminaireExtension, lamp.name)),
                    "the name of a mesh or of a node that has one", "'" + name.substr(0, 60) + "'"};
}

}  // namespace

Scene read_scene(const std::string& path) {
    Reading reading;
    reading.path = path;
    const gltf::GuardedFile file = gltf::read_guarded(path);
    reading.base_folder = file.base_folder;
    reading.model = load_model(path, file);
    gltf::read_materials(reading);
    gltf::read_meshes(reading);
    gltf::read_nodes(reading);
    gltf::read_environment(reading);
    check_extensions(reading);
    check_excludes(reading);
    return std::move(reading.scene);
}

}  // namespace nearfield
