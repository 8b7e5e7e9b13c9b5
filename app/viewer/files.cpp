// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/files.h"

#include "app/viewer/view.h"
#include "formats/files/error.h"
#include "formats/files/lightfield.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace nearfield::viewer {
namespace {

namespace fs = std::filesystem;

bool is_scene(const std::string& path) {
    const std::string ending = fs::path(path).extension().string();
    return ending == ".gltf" || ending == ".glb";
}

Mesh box(const std::string& name, glm::vec3 low_m, glm::vec3 high_m, int material) {
    Mesh mesh;
    mesh.name = name;
    mesh.material = material;
    for (unsigned c = 0; c < 8; ++c)
        mesh.positions_m.emplace_back((c & 1U) != 0 ? high_m.x : low_m.x,
                                      (c & 2U) != 0 ? high_m.y : low_m.y,
                                      (c & 4U) != 0 ? high_m.z : low_m.z);
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

void add(Scene& scene, Mesh mesh) {
    const std::string name = mesh.name;
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back({name, static_cast<int>(scene.meshes.size()) - 1, glm::dmat4(1.0)});
}

/// A lamp 0.65 m over a floor, its U plane at z = 0, before a wall 8 m away.
Scene stock_scene(const std::string& path) {
    const LightField lightfield = read_lightfield(path);
    Scene scene;
    scene.materials = {
        {"floor", glm::vec3(0.35F)}, {"wall", glm::vec3(0.7F)}, {"post", {0.6F, 0.25F, 0.2F}}};
    add(scene, box("floor", {-6.0F, -0.1F, -2.0F}, {6.0F, 0.0F, 8.0F}, 0));
    add(scene, box("wall", {-6.0F, -0.1F, 8.0F}, {6.0F, 4.0F, 8.1F}, 1));
    add(scene, box("post", {0.45F, 0.0F, 4.0F}, {0.55F, 1.0F, 4.1F}, 2));
    const double delta_m = lightfield.slabs.front().delta_m;
    scene.luminaires.push_back(
        lamp_of(path, glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 0.65, delta_m))));
    Camera camera = look_at({1.6, 2.0, -1.8}, {0.0, 0.5, 5.0}, glm::radians(50.0)).camera;
    camera.name = "stock";
    scene.cameras = {camera};
    return scene;
}

bool has_camera(const Scene& scene, const std::string& name) {
    return std::any_of(scene.cameras.begin(), scene.cameras.end(),
                       [&](const Camera& camera) { return camera.name == name; });
}

}  // namespace

Opened open_document(const std::string& path) {
    if (!is_scene(path) && fs::exists(path))
        return {document_of(stock_scene(path), ""), {}};
    Scene scene = read_scene(path);
    std::vector<std::string> notes = scene.notes;
    return {document_of(std::move(scene), path), std::move(notes)};
}

LuminaireInstance lamp_of(const std::string& path, const glm::dmat4& world_from_luminaire) {
    read_kind(path);  // throws where it is none
    LuminaireInstance lamp;
    lamp.name = fs::path(path).stem().stem().string();
    lamp.path = fs::absolute(path).lexically_normal().string();
    lamp.world_from_luminaire = world_from_luminaire;
    return lamp;
}

Document save_document(const Document& document, const std::string& path) {
    if (!is_scene(path))
        throw Error{"cannot save scene", path, ".gltf or .glb", "another ending"};
    SceneUpdate update;
    for (const EditedLamp& lamp : document.lamps)
        update.luminaires.push_back(lamp.luminaire);
    std::string from = document.path;
    if (from.empty()) {
        Scene whole = *document.scene;
        whole.luminaires.clear();
        write_scene(whole, path);
        from = path;
    }
    // Those of an earlier save are there.
    for (const Camera& bookmark : document.bookmarks)
        if (!has_camera(read_scene(from), bookmark.name))
            update.new_cameras.push_back(bookmark);
    update_scene(from, update, path);
    // Nodes are numbered anew; ids, which lights are known by, stay.
    Document saved = document;
    const Scene written = read_scene(path);
    for (const LuminaireInstance& lamp : written.luminaires) {
        const auto same =
            std::find_if(saved.lamps.begin(), saved.lamps.end(), [&](const EditedLamp& one) {
                return one.luminaire.name == lamp.name && one.luminaire.node < 0;
            });
        if (same != saved.lamps.end()) {
            same->luminaire.node = lamp.node;
            same->luminaire.uri = lamp.uri;
        }
    }
    saved.path = path;
    return saved;
}

std::string autosave_path(const std::string& path) {
    const fs::path file(path);
    return (file.parent_path() / (file.stem().string() + ".autosave" + file.extension().string()))
        .string();
}

}  // namespace nearfield::viewer
