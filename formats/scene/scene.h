// SPDX-License-Identifier: Apache-2.0
/// A scene: triangles, materials, cameras and luminaires, read from and written to glTF 2.0
/// (docs/scenes.md).
///
/// Frames  metres, right-handed; a camera looks along its -z with +y up; a luminaire shines along
/// its +z. Colors  linear Rec.709.
#pragma once

#include "formats/shared/brdf.glsl.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nearfield {

/// glTF's metallic-roughness parameters, and the BRDF that stands in their place where the file has
/// the extension NEARFIELD_brdf.
struct Material {
    std::string name;
    glm::vec3 base_color{0.8F};
    float metallic = 0.0F;   // 0 ... 1
    float roughness = 1.0F;  // 0 ... 1; a dielectric of roughness 1 is exactly Lambert's
    std::optional<shared::Brdf> given_brdf = std::nullopt;
};

/// What light the material reflects: the given BRDF, or Lambert's with Phong's lobe from the
/// metallic-roughness parameters (docs/scenes.md, "Materials").
shared::Brdf brdf(const Material& material);

/// One glTF primitive: triangles of one material.
struct Mesh {
    std::string name;
    std::vector<glm::vec3> positions_m;
    std::vector<glm::vec3> normals;  // unit length, one a position; empty: the triangles' own
    std::vector<glm::uvec3> triangles;
    int material = 0;  // index into Scene::materials
    /// Direction of brushing, unit length, one a position; empty: frame_from_normal decides. The
    /// local frame is frame_from_tangent(normal, tangent), both interpolated; a tangent is
    /// transformed like an edge. Lobes are even in the frame's y: its sign does not matter.
    std::vector<glm::vec3> tangents = {};
};

struct Instance {
    std::string name;  // the node's
    int mesh = 0;      // index into Scene::meshes
    glm::dmat4 world_from_mesh{1.0};
};

struct Camera {
    std::string name;
    glm::dmat4 world_from_camera{1.0};
    double yfov_rad = 0.8;  // full vertical angle of view
    double aspect = 0.0;    // width / height of the picture it was made for; 0: unknown
};

/// A lamp in the scene. Its matrix is a rotation, mirroring or not, times one scale factor, and a
/// translation.
struct LuminaireInstance {
    std::string name;
    std::string uri;   // of the light field, relative to the scene's folder
    std::string path;  // the file that uri names
    glm::dmat4 world_from_luminaire{
        1.0};  // its scale is geometric and keeps radiance: flux goes with its square
    bool on = true;
    double dim = 1.0;                   // factor of its radiance, >= 0
    glm::vec3 tint{1.0F};               // factors of its red, green and blue, 0 ... 1
    std::vector<std::string> excludes;  // nodes or meshes by name that cast no shadow in its light
    int node = -1;                      // of the file that it was read from; -1: of none
    glm::dmat4 world_from_parent{1.0};  // of that node's parent
};

/// Light from far away all around (formats/environment).
struct SceneEnvironment {
    std::string uri;   // of the latitude-longitude picture, relative to the scene's folder
    std::string path;  // the file that uri names
    glm::dmat3 world_from_environment{1.0};  // a rotation
    double intensity = 1.0;                  // radiance is the picture's times this, >= 0
};

struct Scene {
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<Camera> cameras;
    std::vector<LuminaireInstance> luminaires;
    std::optional<SceneEnvironment> environment = std::nullopt;
    std::vector<std::string> notes;  // what the file holds and this reader leaves out
};

/// Whether the luminaire's light passes through the instance.
bool is_excluded(const Scene& scene, const LuminaireInstance& luminaire, const Instance& instance);

/// The scale factor of a matrix as LuminaireInstance wants it; negative where it mirrors.
/// Throws Error naming `where` if the matrix scales the axes differently or shears.
double uniform_scale(const glm::dmat4& matrix, const std::string& where);

/// Reads .gltf or .glb. Luminaires and the environment are not opened.
/// Throws Error with file and JSON place, such as "scene.gltf:
/// nodes[3].extensions.NEARFIELD_luminaire.dim".
Scene read_scene(const std::string& path);

/// What becomes of a scene's file. Luminaires whose `node` is one of the file's are that node's;
/// the others get nodes of their own, and nodes that none of them is of are lamps no longer.
struct SceneUpdate {
    std::vector<LuminaireInstance> luminaires;
    std::vector<Camera> new_cameras;  // added
};

/// Writes the scene of the file `from` with other luminaires to `path`, which may be the same:
/// whatever else the file holds, known to this project or not, stays as it is. The two are both
/// .gltf or both .glb. Files that it names are named from path's folder. Throws Error where
/// read_scene would, and where path cannot be written; whole or not at all.
void update_scene(const std::string& from, const SceneUpdate& update, const std::string& path);

enum class BufferPlace { Embedded, SideFile };

/// Writes .gltf with its buffer embedded or as NAME.bin beside it, or .glb, by the path's ending;
/// whole or not at all.
void write_scene(const Scene& scene,
                 const std::string& path,
                 BufferPlace buffer = BufferPlace::Embedded);

}  // namespace nearfield
