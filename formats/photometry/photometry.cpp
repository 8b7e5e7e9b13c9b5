// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/photometry.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::photometry {
namespace {

void check_planes(const Photometry& photometry, const std::string& where) {
    check_ascending(photometry.planes_deg, plane_range(photometry.coordinates),
                    "planes of photometry", where);
    const std::vector<double>& planes = photometry.planes_deg;
    const bool is_c0_alone = planes.size() == 1 && planes[0] == 0;
    if (photometry.coordinates == Coordinates::C
            ? !is_c0_alone && (planes.size() < 2 || planes.front() != 0 || planes.back() != 360)
            : planes.size() < 2)
        throw Error{"planes of photometry", where,
                    photometry.coordinates == Coordinates::C ? "C0 alone, or C0 ... C360"
                                                             : "two planes or more",
                    planes.empty()
                        ? "none"
                        : fmt::format("{} ... {} degrees", planes.front(), planes.back())};
}

}  // namespace

AngleRange plane_range(Coordinates coordinates) {
    switch (coordinates) {
        case Coordinates::C:
            return {0, 360};
        case Coordinates::B:
            return {-90, 90};
        case Coordinates::A:
            return {-180, 180};
    }
    return {0, 0};
}

AngleRange angle_range(Coordinates coordinates) {
    switch (coordinates) {
        case Coordinates::C:
            return {0, 180};
        case Coordinates::B:
            return {-180, 180};
        case Coordinates::A:
            return {-90, 90};
    }
    return {0, 0};
}

void check_ascending(const std::vector<double>& angles_deg,
                     AngleRange range,
                     const std::string& what,
                     const std::string& where) {
    for (std::size_t k = 0; k < angles_deg.size(); ++k) {
        const double least = k == 0 ? range.least_deg : angles_deg[k - 1];
        const double angle = angles_deg[k];
        if (!(angle >= least && angle <= range.most_deg) || (k > 0 && angle == least))
            throw Error{what, where,
                        fmt::format("ascending angles within {} ... {} degrees", range.least_deg,
                                    range.most_deg),
                        fmt::format("{} as number {}", angle, k + 1)};
    }
}

std::string label(const Photometry& photometry, const std::string& keyword) {
    for (const auto& [key, text] : photometry.labels)
        if (key == keyword)
            return text;
    return "";
}

void check(const Photometry& photometry, const std::string& where) {
    check_planes(photometry, where);
    check_ascending(photometry.angles_deg, angle_range(photometry.coordinates),
                    "angles of photometry", where);
    const std::size_t planes = photometry.planes_deg.size(), angles = photometry.angles_deg.size();
    if (angles < 2)
        throw Error{"angles of photometry", where, "two or more", fmt::format("{}", angles)};
    if (photometry.intensity_cd.size() != planes * angles)
        throw Error{"intensities of photometry", where, fmt::format("{} x {}", planes, angles),
                    fmt::format("{}", photometry.intensity_cd.size())};
    for (std::size_t k = 0; k < planes * angles; ++k)
        if (!(photometry.intensity_cd[k] >= 0) || !std::isfinite(photometry.intensity_cd[k]))
            throw Error{
                "intensity of photometry",
                fmt::format("{}, plane {}, angle {}", where, photometry.planes_deg[k / angles],
                            photometry.angles_deg[k % angles]),
                "finite and >= 0", fmt::format("{}", photometry.intensity_cd[k])};
    if (photometry.lamp_set < 0 || photometry.lamp_set >= static_cast<int>(photometry.lamps.size()))
        throw Error{"lamp set of photometry", where,
                    fmt::format("0 ... {}", static_cast<int>(photometry.lamps.size()) - 1),
                    fmt::format("{}", photometry.lamp_set)};
    for (int k = 0; k < 3; ++k)
        if (!(photometry.opening.size_m[k] >= 0) || !std::isfinite(photometry.opening.size_m[k]))
            throw Error{"luminous opening of photometry", where, "finite sizes >= 0",
                        fmt::format("{} m", photometry.opening.size_m[k])};
}

}  // namespace nearfield::photometry
