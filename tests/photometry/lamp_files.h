// SPDX-License-Identifier: Apache-2.0
/// Photometric files that tests make for themselves, and a lamp without any symmetry to fill them.
#pragma once

#include "formats/photometry/photometry.h"

#include <string>
#include <vector>

namespace nearfield::test {

/// A lamp by formula, in a frame of its own: east (towards C0), north (towards C90), up.
/// I = 100 (1 + 0.3 e + 0.2 n - 0.4 u + 0.25 e n) cd: 400 pi lm in all, 240 pi lm downwards.
double skew_lamp_cd(const glm::dvec3& east_north_up);
constexpr double kSkewLampOverPi_lm = 400, kSkewLampDownOverPi_lm = 240;

/// Where two angles point in that frame, after the words of LM-63: type C counts counterclockwise
/// seen from above, from straight down; type A clockwise, from the horizontal upwards; type B's V
/// turns from straight down to the east, H from there to the south.
glm::dvec3 east_north_up(photometry::Coordinates coordinates, double plane_deg, double angle_deg);

/// first, first + step, ... last.
std::vector<double> steps(double first, double last, double step);

struct Lm63File {
    std::string first_line = "IESNA:LM-63-2002";
    std::vector<std::string> labels = {"[TEST] 17", "[MANUFAC] nobody"};
    std::string tilt = "TILT=NONE";
    std::string lamps = "1 1000", multiplier = "1", type = "1", unit = "2", opening = "0 0 0";
    std::string factors = "1 1 10";
    std::vector<double> angles, planes, intensities;  // [plane][angle]
};
std::string to_text(const Lm63File& file);

/// A line a member; lamps: six lines a set.
struct LdtFile {
    int symmetry = 0;
    std::string sizes = "0\n0\n0\n0\n0\n0\n0\n0\n0\n";
    std::string conversion = "1", lamp_sets = "1\n1\nLED\n1000\n4000\n80\n10\n";
    std::vector<double> planes, angles, intensities;  // cd / klm, in the file's order
};
std::string to_text(const LdtFile& file);

/// The skew lamp measured: full circle of planes for type C, all angles; a value a cell.
Lm63File skew_lm63(photometry::Coordinates coordinates, double step_deg);
LdtFile skew_ldt(double step_deg);

/// Writes bytes into the working directory; the path.
std::string write_text(const std::string& name, const std::string& text);

}  // namespace nearfield::test
