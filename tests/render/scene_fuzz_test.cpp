// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/scene/gltf_guard.h"
#include "formats/scene/scene.h"
#include "tests/render/scenes.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <random>

namespace nearfield {
namespace {

/// A scene with everything that a file may hold, in a few hundred bytes of buffer.
Scene small_scene() {
    Scene scene = test::floor_scene();
    scene.meshes[0].normals.assign(4, {0, 0, 1});
    test::add_blocker(scene, "plate", {0, 0, 1}, {1, 1});
    scene.meshes[1].normals.assign(4, {0, 0, 1});
    scene.meshes[1].tangents.assign(4, {1, 0, 0});
    for (shared::uint kind = shared::kBrdfPhong; kind <= shared::kBrdfHalfwayDisk; ++kind) {
        Material material{"m", glm::vec3(0.5F), 0.0F, 0.5F};
        material.given_brdf = brdf(material);
        material.given_brdf->kind = kind;
        scene.materials.push_back(material);
    }
    LuminaireInstance lamp;
    lamp.name = lamp.uri = "lamp";
    lamp.excludes = {"plate"};
    scene.luminaires = {lamp};
    return scene;
}

std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Whether light that a material reflects is a number, as renderers rely on.
bool is_sound(const Material& material) {
    const glm::vec3 to_viewer(0.6F, 0.0F, 0.8F);
    const glm::vec3 value = shared::brdf_eval(brdf(material), {-0.6F, 0.0F, 0.8F}, to_viewer);
    const float width_rad = shared::brdf_lobe_width_rad(brdf(material), to_viewer);
    return glm::all(glm::greaterThanEqual(value, glm::vec3(0.0F))) &&
           glm::all(glm::lessThan(value, glm::vec3(1e30F))) && width_rad > 0.0F;
}

/// Reads fuzz_count() files made by damage(seed).
template <typename Damage>
void fuzz(const std::string& path, std::size_t good_size, const Damage& damage) {
    std::uint64_t read = 0;
    for (std::uint64_t seed = 0; seed < test::fuzz_count(); ++seed) {
        std::ofstream(path, std::ios::binary) << damage(seed);
        try {
            const Scene scene = read_scene(path);
            for (const Mesh& mesh : scene.meshes)
                ASSERT_LE(mesh.positions_m.size() * sizeof(glm::vec3), 16 * good_size) << seed;
            for (const Material& material : scene.materials)
                ASSERT_TRUE(is_sound(material)) << seed;
            ++read;
        } catch (const Error& error) {
            ASSERT_NE(std::string(error.what()).find(path), std::string::npos)
                << seed << ": " << error.what();
        }
    }
    testing::Test::RecordProperty("read_in_spite_of_mutation", std::to_string(read));
}

/// One to three members of a JSON document replaced by values that break assumptions: deeper than
/// damaged bytes get, which the JSON parser mostly stops.
std::string damage_values(const nlohmann::json& good, std::uint64_t seed) {
    static const nlohmann::json values = nlohmann::json::parse(
        R"([-1, 0, 1, 2, 3, 7, 252, 65535, 2147483647, 2147483648, 4294967296, 18446744073709551615, -2147483649, 0.5,
            1e-300, 1e300, true, null, "", "x", [], {}, [0], [-1], [[1]], {"index": 0}, 5120, 5121, 5125, 5126, "VEC3",
            "SCALAR", "VEC4", "ggx", "ward", "lafortune", [0.1, 0.2], [-1, -1, 1], "data:application/octet-stream;base64,AAAA", "mutated.gltf"])");
    std::mt19937_64 random(seed);
    nlohmann::json damaged = good;
    for (std::uint64_t changes = 1 + random() % 3; changes > 0; --changes) {
        const nlohmann::json flat = damaged.flatten();
        auto leaf = flat.begin();
        std::advance(leaf, static_cast<std::ptrdiff_t>(random() % flat.size()));
        nlohmann::json::json_pointer place(leaf.key());
        // Sometimes the object or array around the leaf.
        for (; !place.parent_pointer().empty() && random() % 4 == 0;)
            place = place.parent_pointer();
        damaged[place] = values[random() % values.size()];
        if (!damaged.is_object())
            return damaged.dump();
    }
    return damaged.dump();
}

/// The small scene's document and binary part.
gltf::GuardedFile good_file(const std::string& ending) {
    write_scene(small_scene(), "seed" + ending);
    return gltf::read_guarded("seed" + ending);
}

// Proves that a damaged file gives a scene or an Error that names the file; never a crash, another
// exception, or a mesh that the file's size cannot justify.
TEST(SceneFuzz, DamagedBytesGiveASceneOrAnError) {
    for (const char* ending : {".gltf", ".glb"}) {
        good_file(ending);
        const std::string good = read_bytes(std::string("seed") + ending);
        fuzz(std::string("mutated") + ending, good.size(),
             [&](std::uint64_t seed) { return test::mutate(good, seed); });
    }
}

// Proves the same for documents that are JSON but not what they should be, and for binary parts
// that are damaged inside a sound container.
TEST(SceneFuzz, DamagedValuesGiveASceneOrAnError) {
    const gltf::GuardedFile text = good_file(".gltf");
    const nlohmann::json document = nlohmann::json::parse(text.json);
    fuzz("values.gltf", text.json.size(),
         [&](std::uint64_t seed) { return damage_values(document, seed); });
}

TEST(SceneFuzz, DamagedChunksGiveASceneOrAnError) {
    const gltf::GuardedFile good = good_file(".glb");
    const nlohmann::json document = nlohmann::json::parse(good.json);
    fuzz("chunks.glb", good.json.size(), [&](std::uint64_t seed) {
        gltf::GuardedFile damaged = good;
        if (seed % 2 == 0)
            damaged.json = damage_values(document, seed);
        else
            damaged.binary = test::mutate(good.binary, seed);
        return gltf::join_glb(damaged);
    });
}

}  // namespace
}  // namespace nearfield
