// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/lm63_opening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace nearfield::photometry {
namespace {

// Signs of width, length and height, as written: "-0+".
struct SignRule {
    const char* signs;
    Shape shape;
};

// Rectangles, which are the same in all editions. One length may be 0: a line, or an upright
// rectangle, where only the sides shine.
constexpr std::array<SignRule, 8> kRectangles = {{
    {"000", Shape::Point},
    {"++0", Shape::Rectangle},
    {"+++", Shape::Rectangle},
    {"+00", Shape::Rectangle},
    {"0+0", Shape::Rectangle},
    {"+0+", Shape::Rectangle},
    {"0++", Shape::Rectangle},
    {"00+", Shape::Rectangle},
}};

// What one edition or another says and none contradicts: files mix them.
constexpr std::array<SignRule, 10> kRounds = {{
    {"-00", Shape::Ellipse},
    {"-0+", Shape::Ellipse},
    {"-+0", Shape::Ellipse},
    {"+-0", Shape::Ellipse},
    {"+-+", Shape::Ellipse},
    {"--0", Shape::Ellipse},
    {"--+", Shape::Ellipse},
    {"---", Shape::Ellipsoid},
    {"0+-", Shape::CylinderX},
    {"+0-", Shape::CylinderY},
}};

// What became something else: until 1991, in 1995, from 2002 on.
struct ChangedRule {
    const char* signs;
    Shape until_1991, in_1995, from_2002;
};
constexpr std::array<ChangedRule, 4> kChanged = {{
    {"-++", Shape::Ellipsoid, Shape::Ellipse, Shape::Ellipse},
    {"-0-", Shape::Ellipsoid, Shape::Ellipsoid, Shape::UprightEllipse},
    {"-+-", Shape::Ellipsoid, Shape::Ellipsoid, Shape::CylinderX},
    {"+--", Shape::Ellipsoid, Shape::Ellipsoid, Shape::CylinderY},
}};

char sign_of(double length) {
    return length < 0 ? '-' : length > 0 ? '+' : '0';
}

std::optional<Shape> shape_of(int year, const std::string& signs) {
    for (const SignRule& rule : kRectangles)
        if (signs == rule.signs)
            return rule.shape;
    for (const SignRule& rule : kRounds)
        if (signs == rule.signs)
            return rule.shape;
    for (const ChangedRule& rule : kChanged)
        if (signs == rule.signs)
            return year <= 1991 ? rule.until_1991 : year == 1995 ? rule.in_1995 : rule.from_2002;
    return std::nullopt;
}

// Lengths that a sign rule leaves out are those of a circle.
void complete_circles(Opening& opening) {
    glm::dvec3& size = opening.size_m;
    switch (opening.shape) {
        case Shape::Ellipse:
        case Shape::Ellipsoid:
            if (size.x == 0)
                size.x = size.y;
            break;
        case Shape::CylinderX:
            if (size.y == 0)
                size.y = size.z;
            break;
        case Shape::CylinderY:
            if (size.x == 0)
                size.x = size.z;
            break;
        case Shape::Point:
        case Shape::Rectangle:
        case Shape::UprightEllipse:
            break;
    }
}

}  // namespace

std::optional<Opening> opening_of_signs(int year,
                                        double width_m,
                                        double length_m,
                                        double height_m) {
    const std::string signs{sign_of(width_m), sign_of(length_m), sign_of(height_m)};
    const std::optional<Shape> shape = shape_of(year, signs);
    if (!shape)
        return std::nullopt;
    Opening opening;
    opening.shape = *shape;
    opening.size_m = glm::abs(glm::dvec3(length_m, width_m, height_m));
    complete_circles(opening);
    if (opening.shape == Shape::Rectangle || opening.shape == Shape::Ellipse)
        opening.sides_m.fill(opening.size_m.z);
    return opening;
}

glm::dvec3 signs_of_opening(const Opening& opening) {
    const double width = opening.size_m.y, length = opening.size_m.x, height = opening.size_m.z;
    switch (opening.shape) {
        case Shape::Point:
            return {0, 0, 0};
        case Shape::Rectangle:
            return {width, length, height};
        case Shape::Ellipse:
            return {-width, -length, height};
        case Shape::CylinderX:
            return {-width, length, -height};
        case Shape::CylinderY:
            return {width, -length, -height};
        case Shape::Ellipsoid:
            return {-width, -length, -height};
        case Shape::UprightEllipse:
            return {-width, 0, -height};
    }
    return {0, 0, 0};
}

}  // namespace nearfield::photometry
