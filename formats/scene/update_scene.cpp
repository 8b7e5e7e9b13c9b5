// SPDX-License-Identifier: Apache-2.0
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/scene/gltf_guard.h"
#include "formats/scene/reading.h"
#include "formats/scene/scene.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace nearfield {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kUpdating = "cannot save scene";

ordered_json& array_of(ordered_json& object, const char* key) {
    if (!object.contains(key))
        object[key] = ordered_json::array();
    return object[key];
}

/// Characters that a URI holds as they are.
bool is_plain(unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("-._~/!$&'()*+,;=@").find(static_cast<char>(c)) != std::string::npos;
}

std::string percent_encoded(const std::string& text) {
    std::string encoded;
    for (const char c : text)
        encoded += is_plain(static_cast<unsigned char>(c))
                       ? std::string(1, c)
                       : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return encoded;
}

fs::path folder_of(const std::string& path) {
    return fs::absolute(path).lexically_normal().parent_path();
}

/// A file as a URI of a scene in `folder`.
std::string uri_from(const fs::path& folder, const std::string& file) {
    const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(folder);
    if (relative.empty())
        throw Error{kUpdating, file, "a file that a path from the scene leads to", "none"};
    return percent_encoded(relative.generic_string());
}

/// Side files of a scene that moves to another folder.
void move_uris(ordered_json& document, const std::string& from, const fs::path& to) {
    for (const char* key : {"buffers", "images"})
        if (document.contains(key))
            for (ordered_json& part : document[key]) {
                const std::string uri = part.value("uri", std::string());
                if (!uri.empty() && !uri.starts_with("data:"))
                    part["uri"] = uri_from(to, gltf::resolve_uri(uri, from, kUpdating));
            }
}

ordered_json matrix_json(const glm::dmat4& matrix) {
    ordered_json numbers = ordered_json::array();
    for (int i = 0; i < 16; ++i)
        numbers.push_back(matrix[i / 4][i % 4]);
    return numbers;
}

void set_matrix(ordered_json& node, const glm::dmat4& matrix) {
    for (const char* key : {"translation", "rotation", "scale"})
        node.erase(key);
    node["matrix"] = matrix_json(matrix);
}

/// Members that the lamp has as they were stay as they are written.
void set_lamp(ordered_json& node, const LuminaireInstance& lamp) {
    ordered_json& extension = node["extensions"][gltf::kLuminaireExtension];
    const auto set = [&](const char* key, const ordered_json& value, bool is_default) {
        if (!is_default || extension.contains(key))
            extension[key] = value;
    };
    set("on", lamp.on, lamp.on);
    set("dim", lamp.dim, lamp.dim == 1.0);
    set("tint", {lamp.tint.r, lamp.tint.g, lamp.tint.b}, lamp.tint == glm::vec3(1.0F));
    set("excludes", lamp.excludes, lamp.excludes.empty());
    if (!lamp.name.empty())
        node["name"] = lamp.name;
}

ordered_json& add_node(ordered_json& document, const std::string& name, const glm::dmat4& matrix) {
    ordered_json& nodes = array_of(document, "nodes");
    const std::size_t scene = document.value("scene", std::size_t{0});
    array_of(document["scenes"][scene], "nodes").push_back(nodes.size());
    nodes.push_back({{"name", name}, {"matrix", matrix_json(matrix)}});
    return nodes.back();
}

void add_camera(ordered_json& document, const Camera& camera) {
    ordered_json& cameras = array_of(document, "cameras");
    ordered_json perspective = {{"yfov", camera.yfov_rad}, {"znear", 0.01}};  // glTF demands it
    if (camera.aspect > 0.0)
        perspective["aspectRatio"] = camera.aspect;
    cameras.push_back(
        {{"name", camera.name}, {"type", "perspective"}, {"perspective", perspective}});
    const std::size_t index = cameras.size() - 1;
    add_node(document, camera.name, camera.world_from_camera)["camera"] = index;
}

/// A lamp of which the document's node was read: what it was, to know what is new.
using Known = std::map<int, LuminaireInstance>;

void drop_lamps(ordered_json& document, const Known& known, const std::set<int>& kept) {
    for (const auto& [index, lamp] : known)
        if (!kept.contains(index)) {
            ordered_json& node = document["nodes"][static_cast<std::size_t>(index)];
            node["extensions"].erase(gltf::kLuminaireExtension);
            if (node["extensions"].empty())
                node.erase("extensions");
        }
}

}  // namespace

void update_scene(const std::string& from, const SceneUpdate& update, const std::string& path) {
    const gltf::GuardedFile file = gltf::read_guarded(from, gltf::Members::All);
    const Scene before = read_scene(from);
    ordered_json document = ordered_json::parse(file.json);
    const fs::path folder = folder_of(path);
    const bool is_moved = folder != folder_of(from);
    if (is_moved)
        move_uris(document, file.base_folder, folder);
    Known known;
    for (const LuminaireInstance& lamp : before.luminaires)
        known.emplace(lamp.node, lamp);
    std::set<int> kept;
    for (const LuminaireInstance& lamp : update.luminaires) {
        const auto found = known.find(lamp.node);
        const bool is_new = found == known.end() || !kept.insert(lamp.node).second;
        ordered_json& node = is_new ? add_node(document, lamp.name, lamp.world_from_luminaire)
                                    : document["nodes"][static_cast<std::size_t>(lamp.node)];
        if (!is_new && found->second.world_from_luminaire != lamp.world_from_luminaire)
            set_matrix(node, glm::inverse(lamp.world_from_parent) * lamp.world_from_luminaire);
        if (is_new || is_moved || found->second.path != lamp.path)
            node["extensions"][gltf::kLuminaireExtension]["uri"] = uri_from(folder, lamp.path);
        set_lamp(node, lamp);
    }
    drop_lamps(document, known, kept);
    for (const Camera& camera : update.new_cameras)
        add_camera(document, camera);
    ordered_json& used = array_of(document, "extensionsUsed");
    if (!update.luminaires.empty() &&
        std::find(used.begin(), used.end(), gltf::kLuminaireExtension) == used.end())
        used.push_back(gltf::kLuminaireExtension);
    if (used.empty())
        document.erase("extensionsUsed");
    gltf::GuardedFile changed = file;
    changed.json = document.dump(2) + "\n";
    write_file(file.is_binary ? gltf::join_glb(changed) : changed.json, path);
}

}  // namespace nearfield
