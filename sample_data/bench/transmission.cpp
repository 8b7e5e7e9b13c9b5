// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/transmission.h"

#include "formats/model/profile.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::sample_data {
namespace {

// Integral of the profile from its lower end to x.
double integral_to(const Profile& profile, double x) {
    const double half = 0.5 * static_cast<double>(profile.cells.size());
    double sum = 0.0;
    for (std::size_t c = 0; c < profile.cells.size(); ++c) {
        const double lower = static_cast<double>(c) - half;
        const double upper = std::clamp(x, lower, lower + 1.0);
        const std::array<double, 3>& a = profile.cells[c];
        const auto primitive = [&](double t) {
            return t * (a[0] + t * (0.5 * a[1] + t * a[2] / 3.0));
        };
        sum += primitive(upper) - primitive(lower);
    }
    return sum;
}

// Area of the unit disk to the left of x: integral of the chord.
double disk_left_of(double x) {
    const double at = std::clamp(x, -1.0, 1.0);
    return at * std::sqrt(1.0 - at * at) + std::asin(at) + 0.5 * glm::pi<double>();
}

// Area of the unit disk to the left of x and below y. At abscissa t the disk reaches from -c to c,
// c = sqrt(1 - t^2): below y lies y + c of it where c > |y|, else all of it or nothing.
double disk_corner(double x, double y) {
    const double at = std::clamp(x, -1.0, 1.0);
    if (y >= 1.0)
        return disk_left_of(at);
    if (y <= -1.0)
        return 0.0;
    const double reach = std::sqrt(1.0 - y * y);  // c > |y| within
    const double from = std::min(at, -reach), to = std::clamp(at, -reach, reach);
    const double inside = y * (to + reach) + 0.5 * (disk_left_of(to) - disk_left_of(-reach));
    if (y <= 0.0)
        return inside;
    return inside + disk_left_of(from) + disk_left_of(std::max(at, reach)) - disk_left_of(reach);
}

}  // namespace

double mean_transmission(const Profile& profile, double x, double width) {
    if (2.0 * std::abs(x) >= static_cast<double>(profile.cells.size()) + width)
        return 0.0;
    if (width == 0.0)
        return model::eval(profile, x);
    return (integral_to(profile, x + 0.5 * width) - integral_to(profile, x - 0.5 * width)) / width;
}

double disk_share(glm::dvec2 center_m, glm::dvec2 size_m, double radius_m) {
    const glm::dvec2 low = (center_m - 0.5 * size_m) / radius_m;
    const glm::dvec2 high = (center_m + 0.5 * size_m) / radius_m;
    const double area = disk_corner(high.x, high.y) - disk_corner(low.x, high.y) -
                        disk_corner(high.x, low.y) + disk_corner(low.x, low.y);
    return std::max(0.0, area) * radius_m * radius_m / (size_m.x * size_m.y);
}

}  // namespace nearfield::sample_data
