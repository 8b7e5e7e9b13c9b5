// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/xml_source.h"

#include "formats/files/error.h"
#include "formats/photometry/text_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::photometry {

std::string XmlSource::at_byte(std::ptrdiff_t byte) const {
    const auto size = static_cast<std::ptrdiff_t>(bytes.size());
    const auto end = bytes.begin() + std::clamp<std::ptrdiff_t>(byte, 0, size);
    return fmt::format("{}, line {}", path, 1 + std::count(bytes.begin(), end, '\n'));
}

std::string XmlSource::at(const pugi::xml_node& node) const {
    return at_byte(node.offset_debug());
}

std::string_view local_name(const pugi::xml_node& node) {
    const std::string_view name = node.name();
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node child_named(const pugi::xml_node& parent, std::string_view name) {
    return parent.find_child(
        [name](const pugi::xml_node& child) { return local_name(child) == name; });
}

std::string text_of(const pugi::xml_node& node) {
    const std::string_view text = node.child_value();
    constexpr const char* kXmlBlanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(kXmlBlanks);
    return first == std::string_view::npos
               ? std::string()
               : std::string(text.substr(first, text.find_last_not_of(kXmlBlanks) - first + 1));
}

double number_in(const XmlSource& source, const pugi::xml_node& node, const std::string& word) {
    const auto number = number_of(word);
    if (!number)
        throw Error{fmt::format("{} of TM-33 file", local_name(node)), source.at(node), "a number",
                    shown(word)};
    return *number;
}

double number_or(const XmlSource& source,
                 const pugi::xml_node& parent,
                 const char* name,
                 double otherwise,
                 double least) {
    const pugi::xml_node node = child_named(parent, name);
    if (!node)
        return otherwise;
    const double number = number_in(source, node, text_of(node));
    if (!(number >= least))
        throw Error{fmt::format("{} of TM-33 file", name), source.at(node),
                    fmt::format("at least {}", least), fmt::format("{}", number)};
    return number;
}

}  // namespace nearfield::photometry
