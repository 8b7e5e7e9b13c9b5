// SPDX-License-Identifier: Apache-2.0
/// Documents in files.
#pragma once

#include "app/viewer/document.h"

#include <string>
#include <vector>

namespace nearfield::viewer {

struct Opened {
    Document document;
    std::vector<std::string> notes;  // of the scene's reader
};

/// Opens a scene (.gltf, .glb), or a luminaire's file in a stock scene: a floor, a wall across its
/// light, a post; that document has no path. Throws Error as read_scene and read_lightfield.
Opened open_document(const std::string& path);

/// A lamp of a file, ready to be added at a place; named after the file.
LuminaireInstance lamp_of(const std::string& path, const glm::dmat4& world_from_luminaire);

/// Writes the document to `path`, .gltf or .glb. What its own file holds beside lamps and cameras
/// is kept (update_scene); a document without one is written whole. Returns the document with that
/// path, its lamps at their nodes of the file.
Document save_document(const Document& document, const std::string& path);

/// Where unsaved work is kept: scene.gltf -> scene.autosave.gltf.
std::string autosave_path(const std::string& path);

}  // namespace nearfield::viewer
