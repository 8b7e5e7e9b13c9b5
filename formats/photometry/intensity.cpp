// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/intensity.h"

#include "formats/files/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nearfield::photometry {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

/// Between which two of ascending angles one lies, and how far along.
struct Place {
    std::size_t lower = 0;
    double fraction = 0;
};

std::optional<Place> place_in(const std::vector<double>& ascending, double value) {
    if (!(value >= ascending.front() && value <= ascending.back()))
        return std::nullopt;
    const auto above = std::upper_bound(ascending.begin() + 1, ascending.end() - 1, value);
    const auto lower = static_cast<std::size_t>(above - ascending.begin()) - 1;
    const double step = ascending[lower + 1] - ascending[lower];
    return Place{lower, (value - ascending[lower]) / step};
}

// Weights of a linear interpolant's integral over an angle, in rad.
std::vector<double> weights_around(const std::vector<double>& angles_deg) {
    if (angles_deg.size() == 1)
        return {2 * std::numbers::pi};
    std::vector<double> weights(angles_deg.size(), 0.0);
    for (std::size_t k = 0; k + 1 < angles_deg.size(); ++k) {
        const double half_rad = 0.5 * kRadPerDeg * (angles_deg[k + 1] - angles_deg[k]);
        weights[k] += half_rad;
        weights[k + 1] += half_rad;
    }
    return weights;
}

// Weights of a linear interpolant's integral times the sine of the polar angle, which is the angle
// + first_deg, up to most_deg. With moments about the middle c of a cell's part of half width h,
//     M0 = int sin = 2 sin c sin h,     M1 = int (g - c) sin g = 2 cos c (sin h - h cos h),
// the cell's ends a and b weigh ((b - c) M0 - M1) / (b - a) and ((c - a) M0 + M1) / (b - a).
std::vector<double> weights_from_pole(const std::vector<double>& angles_deg,
                                      double first_deg,
                                      double most_deg) {
    std::vector<double> weights(angles_deg.size(), 0.0);
    for (std::size_t k = 0; k + 1 < angles_deg.size(); ++k) {
        const double a = kRadPerDeg * (angles_deg[k] + first_deg);
        const double b = kRadPerDeg * (angles_deg[k + 1] + first_deg);
        const double end = std::min(b, kRadPerDeg * most_deg);
        if (end <= a)
            break;
        const double c = 0.5 * (a + end), h = 0.5 * (end - a);
        const double m0 = 2 * std::sin(c) * std::sin(h);
        const double m1 = 2 * std::cos(c) * (std::sin(h) - h * std::cos(h));
        weights[k] += ((b - c) * m0 - m1) / (b - a);
        weights[k + 1] += ((c - a) * m0 + m1) / (b - a);
    }
    return weights;
}

}  // namespace

glm::dvec3 direction_of(Coordinates coordinates, Angles angles) {
    const double plane = kRadPerDeg * angles.plane_deg, angle = kRadPerDeg * angles.angle_deg;
    switch (coordinates) {
        case Coordinates::C:
            return {std::sin(angle) * std::cos(plane), -std::sin(angle) * std::sin(plane),
                    std::cos(angle)};
        case Coordinates::B:
            return {std::cos(plane) * std::sin(angle), std::sin(plane),
                    std::cos(plane) * std::cos(angle)};
        case Coordinates::A:
            return {std::cos(angle) * std::cos(plane), std::cos(angle) * std::sin(plane),
                    -std::sin(angle)};
    }
    return {0, 0, 0};
}

Angles angles_of(Coordinates coordinates, const glm::dvec3& d) {
    // At a pole no azimuth is meant, while atan2 of signed zeros may say 180 degrees.
    const auto deg = [](double y, double x) {
        return y == 0 && x == 0 ? 0 : std::atan2(y, x) / kRadPerDeg;
    };
    switch (coordinates) {
        case Coordinates::C: {
            const double plane_deg = deg(-d.y, d.x);
            return {plane_deg < 0 ? plane_deg + 360 : plane_deg, deg(std::hypot(d.x, d.y), d.z)};
        }
        case Coordinates::B:
            return {deg(d.y, std::hypot(d.x, d.z)), deg(d.x, d.z)};
        case Coordinates::A:
            return {deg(d.y, d.x), deg(-d.z, std::hypot(d.x, d.y))};
    }
    return {};
}

double intensity_cd(const Photometry& photometry, Angles angles) {
    const auto at_angle = place_in(photometry.angles_deg, angles.angle_deg);
    if (!at_angle)
        return 0;
    const auto of_plane = [&](std::size_t plane) {
        return std::lerp(photometry.at(plane, at_angle->lower),
                         photometry.at(plane, at_angle->lower + 1), at_angle->fraction);
    };
    if (photometry.planes_deg.size() == 1)
        return of_plane(0);
    double plane_deg = angles.plane_deg;
    if (photometry.coordinates == Coordinates::C && !(plane_deg >= 0 && plane_deg <= 360))
        plane_deg -= 360 * std::floor(plane_deg / 360);
    const auto at_plane = place_in(photometry.planes_deg, plane_deg);
    return at_plane ? std::lerp(of_plane(at_plane->lower), of_plane(at_plane->lower + 1),
                                at_plane->fraction)
                    : 0.0;
}

double intensity_cd(const Photometry& photometry, const glm::dvec3& direction) {
    return intensity_cd(photometry, angles_of(photometry.coordinates, direction));
}

double flux_lm(const Photometry& photometry, double most_polar_deg) {
    std::vector<double> plane_weights, angle_weights;
    switch (photometry.coordinates) {
        case Coordinates::C:
            plane_weights = weights_around(photometry.planes_deg);
            angle_weights = weights_from_pole(photometry.angles_deg, 0, most_polar_deg);
            break;
        case Coordinates::B:
            plane_weights = weights_from_pole(photometry.planes_deg, 90, 180);
            angle_weights = weights_around(photometry.angles_deg);
            break;
        case Coordinates::A:
            plane_weights = weights_around(photometry.planes_deg);
            angle_weights = weights_from_pole(photometry.angles_deg, 90, 180);
            break;
    }
    double flux = 0;
    for (std::size_t p = 0; p < plane_weights.size(); ++p)
        for (std::size_t a = 0; a < angle_weights.size(); ++a)
            flux += plane_weights[p] * angle_weights[a] * photometry.at(p, a);
    return flux;
}

void scale_to(Photometry& photometry, double flux_asked_lm) {
    const double flux = flux_lm(photometry);
    if (!(flux > 0))
        throw Error{"photometry without light", "flux", "> 0", "0 lm"};
    for (double& intensity : photometry.intensity_cd)
        intensity *= flux_asked_lm / flux;
    for (LampSet& lamps : photometry.lamps)
        lamps.flux_lm *= flux_asked_lm / flux;
}

Peak peak(const Photometry& photometry) {
    const auto most =
        std::max_element(photometry.intensity_cd.begin(), photometry.intensity_cd.end());
    const auto index = static_cast<std::size_t>(most - photometry.intensity_cd.begin());
    const std::size_t angles = photometry.angles_deg.size();
    return {*most, {photometry.planes_deg[index / angles], photometry.angles_deg[index % angles]}};
}

}  // namespace nearfield::photometry
