// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/intensity.h"
#include "formats/photometry/symmetry.h"
#include "formats/photometry/tm33.h"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <sstream>

namespace nearfield::photometry {
namespace {

void add_element(pugi::xml_node parent, const char* name, const std::string& text) {
    parent.append_child(name).text().set(text.c_str());
}

void add_element(pugi::xml_node parent, const char* name, double number) {
    add_element(parent, name, fmt::format("{}", number));
}

const char* word_of(Shape shape) {
    for (const ShapeName& name : kShapeNames)
        if (name.shape == shape)
            return name.word;
    return "Point";
}

const char* word_of(Coordinates coordinates) {
    return coordinates == Coordinates::C   ? "CIE_C"
           : coordinates == Coordinates::B ? "CIE_B"
                                           : "CIE_A";
}

void add_luminaire(pugi::xml_node root, const Opening& opening) {
    constexpr double kMmPerMeter = 1e3;
    pugi::xml_node luminaire = root.append_child("Luminaire");
    pugi::xml_node sizes = luminaire.append_child("Dimensions");
    add_element(sizes, "Length", kMmPerMeter * opening.size_m.x);
    add_element(sizes, "Width", kMmPerMeter * opening.size_m.y);
    add_element(sizes, "Height", kMmPerMeter * opening.size_m.z);
    add_element(luminaire, "Shape", std::string(word_of(opening.shape)));
    add_element(luminaire, "NumEmitter", 1);
}

void add_table(pugi::xml_node data, const Photometry& photometry) {
    const std::vector<std::size_t> kept = planes_kept(photometry, symmetry_of(photometry));
    const std::size_t angles = photometry.angles_deg.size();
    add_element(data, "AbsolutePhotometry", photometry.is_absolute ? std::string("true") : "false");
    add_element(data, "NumberMeasured", static_cast<double>(kept.size() * angles));
    add_element(data, "NumberHorz", static_cast<double>(kept.size()));
    add_element(data, "NumberVert", static_cast<double>(angles));
    for (const std::size_t p : kept)
        for (std::size_t a = 0; a < angles; ++a) {
            pugi::xml_node sample = data.append_child("IntData");
            sample.append_attribute("h") = fmt::format("{}", photometry.planes_deg[p]).c_str();
            sample.append_attribute("v") = fmt::format("{}", photometry.angles_deg[a]).c_str();
            sample.text().set(fmt::format("{}", photometry.at(p, a)).c_str());
        }
}

}  // namespace

std::string to_tm33(const Photometry& photometry) {
    check(photometry, "photometry to be written");
    pugi::xml_document document;
    pugi::xml_node declaration = document.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    pugi::xml_node root = document.append_child("LuminaireOpticalData");
    root.append_attribute("version") = "1.0";
    pugi::xml_node header = root.append_child("Header");
    for (const HeaderName& name : kHeaderNames)
        if (const std::string text = label(photometry, name.keyword); !text.empty())
            add_element(header, name.element, text);
    add_luminaire(root, photometry.opening);
    add_element(root.append_child("Equipment").append_child("Gonioradiometer"), "Type",
                std::string(word_of(photometry.coordinates)));
    const LampSet& lamps = photometry.lamps[static_cast<std::size_t>(photometry.lamp_set)];
    pugi::xml_node emitter = root.append_child("Emitter");
    add_element(emitter, "Quantity", lamps.count);
    if (!lamps.type.empty())
        add_element(emitter, "Description", lamps.type);
    if (lamps.flux_lm > 0)
        add_element(emitter, "RatedLumens", lamps.flux_lm / lamps.count);
    add_element(emitter, "InputWattage", lamps.input_w);
    pugi::xml_node data = emitter.append_child("LuminousData");
    add_table(data.append_child("LuminousIntensity"), photometry);
    add_element(data, "LuminousFlux", flux_lm(photometry));
    std::ostringstream text;
    document.save(text, "  ", pugi::format_indent, pugi::encoding_utf8);
    return text.str();
}

}  // namespace nearfield::photometry
