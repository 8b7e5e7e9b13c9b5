// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/photometry/eulumdat.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/symmetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::photometry {
namespace {

constexpr double kMmPerM = 1e3;

class LineWriter {
  public:
    template <typename Value>
    void add(const Value& value) {
        text_ += fmt::format("{}\r\n", value);
    }
    // A label's lines in one.
    void add_text(std::string value) {
        std::replace(value.begin(), value.end(), '\n', ' ');
        add(value);
    }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
};

// The step of even angles; 0 for uneven ones, as the format wants it.
double step_of(const std::vector<double>& angles_deg) {
    if (angles_deg.size() < 2)
        return 0;
    const double step = angles_deg[1] - angles_deg[0];
    for (std::size_t k = 1; k < angles_deg.size(); ++k)
        if (std::abs(angles_deg[k] - angles_deg[k - 1] - step) > 1e-9)
            return 0;
    return step;
}

// The planes listed: the circle's without its end.
std::vector<double> open_circle(const Photometry& photometry) {
    std::vector<double> planes = photometry.planes_deg;
    if (planes.size() > 1)
        planes.pop_back();
    return planes;
}

// EULUMDAT finds C90 and C270 by count: symmetry 3 needs as many planes in each quadrant.
Symmetry symmetry_written(const Photometry& photometry) {
    const Symmetry symmetry = symmetry_of(photometry);
    if (symmetry != Symmetry::AcrossC90)
        return symmetry;
    const std::vector<double> planes = open_circle(photometry);
    const std::size_t n = planes.size();
    const auto is_at = [&](std::size_t index, double deg) {
        return std::abs(planes[index] - deg) < 1e-9;
    };
    return n % 4 == 0 && is_at(n / 4, 90) && is_at(3 * n / 4, 270) ? symmetry : Symmetry::None;
}

int indicator_of(Symmetry symmetry) {
    switch (symmetry) {
        case Symmetry::None:
            return 0;
        case Symmetry::Axial:
            return 1;
        case Symmetry::AcrossC0:
            return 2;
        case Symmetry::AcrossC90:
            return 3;
        case Symmetry::Quadrants:
            return 4;
    }
    return 0;
}

// The planes in the file's order.
std::vector<std::size_t> planes_written(const Photometry& photometry, Symmetry symmetry) {
    const std::size_t n = photometry.planes_deg.size() - 1;  // without C360
    if (symmetry == Symmetry::AcrossC90) {
        std::vector<std::size_t> planes;
        for (std::size_t k = 0; k <= n / 2; ++k)
            planes.push_back((3 * n / 4 + k) % n);
        return planes;
    }
    std::vector<std::size_t> planes = planes_kept(photometry, symmetry);
    if (symmetry == Symmetry::None)
        planes.pop_back();
    return planes;
}

void check_fits(const Photometry& photometry) {
    if (photometry.coordinates != Coordinates::C)
        throw Error{"photometry cannot be written as EULUMDAT", "coordinates", "type C",
                    photometry.coordinates == Coordinates::B ? "type B" : "type A"};
    const std::size_t last = photometry.planes_deg.size() - 1;
    for (std::size_t a = 0; a < photometry.angles_deg.size(); ++a)
        if (photometry.at(0, a) != photometry.at(last, a))
            throw Error{"photometry cannot be written as EULUMDAT",
                        fmt::format("gamma {}", photometry.angles_deg[a]),
                        fmt::format("in C360 what is in C0: {} cd", photometry.at(0, a)),
                        fmt::format("{} cd", photometry.at(last, a))};
}

void add_sizes(LineWriter& lines, const Photometry& photometry) {
    const glm::dvec3 housing_mm = kMmPerM * photometry.housing_m;
    lines.add(housing_mm.y);
    lines.add(housing_mm.x == housing_mm.y ? 0.0 : housing_mm.x);
    lines.add(housing_mm.z);
    const Opening& opening = photometry.opening;
    const glm::dvec3 lit_mm = kMmPerM * opening.size_m;
    // All that is not a rectangle is written as what the format has: something round.
    lines.add(lit_mm.y);
    lines.add(opening.shape == Shape::Rectangle ? lit_mm.x : 0.0);
    for (const double side_m : opening.sides_m)
        lines.add(kMmPerM * side_m);
}

void add_lamps(LineWriter& lines, const Photometry& photometry, double flux_lm) {
    const LampSet& lamps = photometry.lamps[static_cast<std::size_t>(photometry.lamp_set)];
    lines.add(1);
    lines.add(photometry.is_absolute ? -lamps.count : lamps.count);
    lines.add_text(lamps.type);
    lines.add(flux_lm);
    lines.add_text(lamps.color);
    lines.add_text(lamps.rendering);
    lines.add(lamps.input_w);
}

}  // namespace

std::string to_eulumdat(const Photometry& photometry) {
    check(photometry, "photometry to be written");
    check_fits(photometry);
    const double flux = flux_lm(photometry);
    const LampSet& lamps = photometry.lamps[static_cast<std::size_t>(photometry.lamp_set)];
    const double reference_lm = lamps.flux_lm > 0 ? lamps.flux_lm : flux;
    if (!(reference_lm > 0))
        throw Error{"photometry cannot be written as EULUMDAT", "luminous flux", "> 0", "0 lm"};
    const Symmetry symmetry = symmetry_written(photometry);
    const std::vector<double> listed = open_circle(photometry);

    LineWriter lines;
    lines.add_text(label(photometry, "MANUFAC"));
    lines.add(symmetry == Symmetry::Axial ? 1 : 3);
    lines.add(indicator_of(symmetry));
    lines.add(listed.size());
    lines.add(step_of(listed));
    lines.add(photometry.angles_deg.size());
    lines.add(step_of(photometry.angles_deg));
    for (const char* keyword : {"TEST", "LUMINAIRE", "LUMCAT", "_FILENAME", "DATE"})
        lines.add_text(label(photometry, keyword));
    add_sizes(lines, photometry);
    lines.add(flux > 0 ? 100 * flux_lm(photometry, 90) / flux : 0.0);
    lines.add(100 * flux / reference_lm);
    lines.add(1);  // conversion factor
    lines.add(photometry.tilt_when_measured_deg);
    add_lamps(lines, photometry, reference_lm);
    for (const double utilance : photometry.utilances)
        lines.add(utilance);
    for (const double plane_deg : listed)
        lines.add(plane_deg);
    for (const double angle_deg : photometry.angles_deg)
        lines.add(angle_deg);
    for (const std::size_t p : planes_written(photometry, symmetry))
        for (std::size_t a = 0; a < photometry.angles_deg.size(); ++a)
            lines.add(photometry.at(p, a) * 1000 / reference_lm);
    return lines.text();
}

}  // namespace nearfield::photometry
