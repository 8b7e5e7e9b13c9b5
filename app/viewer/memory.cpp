// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/memory.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace nearfield::viewer {
namespace {

namespace fs = std::filesystem;

// Read before any thread of ours could set it.
// NOLINTBEGIN(concurrency-mt-unsafe)
std::optional<fs::path> file() {
    if (const char* config = std::getenv("XDG_CONFIG_HOME"); config != nullptr && *config != '\0')
        return fs::path(config) / "nearfield" / "viewer.json";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
        return fs::path(home) / ".config" / "nearfield" / "viewer.json";
    return std::nullopt;
}
// NOLINTEND(concurrency-mt-unsafe)

}  // namespace

std::optional<WindowPlace> remembered_place() {
    const std::optional<fs::path> path = file();
    if (!path)
        return std::nullopt;
    std::ifstream stream(*path);
    const nlohmann::json read = nlohmann::json::parse(stream, nullptr, false);
    const auto number = [&](const char* key) {
        return read.contains(key) && read[key].is_number_integer() ? read[key].get<int>() : -1;
    };
    if (!read.is_object() || number("width") < 64 || number("width") > 16384 ||
        number("height") < 64 || number("height") > 16384)
        return std::nullopt;
    WindowPlace place{{number("width"), number("height")}, false, {number("x"), number("y")}};
    place.has_position = place.position_px.x >= 0 && place.position_px.y >= 0;
    return place;
}

void remember_place(const WindowPlace& place) {
    const std::optional<fs::path> path = file();
    if (!path)
        return;
    std::error_code failed;
    fs::create_directories(path->parent_path(), failed);
    const nlohmann::json kept = {{"width", place.size_px.x},
                                 {"height", place.size_px.y},
                                 {"x", place.position_px.x},
                                 {"y", place.position_px.y}};
    try {
        write_file(kept.dump(2) + "\n", path->string());
    } catch (const Error&) {
        // A window that opens somewhere else is no harm.
    }
}

}  // namespace nearfield::viewer
