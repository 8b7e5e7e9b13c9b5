// SPDX-License-Identifier: Apache-2.0
#include "tests/photometry/lamp_files.h"

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

namespace nearfield::test {
namespace {

std::string row(const std::vector<double>& numbers, const char* between) {
    std::ostringstream text;
    text.precision(17);
    for (std::size_t k = 0; k < numbers.size(); ++k)
        text << numbers[k] << (k + 1 == numbers.size() ? "\n" : between);
    return text.str();
}

std::vector<double> table(photometry::Coordinates coordinates,
                          const std::vector<double>& planes,
                          const std::vector<double>& angles) {
    std::vector<double> values;
    for (const double plane : planes)
        for (const double angle : angles)
            values.push_back(skew_lamp_cd(east_north_up(coordinates, plane, angle)));
    return values;
}

}  // namespace

double skew_lamp_cd(const glm::dvec3& d) {
    return 100 * (1 + 0.3 * d.x + 0.2 * d.y - 0.4 * d.z + 0.25 * d.x * d.y);
}

glm::dvec3 east_north_up(photometry::Coordinates coordinates, double plane_deg, double angle_deg) {
    const double p = plane_deg * std::numbers::pi / 180, a = angle_deg * std::numbers::pi / 180;
    switch (coordinates) {
        case photometry::Coordinates::C:
            return {std::sin(a) * std::cos(p), std::sin(a) * std::sin(p), -std::cos(a)};
        case photometry::Coordinates::B:
            return {std::cos(p) * std::sin(a), -std::sin(p), -std::cos(p) * std::cos(a)};
        case photometry::Coordinates::A:
            return {std::cos(a) * std::cos(p), -std::cos(a) * std::sin(p), std::sin(a)};
    }
    return {};
}

std::vector<double> steps(double first, double last, double step) {
    std::vector<double> values;
    for (int k = 0; first + k * step < last + step / 2; ++k)
        values.push_back(first + k * step);
    return values;
}

std::string to_text(const Lm63File& file) {
    std::ostringstream text;
    text << file.first_line << "\r\n";
    for (const std::string& label : file.labels)
        text << label << "\r\n";
    text << file.tilt << "\r\n" << file.lamps << " " << file.multiplier << " ";
    text << file.angles.size() << " " << file.planes.size() << " " << file.type << " ";
    text << file.unit << " " << file.opening << "\r\n" << file.factors << "\r\n";
    text << row(file.angles, " ") << row(file.planes, " ");
    const auto angles = static_cast<std::ptrdiff_t>(file.angles.size());
    for (auto at = file.intensities.begin(); at != file.intensities.end(); at += angles)
        text << row({at, at + angles}, at == file.intensities.begin() ? ", " : " ");
    return text.str();
}

std::string to_text(const LdtFile& file) {
    std::ostringstream text;
    text << "nobody\n3\n" << file.symmetry << "\n" << file.planes.size() << "\n0\n";
    text << file.angles.size() << "\n0\n17\na lamp\nnumber\nname\ndate\n";
    text << file.sizes << "100\n100\n" << file.conversion << "\n0\n" << file.lamp_sets;
    for (int k = 0; k < 10; ++k)
        text << "0." << k << "\n";
    text << row(file.planes, "\n") << row(file.angles, "\n") << row(file.intensities, "\n");
    return text.str();
}

Lm63File skew_lm63(photometry::Coordinates coordinates, double step_deg) {
    Lm63File file;
    int type = 0;
    switch (coordinates) {
        case photometry::Coordinates::C:
            type = 1;
            file.planes = steps(0, 360, step_deg);
            file.angles = steps(0, 180, step_deg);
            break;
        case photometry::Coordinates::B:
            type = 2;
            file.planes = steps(-90, 90, step_deg);
            file.angles = steps(-180, 180, step_deg);
            break;
        case photometry::Coordinates::A:
            type = 3;
            file.planes = steps(-180, 180, step_deg);
            file.angles = steps(-90, 90, step_deg);
            break;
    }
    file.type = std::to_string(type);
    file.intensities = table(coordinates, file.planes, file.angles);
    return file;
}

LdtFile skew_ldt(double step_deg) {
    LdtFile file;
    file.planes = steps(0, 360 - step_deg, step_deg);
    file.angles = steps(0, 180, step_deg);
    file.intensities = table(photometry::Coordinates::C, file.planes, file.angles);
    return file;
}

std::string write_text(const std::string& name, const std::string& text) {
    std::ofstream(name, std::ios::binary) << text;
    return name;
}

}  // namespace nearfield::test
