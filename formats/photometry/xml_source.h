// SPDX-License-Identifier: Apache-2.0
/// An XML text's elements, with their lines for error messages.
#pragma once

#include <pugixml.hpp>

#include <string>
#include <string_view>

namespace nearfield::photometry {

struct XmlSource {
    const std::string& bytes;
    const std::string& path;

    /// "lamp.xml, line 12", counted from 1.
    std::string at_byte(std::ptrdiff_t byte) const;
    std::string at(const pugi::xml_node& node) const;
};

/// A name without its namespace's prefix.
std::string_view local_name(const pugi::xml_node& node);

/// The first child of a local name; none: an empty node, of which all is empty.
pugi::xml_node child_named(const pugi::xml_node& parent, std::string_view name);

/// An element's text without blanks around.
std::string text_of(const pugi::xml_node& node);

/// A word as a number. Throws Error naming the element's line where it is none.
double number_in(const XmlSource& source, const pugi::xml_node& node, const std::string& word);

/// A child's number, `otherwise` where there is no such child. Throws Error below `least` too.
double number_or(const XmlSource& source,
                 const pugi::xml_node& parent,
                 const char* name,
                 double otherwise,
                 double least);

}  // namespace nearfield::photometry
