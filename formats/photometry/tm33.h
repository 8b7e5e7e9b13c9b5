// SPDX-License-Identifier: Apache-2.0
/// IES TM-33 and ATLA S001, the XML successors of LM-63: intensities of one emitter, element by
/// element. docs/photometry.md says what is read of them.
#pragma once

#include "formats/photometry/photometry.h"

#include <string>
#include <string_view>

namespace nearfield::photometry {

/// Whether the first character is XML's.
bool is_xml(std::string_view bytes);

/// Reads TM-33-18 = ATLA S001 (root LuminaireOpticalData) and TM-33-23 (IESTM33-22). Throws Error
/// with line, expected and got where the text is no XML, another document, or not a full table.
Photometry read_tm33(const std::string& bytes, const std::string& path);

/// The file's text, TM-33-18; symmetries that are exact are used. Throws Error where the photometry
/// is none (check).
std::string to_tm33(const Photometry& photometry);

/// Elements of the header and the keyword of LM-63 for each.
struct HeaderName {
    const char* element;
    const char* keyword;
};
constexpr HeaderName kHeaderNames[] = {{"Manufacturer", "MANUFAC"},
                                       {"CatalogNumber", "LUMCAT"},
                                       {"Description", "LUMINAIRE"},
                                       {"Laboratory", "TESTLAB"},
                                       {"ReportNumber", "TEST"},
                                       {"ReportDate", "TESTDATE"},
                                       {"DocumentCreationDate", "ISSUEDATE"},
                                       {"Comments", "OTHER"}};

/// Words for shapes of the luminous opening.
struct ShapeName {
    const char* word;
    Shape shape;
};
constexpr ShapeName kShapeNames[] = {{"Point", Shape::Point},
                                     {"Rectangular", Shape::Rectangle},
                                     {"Elliptical", Shape::Ellipse},
                                     {"Ellipse", Shape::Ellipse},
                                     {"Circular", Shape::Ellipse},
                                     {"HorizontalCylinderAlong", Shape::CylinderX},
                                     {"HorizontalCylinderPerpendicular", Shape::CylinderY},
                                     {"Ellipsoid", Shape::Ellipsoid},
                                     {"Sphere", Shape::Ellipsoid},
                                     {"VerticalEllipse", Shape::UprightEllipse}};

}  // namespace nearfield::photometry
