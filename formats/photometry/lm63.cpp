// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/lm63.h"

#include "formats/files/error.h"
#include "formats/photometry/lm63_opening.h"
#include "formats/photometry/table_ends.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace nearfield::photometry {
namespace {

constexpr double kMetersPerFoot = 0.3048;

std::size_t tilt_line(const TextFile& file) {
    const auto found =
        std::find_if(file.lines.begin(), file.lines.end(),
                     [](const std::string& line) { return line.starts_with("TILT="); });
    return static_cast<std::size_t>(found - file.lines.begin());
}

// The edition: by the first line, which that of 1986 does not have.
int year_of(const TextFile& file) {
    const std::string& line = file.lines.front();
    if (!line.starts_with("IES"))
        return 1986;
    for (const auto& [ending, year] :
         {std::pair{"86", 1986}, {"91", 1991}, {"95", 1995}, {"02", 2002}, {"19", 2019}})
        if (line.ends_with(ending))
            return year;
    throw Error{"edition of LM-63", file.at(0), "IESNA91, IESNA:LM-63-1995, -2002, IES:LM-63-2019",
                shown(line)};
}

// "[KEY] text" lines, "[MORE]" continues the last; other lines have no key.
void read_labels(const TextFile& file, std::size_t first, std::size_t end, Photometry& photometry) {
    for (std::size_t k = first; k < end; ++k) {
        const std::string& line = file.lines[k];
        const std::size_t close = line.find(']');
        if (!line.starts_with('[') || close == std::string::npos) {
            if (!line.empty())
                photometry.labels.emplace_back("", line);
            continue;
        }
        const std::string key = line.substr(1, close - 1);
        const std::size_t start = line.find_first_not_of(" \t", close + 1);
        const std::string text = start == std::string::npos ? "" : line.substr(start);
        if (key == "MORE" && !photometry.labels.empty())
            photometry.labels.back().second += "\n" + text;
        else
            photometry.labels.emplace_back(key, text);
    }
}

Tilt read_tilt(NumberReader& numbers) {
    Tilt tilt;
    tilt.lamp_geometry = numbers.next_whole("lamp to luminaire geometry", 1, 3);
    const int count = numbers.next_whole("number of tilt angles", 1, kMostAngles);
    tilt.angles_deg = numbers.next_many("tilt angle", count);
    for (std::size_t k = 1; k < tilt.angles_deg.size(); ++k)
        if (!(tilt.angles_deg[k] > tilt.angles_deg[k - 1]))
            throw Error{"tilt angles of photometric file", numbers.where(), "ascending angles",
                        fmt::format("{} after {}", tilt.angles_deg[k], tilt.angles_deg[k - 1])};
    for (int k = 0; k < count; ++k)
        tilt.factors.push_back(numbers.next_not_negative("tilt factor"));
    return tilt;
}

// The file beside this one that a TILT line names; nothing outside of the folder is opened.
Tilt read_tilt_file(const TextFile& file, std::size_t line, const std::string& name) {
    if (name.empty() || name.find_first_of("/\\:") != std::string::npos || name.starts_with('.'))
        throw Error{"tilt of photometric file", file.at(line),
                    "NONE, INCLUDE or the name of a file in the same folder", shown(name)};
    const std::filesystem::path path = std::filesystem::path(file.path).parent_path() / name;
    const TextFile beside = read_text(path.string());
    NumberReader numbers(beside, 0);
    Tilt tilt = read_tilt(numbers);
    numbers.expect_end();
    return tilt;
}

Coordinates coordinates_of(int type) {
    return type == 1 ? Coordinates::C : type == 2 ? Coordinates::B : Coordinates::A;
}

// What stands before the angles.
struct Head {
    int angle_count = 0, plane_count = 0;
    double factor = 1;
};

LampSet read_lamps(NumberReader& numbers, Photometry& photometry) {
    LampSet lamps;
    lamps.count = numbers.next_whole("number of lamps", 1, 1000000);
    const double flux_lm = numbers.next("lumens per lamp");
    photometry.is_absolute = flux_lm == -1;
    if (!photometry.is_absolute && !(flux_lm > 0))
        throw Error{"lumens per lamp of photometric file", numbers.where(),
                    "> 0, or -1 for absolute photometry", fmt::format("{}", flux_lm)};
    lamps.flux_lm = photometry.is_absolute ? 0 : lamps.count * flux_lm;
    lamps.type = label(photometry, "LAMP");
    return lamps;
}

Opening read_opening(NumberReader& numbers, int year, double m_per_unit) {
    const double width_m = m_per_unit * numbers.next("width of the luminous opening");
    const double length_m = m_per_unit * numbers.next("length of the luminous opening");
    const double height_m = m_per_unit * numbers.next("height of the luminous opening");
    const auto opening = opening_of_signs(year, width_m, length_m, height_m);
    if (!opening)
        throw Error{
            "luminous opening of photometric file", numbers.where(),
            "a combination of signs that an edition has",
            fmt::format("width {} m, length {} m, height {} m", width_m, length_m, height_m)};
    return *opening;
}

Head read_head(NumberReader& numbers, int year, Photometry& photometry) {
    Head head;
    LampSet lamps = read_lamps(numbers, photometry);
    head.factor = numbers.next_positive("multiplier of intensities");
    head.angle_count = numbers.next_whole("number of vertical angles", 2, kMostAngles);
    head.plane_count = numbers.next_whole("number of horizontal angles", 1, kMostAngles);
    photometry.coordinates = coordinates_of(numbers.next_whole("photometric type", 1, 3));
    const bool is_feet = numbers.next_whole("unit of lengths", 1, 2) == 1;
    photometry.opening = read_opening(numbers, year, is_feet ? kMetersPerFoot : 1);
    head.factor *= numbers.next_positive("ballast factor");
    // 1986 and 1991: a factor; 1995 and 2002: for the future; 2019: how the file was made.
    const double third = numbers.next("ballast-lamp factor");
    if (year <= 1991)
        head.factor *= third;
    if (!(head.factor > 0) || !std::isfinite(head.factor))
        throw Error{"factors of photometric file", numbers.where(), "a finite product > 0",
                    fmt::format("{}", head.factor)};
    lamps.input_w = numbers.next_not_negative("input watts");
    photometry.lamps = {std::move(lamps)};
    return head;
}

}  // namespace

bool is_lm63(const TextFile& file) {
    return tilt_line(file) < file.lines.size();
}

Photometry read_lm63(const TextFile& file) {
    const std::size_t line = tilt_line(file);
    const int year = year_of(file);
    Photometry photometry;
    photometry.format = fmt::format("LM-63-{}", year);
    read_labels(file, file.lines.front().starts_with("IES") ? 1 : 0, line, photometry);
    NumberReader numbers(file, line + 1);
    const std::string tilt = file.lines[line].substr(std::string("TILT=").size());
    if (tilt == "INCLUDE")
        photometry.tilt = read_tilt(numbers);
    else if (tilt != "NONE")
        photometry.tilt = read_tilt_file(file, line, tilt);

    const Head head = read_head(numbers, year, photometry);
    photometry.angles_deg = numbers.next_many("vertical angle", head.angle_count);
    check_ascending(photometry.angles_deg, angle_range(photometry.coordinates),
                    "vertical angles of photometric file", numbers.where());
    photometry.planes_deg = numbers.next_many("horizontal angle", head.plane_count);
    check_ascending(photometry.planes_deg, plane_range(photometry.coordinates),
                    "horizontal angles of photometric file", numbers.where());
    const Symmetry symmetry = symmetry_by_last_plane(photometry, numbers.where());
    const int count = head.angle_count * head.plane_count;
    for (int k = 0; k < count; ++k)
        photometry.intensity_cd.push_back(head.factor * numbers.next_not_negative(fmt::format(
                                                            "intensity {} of {}", k + 1, count)));
    numbers.expect_end();
    close_circle(photometry);
    unfold(photometry, symmetry);
    note_missing_angles(photometry);
    check(photometry, file.path);
    return photometry;
}

}  // namespace nearfield::photometry
