// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/symmetry.h"

#include <algorithm>
#include <cmath>

namespace nearfield::photometry {
namespace {

// 360 - 22.3 is not the double nearest to 337.7.
constexpr double kSameAngle_deg = 1e-9;

bool is_same(double a_deg, double b_deg) {
    return std::abs(a_deg - b_deg) < kSameAngle_deg;
}

// Adds the planes sum_deg - plane that are not there yet and lie within least ... most.
void mirror(Photometry& photometry, double sum_deg, double least_deg, double most_deg) {
    struct Row {
        double plane_deg;
        std::size_t source;
    };
    std::vector<Row> rows;
    const std::vector<double> planes = photometry.planes_deg;
    for (std::size_t p = 0; p < planes.size(); ++p)
        rows.push_back({planes[p], p});
    for (std::size_t p = 0; p < planes.size(); ++p) {
        const double mirrored = sum_deg - planes[p];
        const bool is_there = std::any_of(planes.begin(), planes.end(), [&](double plane_deg) {
            return is_same(plane_deg, mirrored);
        });
        if (!is_there && mirrored >= least_deg && mirrored <= most_deg)
            rows.push_back({mirrored, p});
    }
    std::sort(rows.begin(), rows.end(),
              [](const Row& a, const Row& b) { return a.plane_deg < b.plane_deg; });
    const std::vector<double> table = std::move(photometry.intensity_cd);
    const auto angles = static_cast<std::ptrdiff_t>(photometry.angles_deg.size());
    photometry.planes_deg.clear();
    photometry.intensity_cd.clear();
    for (const Row& row : rows) {
        photometry.planes_deg.push_back(row.plane_deg);
        const auto first = table.begin() + static_cast<std::ptrdiff_t>(row.source) * angles;
        photometry.intensity_cd.insert(photometry.intensity_cd.end(), first, first + angles);
    }
}

// C0 and C360 of a circle that has planes on both sides of them alone: between those.
void add_ends(Photometry& photometry) {
    std::vector<double>& planes = photometry.planes_deg;
    if (is_same(planes.front(), 0))
        return;
    const std::size_t angles = photometry.angles_deg.size(), last = planes.size() - 1;
    const double fraction = (360 - planes[last]) / (planes[0] + 360 - planes[last]);
    std::vector<double> between;
    for (std::size_t a = 0; a < angles; ++a)
        between.push_back(std::lerp(photometry.at(last, a), photometry.at(0, a), fraction));
    planes.insert(planes.begin(), 0);
    planes.push_back(360);
    std::vector<double>& table = photometry.intensity_cd;
    table.insert(table.begin(), between.begin(), between.end());
    table.insert(table.end(), between.begin(), between.end());
}

// Whether the plane sum_deg - plane is there for every plane, and equal.
bool is_mirrored(const Photometry& photometry, double sum_deg) {
    const std::vector<double>& planes = photometry.planes_deg;
    const auto angles = static_cast<std::ptrdiff_t>(photometry.angles_deg.size());
    const auto row = [&](std::size_t p) {
        return photometry.intensity_cd.begin() + static_cast<std::ptrdiff_t>(p) * angles;
    };
    for (std::size_t p = 0; p < planes.size(); ++p) {
        double mirrored = sum_deg - planes[p];
        if (photometry.coordinates == Coordinates::C && mirrored < -kSameAngle_deg)
            mirrored += 360;
        const auto found = std::find_if(planes.begin(), planes.end(), [&](double plane_deg) {
            return is_same(plane_deg, mirrored);
        });
        if (found == planes.end() ||
            !std::equal(row(p), row(p) + angles,
                        row(static_cast<std::size_t>(found - planes.begin()))))
            return false;
    }
    return true;
}

bool is_axial(const Photometry& photometry) {
    const std::size_t angles = photometry.angles_deg.size();
    for (std::size_t k = angles; k < photometry.intensity_cd.size(); ++k)
        if (photometry.intensity_cd[k] != photometry.intensity_cd[k % angles])
            return false;
    return true;
}

bool has_plane(const Photometry& photometry, double plane_deg) {
    return std::any_of(photometry.planes_deg.begin(), photometry.planes_deg.end(),
                       [&](double there_deg) { return is_same(there_deg, plane_deg); });
}

}  // namespace

void unfold(Photometry& photometry, Symmetry symmetry) {
    const bool is_c = photometry.coordinates == Coordinates::C;
    switch (symmetry) {
        case Symmetry::None:
        case Symmetry::Axial:
            return;
        case Symmetry::AcrossC0:
            return is_c ? mirror(photometry, 360, 0, 360) : mirror(photometry, 0, -180, 180);
        case Symmetry::AcrossC90:
            mirror(photometry, 180, 0, 90);
            mirror(photometry, 540, 270, 360);
            return add_ends(photometry);
        case Symmetry::Quadrants:
            mirror(photometry, 180, 0, 180);
            return mirror(photometry, 360, 0, 360);
    }
}

Symmetry symmetry_of(const Photometry& photometry) {
    if (photometry.coordinates != Coordinates::C)
        return has_plane(photometry, 0) && is_mirrored(photometry, 0) ? Symmetry::AcrossC0
                                                                      : Symmetry::None;
    if (is_axial(photometry))
        return Symmetry::Axial;
    const bool has_c0 = has_plane(photometry, 180) && is_mirrored(photometry, 360);
    const bool has_c90 =
        has_plane(photometry, 90) && has_plane(photometry, 270) && is_mirrored(photometry, 180);
    if (has_c0)
        return has_c90 ? Symmetry::Quadrants : Symmetry::AcrossC0;
    return has_c90 ? Symmetry::AcrossC90 : Symmetry::None;
}

std::vector<std::size_t> planes_kept(const Photometry& photometry, Symmetry symmetry) {
    double least_deg = -360, most_deg = 360;
    switch (symmetry) {
        case Symmetry::None:
            break;
        case Symmetry::Axial:
            least_deg = most_deg = 0;
            break;
        case Symmetry::AcrossC0:
            least_deg = 0;
            most_deg = 180;
            break;
        case Symmetry::AcrossC90:
            least_deg = 90;
            most_deg = 270;
            break;
        case Symmetry::Quadrants:
            least_deg = 0;
            most_deg = 90;
            break;
    }
    std::vector<std::size_t> kept;
    for (std::size_t p = 0; p < photometry.planes_deg.size(); ++p)
        if (photometry.planes_deg[p] > least_deg - kSameAngle_deg &&
            photometry.planes_deg[p] < most_deg + kSameAngle_deg)
            kept.push_back(p);
    return kept;
}

}  // namespace nearfield::photometry
