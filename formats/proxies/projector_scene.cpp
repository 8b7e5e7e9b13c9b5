// SPDX-License-Identifier: Apache-2.0
#include "formats/proxies/projector_scene.h"

#include "formats/files/image.h"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace nearfield::proxies {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;

void add_value(pugi::xml_node parent,
               const char* kind,
               const char* name,
               const std::string& value) {
    pugi::xml_node node = parent.append_child(kind);
    node.append_attribute("name") = name;
    node.append_attribute("value") = value.c_str();
}

// The pose's 16 numbers, row by row.
std::string rows_of(const Rigid& pose) {
    std::string text;
    for (int row = 0; row < 3; ++row)
        text += fmt::format("{} {} {} {} ", pose.rotation[0][row], pose.rotation[1][row],
                            pose.rotation[2][row], pose.translation_m[row]);
    return text + "0 0 0 1";
}

std::string columns_of(const Rigid& pose) {
    std::string text;
    for (int column = 0; column < 3; ++column)
        text += fmt::format("{} {} {} 0 ", pose.rotation[column][0], pose.rotation[column][1],
                            pose.rotation[column][2]);
    const glm::dvec3 t = pose.translation_m;
    return text + fmt::format("{} {} {} 1", t.x, t.y, t.z);
}

std::string mitsuba_scene(const std::vector<Projector>& projectors,
                          const std::vector<std::string>& picture_names,
                          const std::string& lamp) {
    pugi::xml_document document;
    document.append_child(pugi::node_comment)
        .set_value(fmt::format(" projectors of {}, by {} ", lamp, program_version()).c_str());
    pugi::xml_node scene = document.append_child("scene");
    scene.append_attribute("version") = "3.0.0";
    for (std::size_t k = 0; k < projectors.size(); ++k) {
        pugi::xml_node emitter = scene.append_child("emitter");
        emitter.append_attribute("type") = "projector";
        pugi::xml_node pose = emitter.append_child("transform");
        pose.append_attribute("name") = "to_world";
        pose.append_child("matrix").append_attribute("value") =
            rows_of(projectors[k].luminaire_from_projector).c_str();
        add_value(emitter, "float", "fov",
                  fmt::format("{}", 2 * std::atan(projectors[k].tangent.x) * kDegPerRad));
        add_value(emitter, "string", "fov_axis", "x");
        add_value(emitter, "float", "scale", fmt::format("{}", 1 / std::numbers::pi));
        pugi::xml_node texture = emitter.append_child("texture");
        texture.append_attribute("type") = "bitmap";
        texture.append_attribute("name") = "irradiance";
        add_value(texture, "string", "filename", picture_names[k]);
        add_value(texture, "string", "filter_type", "nearest");
        add_value(texture, "string", "wrap_mode", "clamp");
    }
    std::ostringstream text;
    document.save(text, "  ", pugi::format_indent, pugi::encoding_utf8);
    return text.str();
}

std::string pbrt_scene(const std::vector<Projector>& projectors,
                       const std::vector<std::string>& picture_names,
                       const std::string& lamp) {
    std::string text = fmt::format("# projectors of {}, by {}\n", lamp, program_version());
    for (std::size_t k = 0; k < projectors.size(); ++k) {
        const glm::dvec2 tangent = projectors[k].tangent;
        text += fmt::format(
            "AttributeBegin\n  ConcatTransform [ {} ]\n"
            "  LightSource \"projection\" \"string filename\" [ \"{}\" ] \"float fov\" [ {} ]\n"
            "AttributeEnd\n",
            columns_of(projectors[k].luminaire_from_projector), picture_names[k],
            2 * std::atan(std::min(tangent.x, tangent.y)) * kDegPerRad);
    }
    return text;
}

}  // namespace

std::string projector_scene(const std::vector<Projector>& projectors,
                            const std::vector<std::string>& picture_names,
                            Renderer renderer,
                            const std::string& lamp) {
    return renderer == Renderer::Mitsuba3 ? mitsuba_scene(projectors, picture_names, lamp)
                                          : pbrt_scene(projectors, picture_names, lamp);
}

// Rows are from +y down in both. Mitsuba's first column is at +x, as its cameras see it; pbrt's at
// -x, since its frames are left-handed.
void write_projector_picture(const Projector& projector,
                             Renderer renderer,
                             const std::string& path) {
    const glm::ivec2 size = projector.size_px;
    const auto count = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    Picture picture;
    picture.size_px = size;
    picture.provenance = {program_version(), "export", {}, {}, {}};
    Layer layer{"", {"R", "G", "B"}, std::vector<float>(3 * count)};
    std::size_t at = 0;
    for (int row = 0; row < size.y; ++row)
        for (int column = 0; column < size.x; ++column) {
            const int i = renderer == Renderer::Mitsuba3 ? size.x - 1 - column : column;
            const int j = size.y - 1 - row;
            const auto index = static_cast<std::size_t>(j) * static_cast<std::size_t>(size.x) +
                               static_cast<std::size_t>(i);
            const glm::dvec2 t =
                projector.tangent * (2.0 * (glm::dvec2(i, j) + 0.5) / glm::dvec2(size) - 1.0);
            const double secant = std::sqrt(1 + glm::dot(t, t));
            const double scale = renderer == Renderer::Mitsuba3 ? 1 : secant * secant * secant;
            for (std::size_t c = 0; c < 3; ++c)
                layer.values[at++] = static_cast<float>(
                    scale *
                    static_cast<double>(
                        projector.irradiance[(projector.channels == 1 ? 0 : c) * count + index]));
        }
    picture.layers = {std::move(layer)};
    write_picture(picture, std::nullopt, path);
}

}  // namespace nearfield::proxies
