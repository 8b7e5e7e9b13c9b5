// SPDX-License-Identifier: Apache-2.0
#include "formats/proxies/far_field_scene.h"

#include "formats/files/provenance.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nearfield::proxies {
namespace {

constexpr const char* kLuminaire = "NEARFIELD_luminaire";
constexpr const char* kIes = "EXT_lights_ies";

}  // namespace

// Half a turn about x takes the light's -z to the luminaire's +z and keeps x, which C0 is along;
// C90, +y of the light, becomes the luminaire's -y, where its own table has it.
std::string gltf_proxy(const FarFieldProxy& proxy) {
    using nlohmann::ordered_json;
    const auto list = [](const ordered_json& only) { return ordered_json::array({only}); };
    ordered_json document = {{"asset", {{"version", "2.0"}, {"generator", program_version()}}},
                             {"extensionsUsed", {kLuminaire, kIes}},
                             {"scene", 0}};
    ordered_json lamp = {{"name", "lamp"}};
    lamp["children"] = list(1);
    lamp["extensions"][kLuminaire]["uri"] = proxy.luminaire_uri;
    ordered_json far_field = {{"name", "far field"}};
    far_field["translation"] = {proxy.center_m.x, proxy.center_m.y, proxy.center_m.z};
    far_field["rotation"] = {1, 0, 0, 0};
    far_field["extensions"][kIes]["light"] = 0;
    document["scenes"] = list(ordered_json{{"nodes", list(0)}});
    document["nodes"] = {lamp, far_field};
    document["extensions"][kIes]["lights"] =
        list(ordered_json{{"name", "far field"}, {"uri", proxy.ies_uri}});
    return document.dump(2) + "\n";
}

std::string usd_proxy(const FarFieldProxy& proxy) {
    return fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"lamp\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n"
        "def Xform \"lamp\"\n{{\n"
        "    custom asset nearfield:luminaire = @{}@\n"
        "    custom double nearfield:flux_lm = {}\n\n"
        "    def SphereLight \"farField\" (\n        prepend apiSchemas = [\"ShapingAPI\"]\n    )\n"
        "    {{\n"
        "        float inputs:intensity = 1\n"
        "        float inputs:radius = 0.001\n"
        "        bool inputs:normalize = 1\n"
        "        bool treatAsPoint = 1\n"
        "        asset inputs:shaping:ies:file = @{}@\n"
        "        double3 xformOp:translate = ({}, {}, {})\n"
        "        float xformOp:rotateX = 180\n"
        "        uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateX\"]\n"
        "    }}\n}}\n",
        proxy.luminaire_uri, proxy.flux_lm, proxy.ies_uri, proxy.center_m.x, proxy.center_m.y,
        proxy.center_m.z);
}

}  // namespace nearfield::proxies
