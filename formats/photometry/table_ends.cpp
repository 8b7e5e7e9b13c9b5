// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/table_ends.h"

#include "formats/files/error.h"
#include "formats/photometry/text_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::photometry {

Symmetry symmetry_by_last_plane(Photometry& photometry, const std::string& where) {
    const std::vector<double>& planes = photometry.planes_deg;
    const double first = planes.front(), last = planes.back();
    if (photometry.coordinates != Coordinates::C)
        return is_angle(first, 0) ? Symmetry::AcrossC0 : Symmetry::None;
    if (planes.size() == 1 && is_angle(first, 0))
        return Symmetry::Axial;
    if (is_angle(first, 90) && is_angle(last, 270))
        return Symmetry::AcrossC90;
    if (is_angle(first, 0) && planes.size() > 1) {
        if (is_angle(last, 90))
            return Symmetry::Quadrants;
        if (is_angle(last, 180))
            return Symmetry::AcrossC0;
        if (is_angle(last, 360))
            return Symmetry::None;
        // A circle without its last plane, which is the first: no gap wider than others.
        double widest = 0;
        for (std::size_t p = 1; p < planes.size(); ++p)
            widest = std::max(widest, planes[p] - planes[p - 1]);
        if (last > 180 && last < 360 && 360 - last <= widest + 0.01) {
            photometry.notes.emplace_back("There is no plane of 360 degrees: that of 0 is taken.");
            return Symmetry::None;
        }
    }
    throw Error{"horizontal angles of photometric file", where,
                "0 alone, 0 ... 90, 0 ... 180, 0 ... 360 or 90 ... 270",
                fmt::format("{} ... {}", first, last)};
}

void close_circle(Photometry& photometry) {
    if (photometry.coordinates != Coordinates::C || photometry.planes_deg.size() == 1)
        return;
    for (double& plane_deg : photometry.planes_deg)
        for (const double end_deg : {0.0, 90.0, 180.0, 270.0, 360.0})
            if (is_angle(plane_deg, end_deg))
                plane_deg = end_deg;
    if (photometry.planes_deg.back() > 180 && photometry.planes_deg.front() == 0 &&
        photometry.planes_deg.back() < 360) {
        photometry.planes_deg.push_back(360);
        const auto angles = static_cast<std::ptrdiff_t>(photometry.angles_deg.size());
        const std::vector<double> first(photometry.intensity_cd.begin(),
                                        photometry.intensity_cd.begin() + angles);
        photometry.intensity_cd.insert(photometry.intensity_cd.end(), first.begin(), first.end());
    }
}

void note_missing_angles(Photometry& photometry) {
    const double first = photometry.angles_deg.front(), last = photometry.angles_deg.back();
    if (photometry.coordinates == Coordinates::C && !((is_angle(first, 0) || is_angle(first, 90)) &&
                                                      (is_angle(last, 90) || is_angle(last, 180))))
        photometry.notes.push_back(fmt::format(
            "Vertical angles go from {} to {} degrees: outside of them it is dark.", first, last));
}

}  // namespace nearfield::photometry
