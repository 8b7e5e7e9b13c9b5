// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/rays/lighttools.h"
#include "formats/rays/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace nearfield::rays {
namespace {

constexpr std::uint64_t kMostHeaderBytes = 65536;

struct Field {
    std::string value;
    std::uint64_t byte = 0;
};
using Fields = std::map<std::string, Field>;

std::string trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    return first == std::string_view::npos
               ? std::string()
               : std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

// "key: value" lines up to the start of the data, whose byte is set.
Fields fields_of(ByteReader& file, std::uint64_t& data_byte) {
    const std::string head = file.head(kMostHeaderBytes);
    Fields fields;
    for (std::size_t at = 0; at < head.size();) {
        const std::size_t end = std::min(head.find('\n', at), head.size());
        const std::string line = trimmed(std::string_view(head).substr(at, end - at));
        if (line == kLightToolsTextStart) {
            data_byte = std::min<std::uint64_t>(end + 1, file.size());
            return fields;
        }
        const std::size_t colon = line.find(':');
        if (!line.starts_with("#") && colon != std::string::npos)
            fields[line.substr(0, colon)] = {trimmed(line.substr(colon + 1)), at};
        at = end + 1;
    }
    throw Error{"ray file without rays", file.at(head.size()), "a line 'lt_startofdata'",
                "the end of the header"};
}

std::string value_of(const Fields& fields, const std::string& key, const std::string& otherwise) {
    const auto found = fields.find(key);
    return found == fields.end() ? otherwise : found->second.value;
}

[[noreturn]] void refuse(const ByteReader& file,
                         const Fields& fields,
                         const std::string& key,
                         const std::string& expected) {
    const auto found = fields.find(key);
    throw Error{key + " of ray file", file.at(found == fields.end() ? 0 : found->second.byte),
                expected, value_of(fields, key, "nothing")};
}

double meters_per_unit(const ByteReader& file, const Fields& fields) {
    static const std::map<std::string, double> kUnits = {
        {"millimeters", 1e-3}, {"centimeters", 1e-2}, {"meters", 1},       {"inches", 0.0254},
        {"feet", 0.3048},      {"microns", 1e-6},     {"nanometers", 1e-9}};
    const auto found = kUnits.find(value_of(fields, "lt_length_units", ""));
    if (found == kUnits.end())
        refuse(file, fields, "lt_length_units",
               "millimeters, centimeters, meters, inches, feet ...");
    return found->second;
}

// A key's numbers, as many as expected; zeros where the key is not there.
std::vector<double> numbers_of_key(const ByteReader& file,
                                   const Fields& fields,
                                   const std::string& key,
                                   std::size_t count) {
    const auto found = fields.find(key);
    if (found == fields.end())
        return std::vector<double>(count, 0.0);
    const auto numbers = numbers_of(found->second.value);
    if (!numbers || numbers->size() != count)
        refuse(file, fields, key, fmt::format("{} numbers", count));
    return *numbers;
}

}  // namespace

bool is_lighttools_text(ByteReader& file) {
    return file.starts_with("# LightTools") ||
           file.head(kMostHeaderBytes).find("\nlt_") != std::string::npos;
}

RayLayout read_lighttools_text_header(ByteReader& file) {
    RayLayout layout;
    layout.format = "LightTools (text)";
    layout.is_text = true;
    layout.end = kLightToolsTextEnd;
    const Fields fields = fields_of(file, layout.data_byte);
    const std::string kind = value_of(fields, "lt_datatype", "");
    const bool is_luminous = kind == "luminous_flux";
    if (!is_luminous && !kind.starts_with("radiant"))
        refuse(file, fields, "lt_datatype", "luminous_flux or radiant_flux");
    if (value_of(fields, "lt_far_field_data", "no") != "no")
        refuse(file, fields, "lt_far_field_data", "no: rays with positions");
    const std::string color = value_of(fields, "lt_color_info", "none");
    if (color != "none" && color != "wavelength")
        refuse(file, fields, "lt_color_info", "none or wavelength");
    layout.m_per_unit = meters_per_unit(file, fields);
    const std::vector<double> origin = numbers_of_key(file, fields, "lt_data_origin", 3);
    layout.origin_m = layout.m_per_unit * glm::dvec3(origin[0], origin[1], origin[2]);
    const char* total = is_luminous && fields.count("lt_luminous_flux") > 0 ? "lt_luminous_flux"
                                                                            : "lt_radiant_flux";
    (is_luminous ? layout.luminous_flux_lm : layout.radiant_flux_w) =
        numbers_of_key(file, fields, total, 1)[0];
    (is_luminous ? layout.luminous : layout.radiant) = 6;
    layout.columns = 7;
    if (color == "wavelength")
        layout.wavelength = layout.columns++;
    return layout;
}

}  // namespace nearfield::rays
