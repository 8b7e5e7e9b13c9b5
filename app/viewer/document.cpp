// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/document.h"

#include "app/viewer/pose.h"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace nearfield::viewer {
namespace {

EditedLamp* find(Document& document, int id) {
    const auto found = std::find_if(document.lamps.begin(), document.lamps.end(),
                                    [id](const EditedLamp& lamp) { return lamp.id == id; });
    return found == document.lamps.end() ? nullptr : &*found;
}

bool is_finite(const glm::dmat4& matrix) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!(std::abs(matrix[column][row]) <= 1e9))
                return false;
    return std::abs(glm::determinant(glm::dmat3(matrix))) > 1e-12;
}

/// `wanted`, or with a number where something has that name.
std::string unique_name(const std::string& wanted, const std::set<std::string>& taken) {
    std::string name = wanted;
    for (int k = 2; taken.contains(name); ++k)
        name = fmt::format("{} {}", wanted, k);
    return name;
}

std::string unique_lamp_name(const Document& document, const std::string& wanted, int but) {
    std::set<std::string> taken;
    for (const EditedLamp& lamp : document.lamps)
        if (lamp.id != but)
            taken.insert(lamp.luminaire.name);
    return unique_name(wanted, taken);
}

int add_lamp(Document& document, LuminaireInstance luminaire) {
    luminaire.name = unique_lamp_name(document, luminaire.name, -1);
    luminaire.node = -1;
    document.lamps.push_back({document.next_id, std::move(luminaire)});
    return document.next_id++;
}

void part(Document& document, int lamp) {
    for (EditedLamp& other : document.lamps)
        if (other.id == lamp || (other.mirror && other.mirror->partner == lamp))
            other.mirror.reset();
}

void set_pose(Document& document, EditedLamp& lamp, const glm::dmat4& pose) {
    if (!is_finite(pose))
        return;
    lamp.luminaire.world_from_luminaire = pose;
    if (!lamp.mirror)
        return;
    if (EditedLamp* partner = find(document, lamp.mirror->partner)) {
        // The partner may be mirrored itself or not (a lamp that is its own mirror image): it
        // stays.
        const bool was_mirrored =
            glm::determinant(glm::dmat3(partner->luminaire.world_from_luminaire)) < 0.0;
        glm::dmat4 image = mirror_matrix(lamp.mirror->point_world_m, lamp.mirror->normal) * pose;
        if ((glm::determinant(glm::dmat3(image)) < 0.0) != was_mirrored)
            image[0] = -image[0];
        partner->luminaire.world_from_luminaire = image;
    }
}

void join(EditedLamp& lamp, EditedLamp& other, glm::dvec3 point_world_m, glm::dvec3 normal) {
    lamp.mirror = Mirror{other.id, point_world_m, normal};
    other.mirror = Mirror{lamp.id, point_world_m, normal};
}

struct Apply {
    Document document;

    void operator()(const SetPose& edit) {
        if (EditedLamp* lamp = find(document, edit.lamp))
            set_pose(document, *lamp, edit.world_from_luminaire);
    }
    void operator()(const SetDim& edit) {
        EditedLamp* lamp = find(document, edit.lamp);
        if (lamp != nullptr && edit.dim >= 0.0 && edit.dim <= 1e9)
            lamp->luminaire.dim = edit.dim;
    }
    void operator()(const SetTint& edit) {
        EditedLamp* lamp = find(document, edit.lamp);
        const bool fits = glm::all(glm::greaterThanEqual(edit.tint, glm::vec3(0.0F))) &&
                          glm::all(glm::lessThanEqual(edit.tint, glm::vec3(1.0F)));
        if (lamp != nullptr && fits)
            lamp->luminaire.tint = edit.tint;
    }
    void operator()(const SetOn& edit) {
        if (EditedLamp* lamp = find(document, edit.lamp))
            lamp->luminaire.on = edit.on;
    }
    void operator()(const SetName& edit) {
        EditedLamp* lamp = find(document, edit.lamp);
        if (lamp != nullptr && !edit.name.empty())
            lamp->luminaire.name = unique_lamp_name(document, edit.name, edit.lamp);
    }
    void operator()(const Aim& edit) {
        if (EditedLamp* lamp = find(document, edit.lamp))
            set_pose(document, *lamp,
                     aimed_at(lamp->luminaire.world_from_luminaire, edit.at_world_m));
    }
    void operator()(const Duplicate& edit) {
        if (const EditedLamp* lamp = find(document, edit.lamp)) {
            LuminaireInstance copy = lamp->luminaire;
            copy.world_from_luminaire[3] += glm::dvec4(edit.by_world_m, 0.0);
            if (is_finite(copy.world_from_luminaire))
                add_lamp(document, std::move(copy));
        }
    }
    void operator()(const AddMirrorImage& edit) {
        const EditedLamp* lamp = find(document, edit.lamp);
        if (lamp == nullptr || !(glm::length(edit.normal) > 0.0))
            return;
        LuminaireInstance copy = lamp->luminaire;
        copy.world_from_luminaire =
            mirror_matrix(edit.point_world_m, edit.normal) * copy.world_from_luminaire;
        const int added = add_lamp(document, std::move(copy));
        part(document, edit.lamp);
        join(*find(document, edit.lamp), *find(document, added), edit.point_world_m, edit.normal);
    }
    void operator()(const MakePartners& edit) {
        EditedLamp *lamp = find(document, edit.lamp), *other = find(document, edit.other);
        if (lamp == nullptr || other == nullptr || lamp == other)
            return;
        const glm::dvec3 a(lamp->luminaire.world_from_luminaire[3]),
            b(other->luminaire.world_from_luminaire[3]);
        if (!(glm::length(b - a) > 1e-6))
            return;
        part(document, edit.lamp);
        part(document, edit.other);
        join(*lamp, *other, 0.5 * (a + b), glm::normalize(b - a));
    }
    void operator()(const PartPartners& edit) { part(document, edit.lamp); }
    void operator()(const Remove& edit) {
        part(document, edit.lamp);
        std::erase_if(document.lamps, [&](const EditedLamp& lamp) { return lamp.id == edit.lamp; });
    }
    void operator()(const Add& edit) {
        if (is_finite(edit.luminaire.world_from_luminaire))
            add_lamp(document, edit.luminaire);
    }
    void operator()(const AddBookmark& edit) {
        std::set<std::string> taken;
        for (const Camera& camera : document.scene->cameras)
            taken.insert(camera.name);
        for (const Camera& camera : document.bookmarks)
            taken.insert(camera.name);
        Camera camera = edit.camera;
        camera.name = unique_name(camera.name, taken);
        document.bookmarks.push_back(std::move(camera));
    }
};

}  // namespace

Document document_of(Scene scene, const std::string& path) {
    Document document;
    document.path = path;
    for (const LuminaireInstance& luminaire : scene.luminaires)
        document.lamps.push_back({document.next_id++, luminaire});
    scene.luminaires.clear();
    document.scene = std::make_shared<const Scene>(std::move(scene));
    return document;
}

Scene edited_scene(const Document& document) {
    Scene scene = *document.scene;
    scene.luminaires.clear();
    for (const EditedLamp& lamp : document.lamps)
        scene.luminaires.push_back(lamp.luminaire);
    scene.cameras.insert(scene.cameras.end(), document.bookmarks.begin(), document.bookmarks.end());
    return scene;
}

const EditedLamp* find_lamp(const Document& document, int id) {
    const auto found = std::find_if(document.lamps.begin(), document.lamps.end(),
                                    [id](const EditedLamp& lamp) { return lamp.id == id; });
    return found == document.lamps.end() ? nullptr : &*found;
}

bool is_lit(const EditedLamp& lamp) {
    return lamp.luminaire.on && lamp.luminaire.dim > 0.0;
}

bool is_alike(const EditedLamp& a, const EditedLamp& b) {
    return a.luminaire.path == b.luminaire.path &&
           a.luminaire.world_from_luminaire == b.luminaire.world_from_luminaire &&
           a.luminaire.excludes == b.luminaire.excludes;
}

Document edited(const Document& document, const Edit& edit) {
    Apply next{document};
    std::visit(next, edit);
    return std::move(next.document);
}

std::string name_of(const Edit& edit) {
    constexpr const char* kNames[] = {"move",          "dim",           "tint",      "switch",
                                      "rename",        "aim",           "duplicate", "mirror image",
                                      "make partners", "part partners", "remove",    "add",
                                      "bookmark"};
    static_assert(std::size(kNames) == std::variant_size_v<Edit>);
    return kNames[edit.index()];
}

glm::dmat4 mirror_matrix(glm::dvec3 point_world_m, glm::dvec3 normal) {
    const glm::dvec3 n = glm::normalize(normal);
    glm::dmat4 matrix(glm::dmat3(1.0) - 2.0 * glm::outerProduct(n, n));
    matrix[3] = glm::dvec4(2.0 * glm::dot(point_world_m, n) * n, 1.0);
    return matrix;
}

}  // namespace nearfield::viewer
