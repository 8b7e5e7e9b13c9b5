// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/scene/brdf_extension.h"
#include "formats/scene/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace nearfield::gltf {
namespace {

float unit_factor(double value, const std::string& where) {
    if (!(value >= 0.0 && value <= 1.0))
        throw Error{kReadingScene, where, "a number from 0 to 1", fmt::format("{}", value)};
    return static_cast<float>(value);
}

/// The extension's object of one material, with its place for error messages.
struct BrdfObject {
    const tinygltf::Value& value;
    std::string where;

    [[noreturn]] void refuse(const std::string& member,
                             const std::string& expected,
                             const std::string& got) const {
        throw Error{kReadingScene, where + member, expected, got};
    }
};

double number(const BrdfObject& object,
              const tinygltf::Value& value,
              const std::string& member,
              double least,
              double most) {
    const std::string expected = fmt::format("a number from {:g} to {:g}", least, most);
    if (!value.IsNumber())
        object.refuse(member, expected, "something else");
    const double result = value.GetNumberAsDouble();
    if (!(result >= least && result <= most))
        object.refuse(member, expected, fmt::format("{:g}", result));
    return result;
}

glm::vec3 triple(const BrdfObject& object, const std::string& key, double least, double most) {
    const tinygltf::Value& value = object.value.Get(key);
    if (!value.IsArray() || value.ArrayLen() != 3)
        object.refuse("." + key, "an array of 3 numbers", "something else");
    glm::vec3 result(0.0F);
    for (int i = 0; i < 3; ++i)
        result[i] = static_cast<float>(
            number(object, value.Get(i), fmt::format(".{}[{}]", key, i), least, most));
    return result;
}

/// One number for both axes, or one for x and one for y.
glm::vec2 roughness_pair(const BrdfObject& object) {
    const tinygltf::Value& value = object.value.Get("alpha");
    if (!value.IsArray())
        return glm::dvec2(number(object, value, ".alpha", kSmallestBrdfAlpha, kLargestBrdfAlpha));
    if (value.ArrayLen() != 2)
        object.refuse(".alpha", "a number, or an array of 2", "an array of another size");
    glm::dvec2 result(0.0);
    for (int i = 0; i < 2; ++i)
        result[i] = number(object, value.Get(i), fmt::format(".alpha[{}]", i), kSmallestBrdfAlpha,
                           kLargestBrdfAlpha);
    return result;
}

/// Throws where a member is unknown to the model or one that it needs is absent.
void check_members(const BrdfObject& object, const BrdfModel& model) {
    std::set<std::string> known = {"model", "diffuse", "specular", "extras"};
    for (const char* member : model.shape)
        if (member != nullptr)
            known.insert(member);
    std::string names;
    for (const std::string& name : known)
        names += (names.empty() ? "" : ", ") + name;
    for (const std::string& key : object.value.Keys())
        if (known.count(key) == 0)
            object.refuse("", fmt::format("{} (model {})", names, model.name),
                          fmt::format("'{}'", key.substr(0, 40)));
    for (const std::string required : {"exponent", "cosines"})
        if (known.count(required) != 0 && !object.value.Has(required))
            object.refuse("." + required, fmt::format("a value, for model {}", model.name), "none");
}

shared::Brdf read_brdf(const BrdfObject& object, const Material& material) {
    if (!object.value.IsObject())
        object.refuse("", "an object", "something else");
    const tinygltf::Value& name = object.value.Get("model");
    const BrdfModel* model = name.IsString() ? find_brdf_model(name.Get<std::string>()) : nullptr;
    if (model == nullptr)
        object.refuse(".model", brdf_model_names(),
                      name.IsString() ? fmt::format("'{}'", name.Get<std::string>().substr(0, 40))
                                      : std::string("no string"));
    check_members(object, *model);

    shared::Brdf brdf = default_brdf(material, model->kind);
    if (object.value.Has("diffuse"))
        brdf.diffuse = triple(object, "diffuse", 0.0, 1.0);
    if (object.value.Has("specular"))
        brdf.specular = triple(object, "specular", 0.0, 1.0);
    if (object.value.Has("alpha"))
        brdf.alpha = roughness_pair(object);
    if (object.value.Has("exponent"))
        brdf.exponent = static_cast<float>(
            number(object, object.value.Get("exponent"), ".exponent", 0.0, kLargestBrdfExponent));
    if (object.value.Has("cosines"))
        brdf.cosines = triple(object, "cosines", -1.0, 1.0);

    // GGX leaves to the diffuse part what it does not reflect; the others add up.
    const glm::vec3 sum = brdf.diffuse + brdf.specular;
    const float largest = std::max({sum.x, sum.y, sum.z});
    constexpr float kRounding = 1e-6F;
    if (model->kind != shared::kBrdfGgx && !(largest <= 1.0F + kRounding))
        object.refuse("", "diffuse + specular of at most 1", fmt::format("{}", largest));
    return brdf;
}

}  // namespace

void read_materials(Reading& reading) {
    for (std::size_t i = 0; i < reading.model.materials.size(); ++i) {
        const tinygltf::Material& source = reading.model.materials[i];
        const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
        const std::string place = reading.at(fmt::format("materials[{}]", i));
        const std::string where = place + ".pbrMetallicRoughness";
        Material material;
        material.name = source.name;
        for (int c = 0; c < 3; ++c)
            material.base_color[c] = unit_factor(
                pbr.baseColorFactor.at(static_cast<std::size_t>(c)), where + ".baseColorFactor");
        material.metallic = unit_factor(pbr.metallicFactor, where + ".metallicFactor");
        material.roughness = unit_factor(pbr.roughnessFactor, where + ".roughnessFactor");
        if (pbr.baseColorTexture.index >= 0 || pbr.metallicRoughnessTexture.index >= 0 ||
            source.normalTexture.index >= 0)
            reading.scene.notes.push_back(
                fmt::format("materials[{}] '{}': textures left out, factors used", i, source.name));
        if (const auto found = source.extensions.find(kBrdfExtension);
            found != source.extensions.end())
            material.given_brdf = read_brdf(
                {found->second, fmt::format("{}.extensions.{}", place, kBrdfExtension)}, material);
        reading.scene.materials.push_back(material);
    }
}

int material_index(Reading& reading, int index, const std::string& where) {
    const auto count = reading.model.materials.size();
    if (index >= 0 && static_cast<std::size_t>(index) < count)
        return index;
    if (index >= 0)
        throw Error{kReadingScene, where + ".material",
                    fmt::format("an index into {} materials", count), fmt::format("{}", index)};
    if (reading.scene.materials.size() == count)
        reading.scene.materials.push_back({"default", glm::vec3(1.0F), 1.0F, 1.0F});
    return static_cast<int>(count);
}

}  // namespace nearfield::gltf
