// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/eulumdat.h"

#include "formats/photometry/line_reader.h"
#include "formats/photometry/symmetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::photometry {
namespace {

constexpr double kMPerMm = 1e-3;
constexpr int kMostLampSets = 1000;

struct Counts {
    int symmetry = 0, planes = 0, angles = 0;
};

Counts read_counts(LineReader& lines) {
    Counts counts;
    lines.whole("type indicator", 0, 3);
    counts.symmetry = lines.whole("symmetry indicator", 0, 4);
    counts.planes = lines.whole("number of C planes", 1, kMostAngles);
    const int divisor = counts.symmetry < 2 ? 1 : counts.symmetry == 4 ? 4 : 2;
    if (counts.planes % divisor != 0)
        lines.refuse("number of C planes",
                     fmt::format("a multiple of {} for symmetry {}", divisor, counts.symmetry),
                     fmt::format("{}", counts.planes));
    lines.number("distance of C planes");  // said again by their list, which alone is exact
    counts.angles = lines.whole("number of intensities in a plane", 2, kMostAngles);
    lines.number("distance of intensities");
    return counts;
}

// Size of a body by length (or diameter), width (0: round): length lies along C90-C270.
glm::dvec3 size_of(double length_m, double width_m, double height_m) {
    return {width_m == 0 ? length_m : width_m, length_m, height_m};
}

void read_sizes(LineReader& lines, Photometry& photometry) {
    const auto length_m = [&](const char* what) { return kMPerMm * lines.number_or_0(what, 0); };
    const double length = length_m("length of luminaire"), width = length_m("width of luminaire");
    photometry.housing_m = size_of(length, width, length_m("height of luminaire"));
    const double lit_length = length_m("length of luminous area");
    const double lit_width = length_m("width of luminous area");
    Opening& opening = photometry.opening;
    for (double& side_m : opening.sides_m)
        side_m = length_m("height of luminous area");
    const double height = *std::max_element(opening.sides_m.begin(), opening.sides_m.end());
    opening.size_m = size_of(lit_length, lit_width, height);
    opening.shape = lit_length == 0 && lit_width == 0 && height == 0 ? Shape::Point
                    : lit_width == 0                                 ? Shape::Ellipse
                                                                     : Shape::Rectangle;
}

LampSet read_lamp_set(LineReader& lines) {
    LampSet lamps;
    lamps.count = lines.whole("number of lamps", -1000000, 1000000);  // < 0: absolute photometry
    lamps.type = lines.text("type of lamps");
    lamps.flux_lm = lines.not_negative("luminous flux of lamps");
    lamps.color = lines.text("color of lamps");
    lamps.rendering = lines.text("color rendering of lamps");
    lamps.input_w = lines.number_or_0("watts of lamps", 0);
    return lamps;
}

// Candela per unit of the file's intensities. Throws Error where there is no such lamp set.
double read_scale(LineReader& lines, int lamp_set, double conversion, Photometry& photometry) {
    const int sets = lines.whole("number of lamp sets", 1, kMostLampSets);
    if (lamp_set < 0 || lamp_set >= sets)
        lines.refuse("lamp set", fmt::format("0 ... {}", sets - 1), fmt::format("{}", lamp_set));
    double scale = 0;
    for (int k = 0; k < sets; ++k) {
        LampSet lamps = read_lamp_set(lines);
        if (k == lamp_set) {
            scale = conversion * lamps.flux_lm / 1000;
            photometry.is_absolute = lamps.count < 0;
            if (!(scale > 0) || !std::isfinite(scale))
                lines.refuse("lamps", "a luminous flux > 0 and a conversion factor > 0",
                             fmt::format("{} lm, factor {}", lamps.flux_lm, conversion));
        }
        lamps.count = std::max(std::abs(lamps.count), 1);
        photometry.lamps.push_back(std::move(lamps));
    }
    photometry.lamp_set = lamp_set;
    return scale;
}

std::vector<double> read_angles(LineReader& lines,
                                const std::string& what,
                                AngleRange range,
                                int count) {
    std::vector<double> angles;
    for (int k = 0; k < count; ++k) {
        const double angle = lines.number(what);
        if (!(angle >= range.least_deg && angle <= range.most_deg))
            lines.refuse(what, fmt::format("{} ... {} degrees", range.least_deg, range.most_deg),
                         fmt::format("{}", angle));
        if (!angles.empty() && !(angle > angles.back()))
            lines.refuse(what, "ascending angles",
                         fmt::format("{} after {}", angle, angles.back()));
        angles.push_back(angle);
    }
    return angles;
}

// The planes that the file holds, in its order, of those that it lists. With symmetry 3 they go
// from C270 over C0 to C90 (Stockmar: Mc1 = 3 Mc / 4 + 1, Mc2 = Mc1 + Mc / 2).
std::vector<double> planes_held(const LineReader& lines,
                                const Counts& counts,
                                const std::vector<double>& listed) {
    const std::size_t n = listed.size();
    const auto need = [&](std::size_t index, double expected_deg) {
        if (!is_angle(listed[index], expected_deg))
            lines.refuse("C planes",
                         fmt::format("C{} as number {} for symmetry {}", expected_deg, index + 1,
                                     counts.symmetry),
                         fmt::format("C{}", listed[index]));
    };
    need(0, 0);
    const auto first = listed.begin();
    const auto leading = [&](std::size_t last_index, double last_deg) {
        need(last_index, last_deg);
        std::vector<double> held(first, first + static_cast<std::ptrdiff_t>(last_index) + 1);
        held.back() = last_deg;
        return held;
    };
    switch (counts.symmetry) {
        case 1:
            return {0};
        case 2:
            return leading(n / 2, 180);
        case 3: {
            if (n % 4 != 0)
                lines.refuse("C planes", "a multiple of 4 for symmetry 3", fmt::format("{}", n));
            need(3 * n / 4, 270);
            const std::vector<double> right = leading(n / 4, 90);
            std::vector<double> held(first + static_cast<std::ptrdiff_t>(3 * n / 4), listed.end());
            held.front() = 270;
            held.insert(held.end(), right.begin(), right.end());
            return held;
        }
        case 4:
            return leading(n / 4, 90);
        default:
            break;
    }
    return listed;
}

void read_table(LineReader& lines, const Counts& counts, double scale, Photometry& photometry) {
    const std::vector<double> listed =
        read_angles(lines, "C plane", plane_range(Coordinates::C), counts.planes);
    const std::vector<double> held = planes_held(lines, counts, listed);
    photometry.angles_deg = read_angles(lines, "gamma", angle_range(Coordinates::C), counts.angles);
    std::vector<double> rows;
    for (std::size_t k = 0; k < held.size() * photometry.angles_deg.size(); ++k)
        rows.push_back(scale * lines.not_negative("intensity"));
    if (counts.symmetry == 3) {
        // Mirrored, C270 ... C0 ... C90 become C270 ... C180 ... C90: backwards, they ascend.
        const std::size_t angles = photometry.angles_deg.size();
        for (std::size_t p = held.size(); p-- > 0;) {
            photometry.planes_deg.push_back(held[p] > 180 ? 540 - held[p] : 180 - held[p]);
            const auto row = rows.begin() + static_cast<std::ptrdiff_t>(p * angles);
            photometry.intensity_cd.insert(photometry.intensity_cd.end(), row,
                                           row + static_cast<std::ptrdiff_t>(angles));
        }
        return;
    }
    photometry.planes_deg = held;
    photometry.intensity_cd = std::move(rows);
    if (counts.symmetry != 0)
        return;
    if (is_angle(photometry.planes_deg.back(), 360)) {
        photometry.planes_deg.back() = 360;
    } else {
        photometry.planes_deg.push_back(360);
        for (std::size_t a = 0; a < photometry.angles_deg.size(); ++a)
            photometry.intensity_cd.push_back(photometry.at(0, a));
    }
}

Symmetry symmetry_by_indicator(int indicator) {
    switch (indicator) {
        case 1:
            return Symmetry::Axial;
        case 2:
            return Symmetry::AcrossC0;
        case 3:
            return Symmetry::AcrossC90;
        case 4:
            return Symmetry::Quadrants;
        default:
            return Symmetry::None;
    }
}

bool is_whole_within(const std::string& line, int least, int most) {
    const auto number = number_of(line, true);
    return number && *number >= least && *number <= most && *number == std::floor(*number);
}

}  // namespace

bool is_eulumdat(const TextFile& file) {
    return file.lines.size() > 26 && is_whole_within(file.lines[1], 0, 9) &&
           is_whole_within(file.lines[2], 0, 9) && is_whole_within(file.lines[3], 0, 1000000) &&
           is_whole_within(file.lines[5], 0, 1000000);
}

Photometry read_eulumdat(const TextFile& file, int lamp_set) {
    LineReader lines(file);
    Photometry photometry;
    photometry.format = "EULUMDAT";
    const auto read_label = [&](const char* keyword) {
        if (std::string text = lines.text(keyword); !text.empty())
            photometry.labels.emplace_back(keyword, std::move(text));
    };
    read_label("MANUFAC");
    const Counts counts = read_counts(lines);
    for (const char* keyword : {"TEST", "LUMINAIRE", "LUMCAT", "_FILENAME", "DATE"})
        read_label(keyword);
    read_sizes(lines, photometry);
    lines.number_or_0("downward flux fraction", 0);  // both follow from the table
    lines.number_or_0("light output ratio", 0);
    const double conversion = lines.not_negative("conversion factor");
    photometry.tilt_when_measured_deg = lines.number_or_0("tilt when measured", -360);
    const double scale = read_scale(lines, lamp_set, conversion, photometry);
    for (double& utilance : photometry.utilances)
        utilance = lines.number_or_0("direct ratio", 0);
    read_table(lines, counts, scale, photometry);
    lines.expect_end();
    unfold(photometry, symmetry_by_indicator(counts.symmetry));
    check(photometry, file.path);
    return photometry;
}

}  // namespace nearfield::photometry
