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

// 1986 and 1991: a negative width is a diameter, or across an ellipse along the length.
constexpr std::array<SignRule, 4> kRounds1986 = {{
    {"-00", Shape::Ellipse},
    {"-0+", Shape::Ellipse},
    {"-+0", Shape::Ellipse},
    {"-++", Shape::Ellipsoid},
}};

constexpr std::array<SignRule, 11> kRounds1995 = {{
    {"-00", Shape::Ellipse},
    {"-0+", Shape::Ellipse},
    {"-0-", Shape::Ellipsoid},  // a sphere
    {"0+-", Shape::CylinderX},
    {"+0-", Shape::CylinderY},
    {"-+0", Shape::Ellipse},
    {"+-0", Shape::Ellipse},
    {"-++", Shape::Ellipse},
    {"+-+", Shape::Ellipse},
    {"-+-", Shape::Ellipsoid},
    {"+--", Shape::Ellipsoid},
}};

// 2002 and 2019, and what files that call themselves so keep of 1995 where it is not ambiguous.
constexpr std::array<SignRule, 8> kRounds2002 = {{
    {"--0", Shape::Ellipse},
    {"--+", Shape::Ellipse},
    {"---", Shape::Ellipsoid},
    {"-+-", Shape::CylinderX},
    {"+--", Shape::CylinderY},
    {"-0-", Shape::UprightEllipse},
    {"-00", Shape::Ellipse},
    {"-0+", Shape::Ellipse},
}};

char sign_of(double length) {
    return length < 0 ? '-' : length > 0 ? '+' : '0';
}

template <std::size_t kCount>
std::optional<Shape> shape_by(const std::array<SignRule, kCount>& rules, const std::string& signs) {
    const auto found = std::find_if(rules.begin(), rules.end(),
                                    [&](const SignRule& rule) { return signs == rule.signs; });
    return found == rules.end() ? std::nullopt : std::optional(found->shape);
}

// Lengths that a sign rule leaves out are those of a circle.
void complete_circles(Opening& opening) {
    glm::dvec3& size = opening.size_m;
    switch (opening.shape) {
        case Shape::Ellipse:
            if (size.x == 0)
                size.x = size.y;
            break;
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
    std::optional<Shape> shape = shape_by(kRectangles, signs);
    if (!shape)
        shape = year <= 1991   ? shape_by(kRounds1986, signs)
                : year == 1995 ? shape_by(kRounds1995, signs)
                               : shape_by(kRounds2002, signs);
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
