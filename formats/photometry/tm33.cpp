// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/tm33.h"

#include "formats/files/error.h"
#include "formats/photometry/table_ends.h"
#include "formats/photometry/text_file.h"
#include "formats/photometry/xml_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace nearfield::photometry {
namespace {

// Letters and digits in capitals: files write "CIE_C", "CIE _ C" and "TypeC".
std::string squeezed(const std::string& text) {
    std::string result;
    for (const char character : text)
        if (std::isalnum(static_cast<unsigned char>(character)) != 0)
            result += static_cast<char>(std::toupper(static_cast<unsigned char>(character)));
    return result;
}

Coordinates coordinates_in(const XmlSource& source,
                           const pugi::xml_node& root,
                           const pugi::xml_node& data) {
    const auto names_type = [](const pugi::xml_node& node) {
        const std::string_view name = local_name(node);
        return name == "Type" || name == "GoniometerType" || name == "PhotometryType";
    };
    pugi::xml_node type = data.find_node(names_type);
    if (!type)
        type = child_named(root, "Equipment").find_node(names_type);
    if (!type)
        return Coordinates::C;
    const std::string word = squeezed(text_of(type));
    switch (word.empty() ? ' ' : word.back()) {
        case 'A':
            return Coordinates::A;
        case 'B':
            return Coordinates::B;
        case 'C':
            return Coordinates::C;
        default:
            throw Error{"type of TM-33 file", source.at(type), "a type A, B or C",
                        shown(text_of(type))};
    }
}

bool is_sample(const pugi::xml_node& node) {
    return local_name(node) == "IntData" || local_name(node) == "IntensityData";
}

// The element that holds the luminous intensities, among all emitters: there is to be one.
pugi::xml_node find_intensities(const XmlSource& source, const pugi::xml_node& root) {
    pugi::xml_node found;
    for (const pugi::xml_node emitter : root.children()) {
        if (local_name(emitter) != "Emitter")
            continue;
        const pugi::xml_node data = child_named(emitter, "LuminousData");
        const pugi::xml_node sample = data.find_node(is_sample);
        if (sample && found)
            throw Error{"TM-33 file of several emitters", source.at(emitter),
                        "one emitter with LuminousData", "another one"};
        if (sample)
            found = sample.parent();
    }
    if (!found)
        throw Error{"TM-33 file without intensities", source.at(root),
                    "an Emitter with LuminousData and IntData", "none"};
    return found;
}

struct IntensitySample {
    double plane_deg = 0, angle_deg = 0, intensity_cd = 0;
};

double angle_in(const XmlSource& source,
                const pugi::xml_node& node,
                const char* name,
                const char* name_of_2023) {
    pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute)
        attribute = node.attribute(name_of_2023);
    const auto angle = number_of(attribute.value());
    if (!angle)
        throw Error{fmt::format("angle {} of TM-33 file", name), source.at(node), "a number",
                    attribute ? shown(attribute.value()) : "no such attribute"};
    return *angle;
}

std::vector<double> ascending(std::vector<double> angles) {
    std::sort(angles.begin(), angles.end());
    angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
    return angles;
}

std::size_t place_of(const std::vector<double>& angles, double angle) {
    return static_cast<std::size_t>(std::lower_bound(angles.begin(), angles.end(), angle) -
                                    angles.begin());
}

void expect_count(const XmlSource& source,
                  const pugi::xml_node& data,
                  const char* name,
                  std::size_t count) {
    const pugi::xml_node stated = child_named(data, name);
    if (stated && number_in(source, stated, text_of(stated)) != static_cast<double>(count))
        throw Error{fmt::format("{} of TM-33 file", name), source.at(stated),
                    fmt::format("{}, as many as there are", count), shown(text_of(stated))};
}

// Samples may come in any order; together they are a full table.
void read_table(const XmlSource& source, const pugi::xml_node& data, Photometry& photometry) {
    std::vector<IntensitySample> samples;
    std::vector<double> planes, angles;
    const double factor = number_or(source, data, "Multiplier", 1, 0);
    for (const pugi::xml_node node : data.children()) {
        if (!is_sample(node))
            continue;
        const double value = number_in(source, node, text_of(node));
        if (!(value >= 0))
            throw Error{"intensity of TM-33 file", source.at(node), ">= 0",
                        fmt::format("{}", value)};
        samples.push_back({angle_in(source, node, "h", "horz"), angle_in(source, node, "v", "vert"),
                           factor * value});
        planes.push_back(samples.back().plane_deg);
        angles.push_back(samples.back().angle_deg);
    }
    photometry.planes_deg = ascending(std::move(planes));
    photometry.angles_deg = ascending(std::move(angles));
    const std::size_t count = photometry.planes_deg.size() * photometry.angles_deg.size();
    expect_count(source, data, "NumberMeasured", samples.size());
    expect_count(source, data, "NumberHorz", photometry.planes_deg.size());
    expect_count(source, data, "NumberVert", photometry.angles_deg.size());
    if (samples.size() != count)
        throw Error{"table of TM-33 file is not full", source.at(data),
                    fmt::format("{} planes x {} angles", photometry.planes_deg.size(),
                                photometry.angles_deg.size()),
                    fmt::format("{} intensities", samples.size())};
    constexpr double kNone = -1;
    photometry.intensity_cd.assign(count, kNone);
    for (const IntensitySample& sample : samples) {
        double& place = photometry.at(place_of(photometry.planes_deg, sample.plane_deg),
                                      place_of(photometry.angles_deg, sample.angle_deg));
        if (place != kNone)
            throw Error{"direction twice in TM-33 file", source.at(data), "each once",
                        fmt::format("h {}, v {} again", sample.plane_deg, sample.angle_deg)};
        place = sample.intensity_cd;
    }
}

// TM-33-23 names the symmetry beside the planes, which say it too.
void expect_symmetry(const XmlSource& source, const pugi::xml_node& data, Symmetry symmetry) {
    const pugi::xml_node stated = child_named(data, "SymmType");
    if (!stated)
        return;
    const std::string word = squeezed(text_of(stated));
    const auto is = [&word](const char* ending) { return word.ends_with(ending); };
    const bool agrees = is("NONE") || is("ARBITRARY") ? symmetry == Symmetry::None
                        : is("FULL")                  ? symmetry == Symmetry::Axial
                        : is("QUAD")                  ? symmetry == Symmetry::Quadrants
                        : is("BI0")                   ? symmetry == Symmetry::AcrossC0
                        : is("BI90")                  ? symmetry == Symmetry::AcrossC90
                                                      : false;
    if (!agrees)
        throw Error{"symmetry of TM-33 file", source.at(stated), "the one that its planes say",
                    shown(text_of(stated))};
}

void read_emitter(const XmlSource& source, const pugi::xml_node& data, Photometry& photometry) {
    pugi::xml_node emitter = data;
    while (local_name(emitter) != "Emitter")
        emitter = emitter.parent();
    LampSet lamps;
    lamps.count = static_cast<int>(std::min(1e6, number_or(source, emitter, "Quantity", 1, 1)));
    lamps.flux_lm = lamps.count * number_or(source, emitter, "RatedLumens", 0, 0);
    lamps.input_w = number_or(source, emitter, "InputWattage", 0, 0);
    lamps.type = text_of(child_named(emitter, "Description"));
    const std::string absolute = text_of(child_named(data, "AbsolutePhotometry"));
    photometry.is_absolute = absolute != "false" && absolute != "0";
    if (!photometry.is_absolute && !(lamps.flux_lm > 0))
        throw Error{"relative photometry of TM-33 file", source.at(emitter),
                    "RatedLumens > 0, which intensities are relative to", "none"};
    if (number_or(source, emitter, "BallastFactor", 1, 0) != 1)
        photometry.notes.emplace_back("The ballast factor is not applied to the intensities.");
    photometry.lamps = {std::move(lamps)};
}

void read_luminaire(const XmlSource& source, const pugi::xml_node& root, Photometry& photometry) {
    const pugi::xml_node luminaire = child_named(root, "Luminaire");
    const pugi::xml_node sizes = child_named(luminaire, "Dimensions");
    if (!sizes)
        return;
    constexpr double kMetersPerMm = 1e-3;
    Opening& opening = photometry.opening;
    opening.size_m = kMetersPerMm * glm::dvec3(number_or(source, sizes, "Length", 0, 0),
                                               number_or(source, sizes, "Width", 0, 0),
                                               number_or(source, sizes, "Height", 0, 0));
    opening.shape = Shape::Rectangle;
    const std::string word = squeezed(text_of(child_named(luminaire, "Shape")));
    for (const ShapeName& name : kShapeNames)
        if (word.starts_with(squeezed(name.word)))
            opening.shape = name.shape;
    if (opening.size_m == glm::dvec3(0.0))
        opening.shape = Shape::Point;
    opening.sides_m.fill(opening.size_m.z);
    photometry.housing_m = opening.size_m;
    if (opening.shape != Shape::Point)
        photometry.notes.emplace_back(
            "The luminaire's dimensions are taken for those of its luminous opening.");
}

}  // namespace

bool is_xml(std::string_view bytes) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (bytes.starts_with(kByteOrderMark))
        bytes.remove_prefix(kByteOrderMark.size());
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && bytes[first] == '<';
}

Photometry read_tm33(const std::string& bytes, const std::string& path) {
    const XmlSource source{bytes, path};
    pugi::xml_document document;
    const pugi::xml_parse_result parsed =
        document.load_buffer(bytes.data(), bytes.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed)
        throw Error{"photometric file is not well-formed XML", source.at_byte(parsed.offset), "XML",
                    parsed.description()};
    const pugi::xml_node root = document.document_element();
    const bool is_2023 = local_name(root).starts_with("IESTM33");
    if (!is_2023 && local_name(root) != "LuminaireOpticalData")
        throw Error{"not a photometric file", source.at(root),
                    "TM-33 (LuminaireOpticalData or IESTM33-22)", shown(local_name(root))};
    Photometry photometry;
    photometry.format = is_2023 ? "TM-33-23" : "TM-33-18";
    for (const HeaderName& name : kHeaderNames)
        if (const std::string text =
                text_of(child_named(child_named(root, "Header"), name.element));
            !text.empty())
            photometry.labels.emplace_back(name.keyword, text);
    const pugi::xml_node data = find_intensities(source, root);
    photometry.coordinates = coordinates_in(source, root, data);
    read_table(source, data, photometry);
    check_ascending(photometry.angles_deg, angle_range(photometry.coordinates),
                    "vertical angles of TM-33 file", source.at(data));
    check_ascending(photometry.planes_deg, plane_range(photometry.coordinates),
                    "horizontal angles of TM-33 file", source.at(data));
    const Symmetry symmetry = symmetry_by_last_plane(photometry, source.at(data));
    expect_symmetry(source, data, symmetry);
    close_circle(photometry);
    unfold(photometry, symmetry);
    note_missing_angles(photometry);
    read_emitter(source, data, photometry);
    read_luminaire(source, root, photometry);
    check(photometry, path);
    return photometry;
}

}  // namespace nearfield::photometry
