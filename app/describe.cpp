// SPDX-License-Identifier: Apache-2.0
#include "app/describe.h"

#include "formats/model/luminaire.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace nearfield::app {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Slab& slab) {
    const glm::dvec2 extent_m = slab.s_max_m - slab.s_min_m;
    return {{"grid", {slab.grid.x, slab.grid.y}},
            {"texels", {slab.texels.x, slab.texels.y}},
            {"basis", slab.profile.name},
            {"weighting", slab.weighting == Weighting::Irradiance ? "irradiance" : "radiance"},
            {"delta_m", slab.delta_m},
            {"pitch_m", {slab.pitch_m.x, slab.pitch_m.y}},
            {"s_extent_m", {extent_m.x, extent_m.y}},
            {"channels", slab.channels},
            {"has_sigma", !slab.sigma.empty()}};
}

std::string list(const Json& object) {
    std::string text;
    for (const auto& [key, value] : object.items())
        text += fmt::format("  {:<24} {}\n", key,
                            value.is_string() ? value.get<std::string>() : value.dump());
    return text;
}

std::string provenance_text(const Json& provenance) {
    std::string text = fmt::format("made by    {} {}\n", provenance["program"].get<std::string>(),
                                   provenance["command"].get<std::string>());
    for (const Json& input : provenance["inputs"])
        text += fmt::format("  from {} (xxh128 {})\n", input["name"].get<std::string>(),
                            input["xxh128"].get<std::string>());
    text += list(provenance["options"]);
    if (!provenance["figures"].empty())
        text += "figures\n" + list(provenance["figures"]);
    return text;
}

std::string slab_text(const Json& slab, std::size_t index) {
    return fmt::format(
        "slab {}     {} x {} images of {} x {} texels, {} channel{}, basis {}, {} weighting\n"
        "           delta {:g} m, pitch {:g} x {:g} mm, S {:g} x {:g} m{}\n",
        index, slab["grid"][0].get<int>(), slab["grid"][1].get<int>(), slab["texels"][0].get<int>(),
        slab["texels"][1].get<int>(), slab["channels"].get<int>(),
        slab["channels"].get<int>() == 1 ? "" : "s", slab["basis"].get<std::string>(),
        slab["weighting"].get<std::string>(), slab["delta_m"].get<double>(),
        slab["pitch_m"][0].get<double>() * 1e3, slab["pitch_m"][1].get<double>() * 1e3,
        slab["s_extent_m"][0].get<double>(), slab["s_extent_m"][1].get<double>(),
        slab["has_sigma"].get<bool>() ? ", with sigma" : "");
}

}  // namespace

Json describe(const Provenance& provenance) {
    Json json = {{"program", provenance.program}, {"command", provenance.command}};
    json["options"] = Json::object();
    for (const auto& [name, value] : provenance.options)
        json["options"][name] = value;
    json["inputs"] = Json::array();
    for (const Provenance::Input& input : provenance.inputs)
        json["inputs"].push_back({{"name", input.name}, {"xxh128", input.xxh128}});
    json["figures"] = Json::object();
    for (const auto& [name, value] : provenance.figures)
        json["figures"][name] = value;
    return json;
}

Json describe(const LightField& lightfield,
              const FileKind& kind,
              const std::optional<model::TableCheck>& tables) {
    const bool photometric = lightfield.quantity == Quantity::Photometric;
    Json json = {{"kind", kind.kind},
                 {"format_version", kind.format_version},
                 {"quantity", photometric ? "photometric" : "radiometric"}};
    json["slabs"] = Json::array();
    for (const Slab& slab : lightfield.slabs)
        json["slabs"].push_back(to_json(slab));
    const double flux = model::luminance(model::flux(lightfield));
    json["flux"] = {
        {"value", flux},
        {"unit", photometric ? "lm" : "W"},
        {"sigma", std::hypot(model::flux_sigma_y(lightfield), flux * lightfield.scale_sigma_rel)}};
    json["axis_intensity"] = {{"value", model::luminance(model::intensity(lightfield, {0, 0, 1}))},
                              {"unit", photometric ? "cd" : "W/sr"}};
    if (tables)
        json["tables"] = {{"values", tables->values},
                          {"different", tables->different},
                          {"worst_relative", tables->worst_relative}};
    json["provenance"] = describe(lightfield.provenance);
    return json;
}

Json describe(const Picture& picture) {
    Json json = {{"kind", "picture"}, {"size_px", {picture.size_px.x, picture.size_px.y}}};
    json["layers"] = Json::array();
    for (const Layer& layer : picture.layers)
        json["layers"].push_back(
            {{"name", layer.name.empty() ? "radiance" : layer.name}, {"channels", layer.channels}});
    json["provenance"] = describe(picture.provenance);
    return json;
}

std::string as_text(const Json& json) {
    std::string text = fmt::format("kind       {}", json["kind"].get<std::string>());
    if (json.contains("size_px")) {
        text += fmt::format(", {} x {} pixels\nlayers    ", json["size_px"][0].get<int>(),
                            json["size_px"][1].get<int>());
        for (const Json& layer : json["layers"])
            text += fmt::format(" {}", layer["name"].get<std::string>());
        return text + "\n" + provenance_text(json["provenance"]);
    }
    text += fmt::format(", format version {}, {}\n", json["format_version"].get<int>(),
                        json["quantity"].get<std::string>());
    for (std::size_t k = 0; k < json["slabs"].size(); ++k)
        text += slab_text(json["slabs"][k], k);
    const Json& flux = json["flux"];
    text += fmt::format("flux       {:.6g} {}, sigma {:.2g} (0: unknown)\n",
                        flux["value"].get<double>(), flux["unit"].get<std::string>(),
                        flux["sigma"].get<double>());
    text += fmt::format("on axis    {:.6g} {}\n", json["axis_intensity"]["value"].get<double>(),
                        json["axis_intensity"]["unit"].get<std::string>());
    if (json.contains("tables"))
        text += fmt::format(
            "tables     {} of {} values differ, worst by {:.2g} of its table's largest\n",
            json["tables"]["different"].get<std::size_t>(),
            json["tables"]["values"].get<std::size_t>(),
            json["tables"]["worst_relative"].get<double>());
    return text + provenance_text(json["provenance"]);
}

}  // namespace nearfield::app
