// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/scene/gltf_guard.h"
#include "formats/scene/reading.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace nearfield::gltf {
namespace {

/// The extension's object, with its place for error messages.
struct EnvironmentObject {
    const tinygltf::Value& value;
    std::string where;

    [[noreturn]] void refuse(const std::string& member, const std::string& expected) const {
        throw Error{kReadingScene, where + "." + member, expected,
                    value.Has(member) ? "something else" : "none"};
    }
};

glm::dmat3 rotation(const EnvironmentObject& object) {
    const tinygltf::Value& value = object.value.Get("rotation");
    const std::string expected = "a quaternion x, y, z, w of unit length";
    if (!value.IsArray() || value.ArrayLen() != 4)
        object.refuse("rotation", expected);
    double xyzw[4] = {};
    for (int i = 0; i < 4; ++i) {
        if (!value.Get(i).IsNumber())
            object.refuse("rotation", expected);
        xyzw[i] = value.Get(i).GetNumberAsDouble();
    }
    const glm::dquat quaternion(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    if (!(std::abs(glm::length(quaternion) - 1.0) < 1e-3))
        throw Error{kReadingScene, object.where + ".rotation", expected,
                    fmt::format("length {}", glm::length(quaternion))};
    return glm::mat3_cast(glm::normalize(quaternion));
}

void check_members(const EnvironmentObject& object) {
    if (!object.value.IsObject())
        throw Error{kReadingScene, object.where, "an object", "something else"};
    static const std::set<std::string> known = {"uri", "rotation", "intensity", "extras"};
    for (const std::string& key : object.value.Keys())
        if (known.count(key) == 0)
            throw Error{kReadingScene, object.where, "uri, rotation, intensity",
                        "'" + key.substr(0, 40) + "'"};
}

}  // namespace

void read_environment(Reading& reading) {
    const auto index = static_cast<std::size_t>(std::max(reading.model.defaultScene, 0));
    const tinygltf::ExtensionMap& extensions = reading.model.scenes[index].extensions;
    const auto found = extensions.find(kEnvironmentExtension);
    if (found == extensions.end())
        return;
    const EnvironmentObject object{
        found->second,
        reading.at(fmt::format("scenes[{}].extensions.{}", index, kEnvironmentExtension))};
    check_members(object);
    SceneEnvironment environment;
    if (!object.value.Get("uri").IsString())
        object.refuse("uri", "the picture's file, a string");
    environment.uri = object.value.Get("uri").Get<std::string>();
    environment.path = resolve_uri(environment.uri, reading.base_folder, object.where + ".uri");
    if (object.value.Has("rotation"))
        environment.world_from_environment = rotation(object);
    if (object.value.Has("intensity")) {
        if (!object.value.Get("intensity").IsNumber())
            object.refuse("intensity", "a number from 0 to 1e9");
        environment.intensity = object.value.Get("intensity").GetNumberAsDouble();
        if (!(environment.intensity >= 0.0 && environment.intensity <= 1e9))
            throw Error{kReadingScene, object.where + ".intensity", "a number from 0 to 1e9",
                        fmt::format("{}", environment.intensity)};
    }
    reading.scene.environment = std::move(environment);
}

}  // namespace nearfield::gltf
