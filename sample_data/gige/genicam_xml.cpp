// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/features.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace nearfield::gige {
namespace {

std::string_view element_name(Kind kind) {
    switch (kind) {
        case Kind::Integer:
            return "Integer";
        case Kind::Float:
            return "Float";
        case Kind::Enumeration:
            return "Enumeration";
        case Kind::Boolean:
            return "Boolean";
        case Kind::Command:
            return "Command";
        case Kind::Text:
            break;
    }
    return "StringReg";
}

std::string_view access_code(Access access) {
    return access == Access::Read ? "RO" : access == Access::Write ? "WO" : "RW";
}

std::string element(std::string_view name, std::string_view content) {
    return fmt::format("    <{0}>{1}</{0}>\n", name, content);
}

std::string location(const Feature& feature, Access access) {
    return element("Address", fmt::format("0x{:X}", feature.address)) +
           element("Length", fmt::format("{}", feature.bytes())) +
           element("AccessMode", access_code(access)) + element("pPort", "Device") +
           element("Cachable", "NoCache");
}

std::string register_node(const Feature& feature) {
    const bool is_float = feature.kind == Kind::Float;
    const std::string_view kind = is_float              ? "FloatReg"
                                  : feature.is_masked() ? "MaskedIntReg"
                                                        : "IntReg";
    // Part of a register is written by reading the rest of it.
    std::string text = fmt::format("  <{} Name=\"{}Register\">\n", kind, feature.name) +
                       element("Visibility", "Invisible") +
                       location(feature, feature.is_masked() ? Access::ReadWrite : feature.access);
    if (feature.is_masked())
        text += element("LSB", fmt::format("{}", feature.last_bit)) +
                element("MSB", fmt::format("{}", feature.first_bit));
    if (!is_float)
        text += element("Sign", "Unsigned");
    return text + element("Endianess", "BigEndian") + fmt::format("  </{}>\n", kind);
}

std::string limits(const Feature& feature) {
    std::string text = element("Min", fmt::format("{}", feature.least));
    text += feature.most_from.empty() ? element("Max", fmt::format("{}", feature.most))
                                      : element("pMax", feature.most_from);
    if (feature.kind == Kind::Integer)
        text += element("Inc", fmt::format("{}", feature.step));
    if (!feature.unit.empty())
        text += element("Unit", feature.unit);
    return text;
}

std::string entries(const Feature& feature) {
    std::string text;
    for (const auto& [name, value] : feature.entries)
        text +=
            fmt::format("    <EnumEntry Name=\"{}\"><Value>{}</Value></EnumEntry>\n", name, value);
    return text;
}

std::string details(const Feature& feature) {
    const std::string value = element("pValue", feature.name + "Register");
    switch (feature.kind) {
        case Kind::Text:
            return location(feature, feature.access);
        case Kind::Enumeration:
            return entries(feature) + value;
        case Kind::Command:
            return value + element("CommandValue", "1");
        case Kind::Boolean:
            return value + element("OnValue", "1") + element("OffValue", "0");
        case Kind::Integer:
        case Kind::Float:
            break;
    }
    return value + limits(feature);
}

std::string feature_node(const Feature& feature) {
    std::string text =
        fmt::format("  <{} Name=\"{}\">\n", element_name(feature.kind), feature.name);
    if (!feature.tooltip.empty())
        text += element("ToolTip", feature.tooltip);
    text += element("Visibility", "Beginner");
    if (feature.locked)
        text += element("pIsLocked", "TLParamsLocked");
    text += details(feature) + fmt::format("  </{}>\n", element_name(feature.kind));
    return feature.kind == Kind::Text ? text : text + register_node(feature);
}

std::string categories(const std::vector<Feature>& features) {
    std::vector<std::string> names;
    for (const Feature& feature : features)
        if (std::find(names.begin(), names.end(), feature.category) == names.end())
            names.push_back(feature.category);
    std::string text = "  <Category Name=\"Root\">\n";
    for (const std::string& name : names)
        text += element("pFeature", name);
    text += "  </Category>\n";
    for (const std::string& name : names) {
        text += fmt::format("  <Category Name=\"{}\">\n", name);
        for (const Feature& feature : features)
            if (feature.category == name)
                text += element("pFeature", feature.name);
        text += "  </Category>\n";
    }
    return text;
}

}  // namespace

std::string genicam_xml(const std::vector<Feature>& features) {
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<RegisterDescription ModelName=\"{}\" VendorName=\"{}\" ToolTip=\"nearfield's simulated "
        "camera\" "
        "StandardNameSpace=\"GEV\" SchemaMajorVersion=\"1\" SchemaMinorVersion=\"1\" "
        "SchemaSubMinorVersion=\"0\" MajorVersion=\"1\" MinorVersion=\"0\" SubMinorVersion=\"0\" "
        "ProductGuid=\"6c2b7a0e-8f41-4b52-9d0e-5a3f6d6f1c01\" "
        "VersionGuid=\"0d9f3f55-3f0b-4a53-8a57-2f1f0f2a7e01\" "
        "xmlns=\"http://www.genicam.org/GenApi/Version_1_1\">\n",
        kModel, kVendor);
    text += categories(features);
    for (const Feature& feature : features)
        text += feature_node(feature);
    return text + "  <Port Name=\"Device\"/>\n</RegisterDescription>\n";
}

}  // namespace nearfield::gige
