// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/of_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/photometry/intensity.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::photometry {
namespace {

void check_table(const LightField& lightfield, const TableOptions& options) {
    if (options.planes < 4 || options.planes > 3600 || options.planes % 4 != 0)
        throw Error{"photometry of light field", "planes", "a multiple of 4 of 4 ... 3600",
                    fmt::format("{}", options.planes)};
    if (options.quarter_angles < 2 || options.quarter_angles > 1800)
        throw Error{"photometry of light field", "quarter_angles", "2 ... 1800",
                    fmt::format("{}", options.quarter_angles)};
    if (lightfield.quantity != Quantity::Photometric)
        throw Error{"photometry of light field", "quantity", "photometric", "radiometric"};
}

Opening opening_of(const Slab& slab) {
    const glm::dvec2 on_s_m = slab.s_max_m - slab.s_min_m;
    const glm::dvec2 on_u_m = slab.pitch_m * glm::dvec2(slab.grid);
    const bool is_s_smaller = on_s_m.x * on_s_m.y < on_u_m.x * on_u_m.y;
    Opening opening;
    opening.shape = Shape::Rectangle;
    opening.size_m = glm::dvec3(is_s_smaller ? on_s_m : on_u_m, 0);
    return opening;
}

}  // namespace

TableOptions choose_table(const LightField& lightfield, double most_error_rel) {
    const double flux = model::luminance(model::flux(lightfield));
    TableOptions table{36, 45};
    constexpr int kMostQuarterAngles = 360;
    while (table.quarter_angles < kMostQuarterAngles &&
           !(std::abs(flux_lm(photometry_of(lightfield, table)) - flux) <= most_error_rel * flux))
        table = {std::min(2 * table.planes, 1440), 2 * table.quarter_angles};
    return table;
}

Photometry photometry_of(const LightField& lightfield, const TableOptions& options) {
    nearfield::check(lightfield, "light field");
    check_table(lightfield, options);
    Photometry photometry;
    photometry.format = "light field";
    photometry.is_absolute = true;
    photometry.opening = opening_of(lightfield.slabs.front());
    LampSet lamps;
    lamps.flux_lm = model::luminance(model::flux(lightfield));
    photometry.lamps = {std::move(lamps)};
    for (int p = 0; p <= options.planes; ++p)
        photometry.planes_deg.push_back(360.0 * p / options.planes);
    const int quarters = lightfield.slabs.size() == 1 ? 1 : 2;
    for (int a = 0; a <= quarters * options.quarter_angles; ++a)
        photometry.angles_deg.push_back(90.0 * a / options.quarter_angles);
    photometry.intensity_cd.resize(photometry.planes_deg.size() * photometry.angles_deg.size());
    tbb::parallel_for(0, options.planes, [&](int plane) {
        const auto p = static_cast<std::size_t>(plane);
        for (std::size_t a = 0; a < photometry.angles_deg.size(); ++a)
            photometry.at(p, a) = model::luminance(model::intensity(
                lightfield, direction_of(Coordinates::C,
                                         {photometry.planes_deg[p], photometry.angles_deg[a]})));
    });
    for (std::size_t a = 0; a < photometry.angles_deg.size(); ++a)
        photometry.at(photometry.planes_deg.size() - 1, a) = photometry.at(0, a);
    check(photometry, "photometry of light field");
    return photometry;
}

}  // namespace nearfield::photometry
