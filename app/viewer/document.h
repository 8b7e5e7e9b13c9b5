// SPDX-License-Identifier: Apache-2.0
/// What is edited in the viewer, as values: an edit makes a new document of an old one.
#pragma once

#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace nearfield::viewer {

/// Two lamps of which one moves as the other's mirror image.
struct Mirror {
    int partner = -1;  // id
    glm::dvec3 point_world_m{0.0}, normal{1.0, 0.0, 0.0};
};

struct EditedLamp {
    int id = 0;  // never given twice within a document and its history
    LuminaireInstance luminaire;
    std::optional<Mirror> mirror = std::nullopt;
};

struct Document {
    std::string path;                    // of the scene; empty: none yet
    std::shared_ptr<const Scene> scene;  // as read: all but its luminaires counts
    std::vector<EditedLamp> lamps;
    std::vector<Camera> bookmarks;  // beside the scene's cameras
    int next_id = 0;
};

/// A document of a scene as it was read.
Document document_of(Scene scene, const std::string& path);

/// The scene as edited, as renderers take it.
Scene edited_scene(const Document& document);

const EditedLamp* find_lamp(const Document& document, int id);

/// On, and not dimmed to nothing.
bool is_lit(const EditedLamp& lamp);
/// Whether one's light is the other's, but for dim and tint.
bool is_alike(const EditedLamp& a, const EditedLamp& b);

struct SetPose {
    int lamp = 0;
    glm::dmat4 world_from_luminaire{1.0};  // a partner follows, mirrored
};
struct SetDim {
    int lamp = 0;
    double dim = 1.0;
};
struct SetTint {
    int lamp = 0;
    glm::vec3 tint{1.0F};
};
struct SetOn {
    int lamp = 0;
    bool on = true;
};
struct SetName {
    int lamp = 0;
    std::string name;
};
/// Turns a lamp, which stays where it is, so that its axis goes through a point.
struct Aim {
    int lamp = 0;
    glm::dvec3 at_world_m{0.0};
};
struct Duplicate {
    int lamp = 0;
    glm::dvec3 by_world_m{0.0};  // where the copy is
};
/// Copies a lamp to its mirror image; the two are partners from then on.
struct AddMirrorImage {
    int lamp = 0;
    glm::dvec3 point_world_m{0.0}, normal{1.0, 0.0, 0.0};
};
/// Makes two lamps partners about the plane halfway between them.
struct MakePartners {
    int lamp = 0, other = 0;
};
struct PartPartners {
    int lamp = 0;
};
struct Remove {
    int lamp = 0;
};
struct Add {
    LuminaireInstance luminaire;
};
struct AddBookmark {
    Camera camera;
};

using Edit = std::variant<SetPose,
                          SetDim,
                          SetTint,
                          SetOn,
                          SetName,
                          Aim,
                          Duplicate,
                          AddMirrorImage,
                          MakePartners,
                          PartPartners,
                          Remove,
                          Add,
                          AddBookmark>;

/// The document after the edit. One that names a lamp that is not there, or says what a file could
/// not hold (a dim below 0 or above 1e9, a tint outside 0 ... 1, a pose that is not finite),
/// changes nothing. Names of lamps and bookmarks stay unique.
Document edited(const Document& document, const Edit& edit);

/// In a word or two, for the list of what can be undone.
std::string name_of(const Edit& edit);

/// The matrix that mirrors points of the world in a plane.
glm::dmat4 mirror_matrix(glm::dvec3 point_world_m, glm::dvec3 normal);

}  // namespace nearfield::viewer
