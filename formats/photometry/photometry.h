// SPDX-License-Identifier: Apache-2.0
/// A lamp as a goniophotometer sees it from afar: a table of luminous intensities over directions,
/// and what its file says beside. docs/photometry.md has the conventions, with their sources.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::photometry {

/// How the two angles of a table name a direction (intensity.h has the formulas).
enum class Coordinates {
    C,  // planes C about the vertical, gamma in each from straight down
    B,  // planes H are latitudes towards the opening's width, V turns about that axis
    A,  // planes H about the vertical, V in each is the elevation: headlamps
};

/// The luminous opening's shape; its size is along the photometry's axes.
enum class Shape {
    Point,
    Rectangle,  // with a height: a box, whose sides shine too
    Ellipse,    // across z; with a height: a vertical cylinder
    CylinderX,  // lying along x
    CylinderY,  // lying along y
    Ellipsoid,
    UprightEllipse,  // across x: it faces the photometric horizontal
};

/// Where the light leaves the lamp, about the photometric center.
struct Opening {
    Shape shape = Shape::Point;
    glm::dvec3 size_m{0.0};  // x: along C0-C180, y: along C90-C270, z: the height
    /// Heights of the sides that look to C0, C90, C180 and C270; where a format has one height
    /// alone, all are that.
    std::array<double, 4> sides_m{};
};

/// Lamps that a luminaire is fitted with together.
struct LampSet {
    int count = 1;
    double flux_lm =
        0;  // of all lamps of the set; absolute photometry: of the luminaire, 0 unknown
    std::string type, color, rendering;
    double input_w = 0;
};

/// By how much the light changes when the luminaire is tilted: lamps that burn otherwise then.
/// Not applied to the table, since only a scene knows the tilt.
struct Tilt {
    int lamp_geometry =
        1;  // 1: lamp upright, 2: lying, stays so, 3: lying, tilts with the luminaire
    std::vector<double> angles_deg, factors;
};

/// What a photometric file holds. Angles are in degrees, as all such files have them.
struct Photometry {
    std::string format;  // "LM-63-2002", "EULUMDAT"
    Coordinates coordinates = Coordinates::C;
    /// Ascending. C: {0} alone for a lamp that is the same all around, else 0 ... 360 with both
    /// ends.
    std::vector<double> planes_deg;
    std::vector<double> angles_deg;  // ascending
    /// [plane][angle], candela; symmetries are unfolded, all factors of the file applied.
    std::vector<double> intensity_cd;
    /// The table holds the luminaire's own candela, rather than those with lamps of rated flux.
    bool is_absolute = false;
    std::vector<LampSet> lamps;  // alternatives; the table is for lamps[lamp_set]
    int lamp_set = 0;
    Opening opening;
    glm::dvec3 housing_m{0.0};           // size as the opening's, 0: not stated
    double tilt_when_measured_deg = 0;   // of road luminaires (EULUMDAT)
    std::array<double, 10> utilances{};  // EULUMDAT's direct ratios for room indices 0.6 ... 5
    std::optional<Tilt> tilt;
    /// Keywords of LM-63 without brackets and their text; lines that are continued are joined by
    /// line ends. EULUMDAT's lines bear LM-63's keywords. "": a line without a keyword.
    std::vector<std::pair<std::string, std::string>> labels;
    /// What the reader had to decide or found odd, a sentence each.
    std::vector<std::string> notes;

    double& at(std::size_t plane, std::size_t angle) {
        return intensity_cd[plane * angles_deg.size() + angle];
    }
    double at(std::size_t plane, std::size_t angle) const {
        return intensity_cd[plane * angles_deg.size() + angle];
    }
};

/// A label's text; empty where there is none.
std::string label(const Photometry& photometry, const std::string& keyword);

/// Between which degrees planes and angles of a table may lie.
struct AngleRange {
    double least_deg = 0, most_deg = 0;
};
AngleRange plane_range(Coordinates coordinates);
AngleRange angle_range(Coordinates coordinates);

/// Throws Error naming `what` and `where` unless the angles ascend within the range.
void check_ascending(const std::vector<double>& angles_deg,
                     AngleRange range,
                     const std::string& what,
                     const std::string& where);

/// Throws Error naming `where` and what breaks a rule above: ascending angles in their range,
/// finite intensities >= 0 as many as the angles ask for, a lamp set, sizes >= 0.
void check(const Photometry& photometry, const std::string& where);

}  // namespace nearfield::photometry
