// SPDX-License-Identifier: Apache-2.0
/// What stands between a file of unknown origin and the glTF library: the library trusts sizes,
/// nesting, chunk lengths and paths that it should not, and overlooks members of the wrong type.
#pragma once

#include <string>

namespace nearfield::gltf {

/// What all errors of reading a scene say first.
constexpr const char* kReadingScene = "cannot read scene";

/// A file's content, after checks, with what this project does not use taken out (images,
/// animations, skins).
struct GuardedFile {
    std::string json;    // glTF document
    std::string binary;  // GLB only: the BIN chunk; else empty
    bool is_binary = false;
    std::string base_folder;  // of relative URIs
};

/// All: with what this project does not use, as it stands in the file.
enum class Members { Used, All };

/// Throws Error with file and JSON place where the file is not glTF 2.0 or breaks a rule that later
/// steps rely on.
GuardedFile read_guarded(const std::string& path, Members members = Members::Used);

/// The content as a GLB again, with chunks that are what their lengths say.
std::string join_glb(const GuardedFile& file);

/// A relative URI of the scene as the path of an existing regular file or not: percent-decoded,
/// joined to base_folder. Throws Error naming `where` if it is absolute or has a scheme.
std::string resolve_uri(const std::string& uri,
                        const std::string& base_folder,
                        const std::string& where);

}  // namespace nearfield::gltf
