// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/gltf_guard.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

namespace nearfield::gltf {
namespace {

using nlohmann::json;

// The library walks documents by recursion; glTF itself needs 10 levels.
constexpr int kMaxNesting = 64;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;  // "JSON", "BIN\0"

std::string read_bytes(const std::string& path) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed))
        throw Error{kReadingScene, path, "a file", "none"};
    const auto size = std::filesystem::file_size(path, failed);
    // The library counts in 32 bits.
    if (failed || size > static_cast<std::uintmax_t>(std::numeric_limits<std::int32_t>::max()))
        throw Error{kReadingScene, path, "at most 2 GiB", fmt::format("{} bytes", size)};
    std::string bytes(static_cast<std::size_t>(size), '\0');
    std::ifstream file(path, std::ios::binary);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(size)))
        throw Error{kReadingScene, path, fmt::format("{} bytes", size), "fewer"};
    return bytes;
}

std::uint32_t read_u32(const std::string& bytes, std::size_t offset) {
    std::array<unsigned char, 4> b{};
    std::memcpy(b.data(), bytes.data() + offset, 4);
    return static_cast<std::uint32_t>(b[0]) | static_cast<std::uint32_t>(b[1]) << 8U |
           static_cast<std::uint32_t>(b[2]) << 16U | static_cast<std::uint32_t>(b[3]) << 24U;
}

/// One chunk of a GLB at `offset`: its content. Throws if it reaches beyond the file or is of
/// another type.
std::string read_chunk(const std::string& bytes,
                       std::size_t offset,
                       std::uint32_t type,
                       const std::string& path) {
    const std::string where = fmt::format("{}, byte {}", path, offset);
    if (bytes.size() < offset + 8)
        throw Error{kReadingScene, where, "a GLB chunk", "end of file"};
    const std::uint32_t length = read_u32(bytes, offset);
    if (length > bytes.size() - offset - 8)
        throw Error{kReadingScene, where,
                    fmt::format("a chunk of at most {} bytes", bytes.size() - offset - 8),
                    fmt::format("{}", length)};
    if (read_u32(bytes, offset + 4) != type)
        throw Error{kReadingScene, where, fmt::format("chunk type {:#x}", type),
                    fmt::format("{:#x}", read_u32(bytes, offset + 4))};
    return bytes.substr(offset + 8, length);
}

GuardedFile split(std::string bytes, const std::string& path) {
    GuardedFile file;
    file.base_folder = std::filesystem::path(path).parent_path().string();
    if (bytes.rfind("glTF", 0) != 0) {
        file.json = std::move(bytes);
        return file;
    }
    file.is_binary = true;
    if (bytes.size() < 20 || read_u32(bytes, 4) != 2)
        throw Error{kReadingScene, path + ", byte 4", "GLB version 2",
                    bytes.size() < 20 ? "end of file" : fmt::format("{}", read_u32(bytes, 4))};
    if (read_u32(bytes, 8) != bytes.size())
        throw Error{kReadingScene, path + ", byte 8", fmt::format("length {}", bytes.size()),
                    fmt::format("{}", read_u32(bytes, 8))};
    file.json = read_chunk(bytes, 12, kJsonChunk, path);
    const std::size_t next = 20 + file.json.size();
    if (next < bytes.size())
        file.binary = read_chunk(bytes, next, kBinChunk, path);
    return file;
}

json parse(const std::string& text, const std::string& path) {
    const auto limit_nesting = [&](int depth, json::parse_event_t /*event*/, json& /*value*/) {
        if (depth > kMaxNesting)
            throw Error{kReadingScene, path,
                        fmt::format("JSON nested at most {} deep", kMaxNesting), "deeper"};
        return true;
    };
    try {
        return json::parse(text, limit_nesting);
    } catch (const json::exception& error) {
        throw Error{kReadingScene, path, "JSON", error.what()};
    }
}

bool is_index(const json& value) {
    return value.is_number_unsigned() &&
           value.get<std::uint64_t>() <=
               static_cast<std::uint64_t>(std::numeric_limits<int>::max());
}

/// The library leaves out extensions that are no objects.
void check_extensions(const json& extensions, const std::string& place, const std::string& path) {
    if (!extensions.is_object())
        throw Error{kReadingScene, path + ": " + place, "an object",
                    extensions.dump().substr(0, 40)};
    for (const auto& [name, extension] : extensions.items())
        if (!extension.is_object())
            throw Error{kReadingScene, fmt::format("{}: {}.{}", path, place, name), "an object",
                        extension.dump().substr(0, 40)};
}

/// Members whose type the library ignores where it is wrong, so that a typing error would go
/// unnoticed.
void check_members(const json& value, const std::string& place, const std::string& path) {
    static const std::set<std::string> indices = {
        "mesh",       "camera",     "material",   "indices",       "bufferView", "buffer",
        "byteOffset", "byteLength", "byteStride", "componentType", "count",      "scene",
        "POSITION",   "NORMAL",     "TANGENT",    "mode",          "index"};
    static const std::set<std::string> numbers = {"yfov", "aspectRatio", "metallicFactor",
                                                  "roughnessFactor"};
    for (const auto& [key, member] : value.items()) {
        const std::string inner = value.is_array() ? fmt::format("{}[{}]", place, key)
                                  : place.empty()  ? key
                                                   : place + "." + key;
        if (!value.is_array()) {
            if (key == "extensions")
                check_extensions(member, inner, path);
            if (key == "extensions" || key == "extras")
                continue;
            if (indices.count(key) != 0 && !is_index(member))
                throw Error{kReadingScene, path + ": " + inner, "an integer from 0 to 2^31 - 1",
                            member.dump().substr(0, 40)};
            if (numbers.count(key) != 0 && !member.is_number())
                throw Error{kReadingScene, path + ": " + inner, "a number",
                            member.dump().substr(0, 40)};
        }
        if (member.is_structured())
            check_members(member, inner, path);
    }
}

void check_array(const json& object,
                 const char* key,
                 std::size_t size,
                 bool integers,
                 const std::string& where) {
    const auto found = object.find(key);
    if (found == object.end())
        return;
    const bool fits = found->is_array() && (size == 0 || found->size() == size) &&
                      std::all_of(found->begin(), found->end(), [&](const json& element) {
                          return integers ? is_index(element) : element.is_number();
                      });
    if (!fits)
        throw Error{kReadingScene, where + "." + key,
                    integers    ? std::string("an array of indices")
                    : size == 0 ? std::string("an array of numbers")
                                : fmt::format("an array of {} numbers", size),
                    found->dump().substr(0, 60)};
}

void check_nodes(const json& document, const std::string& path) {
    std::size_t index = 0;
    for (const json& node : document.value("nodes", json::array())) {
        const std::string where = fmt::format("{}: nodes[{}]", path, index++);
        check_array(node, "matrix", 16, false, where);
        check_array(node, "rotation", 4, false, where);
        check_array(node, "scale", 3, false, where);
        check_array(node, "translation", 3, false, where);
        check_array(node, "children", 0, true, where);
    }
    index = 0;
    for (const json& scene : document.value("scenes", json::array()))
        check_array(scene, "nodes", 0, true, fmt::format("{}: scenes[{}]", path, index++));
    index = 0;
    for (const json& material : document.value("materials", json::array())) {
        const std::string where =
            fmt::format("{}: materials[{}].pbrMetallicRoughness", path, index++);
        if (material.contains("pbrMetallicRoughness"))
            check_array(material["pbrMetallicRoughness"], "baseColorFactor", 4, false, where);
    }
}

/// Every buffer is backed by bytes of its own, so that memory stays within what the files' sizes
/// justify.
void check_buffers(const json& document, const GuardedFile& file, const std::string& path) {
    std::set<std::string> uris;
    std::size_t index = 0;
    for (const json& buffer : document.value("buffers", json::array())) {
        const std::string where = fmt::format("{}: buffers[{}]", path, index);
        const std::string uri = buffer.value("uri", std::string());
        const std::uint64_t length = buffer.value("byteLength", std::uint64_t{0});
        std::uintmax_t available = 0;
        if (uri.empty()) {
            if (!file.is_binary || index != 0)
                throw Error{kReadingScene, where + ".uri", "a URI", "none"};
            available = file.binary.size();
        } else if (uri.rfind("data:", 0) == 0) {
            available = uri.size() / 4 * 3;
        } else {
            if (!uris.insert(uri).second)
                throw Error{kReadingScene, where + ".uri", "a file named once", uri.substr(0, 60)};
            const std::string side_file = resolve_uri(uri, file.base_folder, where + ".uri");
            std::error_code failed;
            if (!std::filesystem::is_regular_file(side_file, failed))
                throw Error{kReadingScene, where + ".uri", "an existing file", side_file};
            available = std::filesystem::file_size(side_file, failed);
        }
        if (length == 0 || length > available)
            throw Error{kReadingScene, where + ".byteLength",
                        fmt::format("1 ... {} (the bytes there)", available),
                        fmt::format("{}", length)};
        ++index;
    }
}

/// The top level arrays are arrays of objects, as every later check assumes.
void check_shape(const json& document, const std::string& path) {
    if (!document.is_object())
        throw Error{kReadingScene, path, "a JSON object", document.type_name()};
    const json asset = document.value("asset", json::object());
    const std::string version =
        asset.is_object() && asset.contains("version") && asset["version"].is_string()
            ? asset["version"].get<std::string>()
            : "none";
    if (version.rfind("2.", 0) != 0)
        throw Error{kReadingScene, path + ": asset.version", "\"2.0\"", version.substr(0, 40)};
    for (const char* key : {"scenes", "nodes", "meshes", "materials", "cameras", "accessors",
                            "bufferViews", "buffers"}) {
        const json array = document.value(key, json::array());
        const bool fits =
            array.is_array() &&
            std::all_of(array.begin(), array.end(), [](const json& e) { return e.is_object(); });
        if (!fits)
            throw Error{kReadingScene, fmt::format("{}: {}", path, key), "an array of objects",
                        array.dump().substr(0, 40)};
    }
}

void append_chunk(std::string& glb, std::uint32_t type, std::string content, char padding) {
    content.resize((content.size() + 3) / 4 * 4, padding);
    for (const std::uint32_t word : {static_cast<std::uint32_t>(content.size()), type})
        for (unsigned shift = 0; shift < 32; shift += 8)
            glb += static_cast<char>(word >> shift & 0xFFU);
    glb += content;
}

}  // namespace

std::string join_glb(const GuardedFile& file) {
    std::string glb("glTF\2\0\0\0\0\0\0\0", 12);
    append_chunk(glb, kJsonChunk, file.json, ' ');
    if (!file.binary.empty())
        append_chunk(glb, kBinChunk, file.binary, '\0');
    for (unsigned i = 0; i < 4; ++i)
        glb[8 + i] = static_cast<char>(glb.size() >> 8U * i & 0xFFU);
    return glb;
}

std::string resolve_uri(const std::string& uri,
                        const std::string& base_folder,
                        const std::string& where) {
    std::string decoded;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool is_escape = uri[i] == '%' && i + 2 < uri.size() &&
                               std::isxdigit(static_cast<unsigned char>(uri[i + 1])) != 0 &&
                               std::isxdigit(static_cast<unsigned char>(uri[i + 2])) != 0;
        if (is_escape) {
            decoded += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            decoded += uri[i];
        }
    }
    if (decoded.empty() || decoded[0] == '/' || decoded.find(':') != std::string::npos ||
        decoded.find('\0') != std::string::npos)
        throw Error{kReadingScene, where, "a path relative to the scene",
                    "'" + uri.substr(0, 60) + "'"};
    return (std::filesystem::path(base_folder) / decoded).string();
}

GuardedFile read_guarded(const std::string& path, Members members) {
    GuardedFile file = split(read_bytes(path), path);
    json document = parse(file.json, path);
    check_shape(document, path);
    try {
        check_members(document, "", path);
        check_nodes(document, path);
        check_buffers(document, file, path);
    } catch (const json::exception& error) {
        throw Error{kReadingScene, path, "glTF 2.0", error.what()};
    }
    if (members == Members::All)
        return file;
    for (const char* unused :
         {"images", "textures", "samplers", "animations", "skins", "extensions", "extras"})
        document.erase(unused);
    file.json = document.dump();
    return file;
}

}  // namespace nearfield::gltf
