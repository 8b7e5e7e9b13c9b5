// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/photometry/lm63.h"
#include "formats/photometry/lm63_opening.h"
#include "formats/photometry/symmetry.h"

#include <fmt/format.h>

#include <span>

namespace nearfield::photometry {
namespace {

// The standard allows 256 characters with the line's end.
constexpr std::size_t kMostColumns = 130;

// Numbers in their shortest text that reads back as the same double, lines broken between them.
void add_numbers(std::string& text, std::span<const double> numbers) {
    std::size_t column = 0;
    for (const double number : numbers) {
        const std::string word = fmt::format("{}", number);
        if (column > 0 && column + 1 + word.size() > kMostColumns) {
            text += "\r\n";
            column = 0;
        }
        text += column == 0 ? word : " " + word;
        column += word.size() + (column == 0 ? 0 : 1);
    }
    text += "\r\n";
}

void add_label(std::string& text, const std::string& keyword, const std::string& value) {
    std::size_t at = 0;
    for (std::string key = keyword; at <= value.size(); key = "MORE") {
        const std::size_t end = std::min(value.find('\n', at), value.size());
        text += fmt::format("[{}] {}\r\n", key, value.substr(at, end - at));
        at = end + 1;
    }
}

void add_labels(std::string& text, const Photometry& photometry) {
    // The edition of 2002 demands these.
    for (const char* keyword : {"TEST", "TESTLAB", "ISSUEDATE", "MANUFAC"})
        if (label(photometry, keyword).empty())
            add_label(text, keyword, "");
    for (const auto& [keyword, value] : photometry.labels)
        if (!value.empty())
            add_label(text, keyword.empty() ? "OTHER" : keyword, value);
    const std::string& lamp = photometry.lamps[static_cast<std::size_t>(photometry.lamp_set)].type;
    if (!lamp.empty() && label(photometry, "LAMP").empty())
        add_label(text, "LAMP", lamp);
}

void add_tilt(std::string& text, const std::optional<Tilt>& tilt) {
    if (!tilt) {
        text += "TILT=NONE\r\n";
        return;
    }
    text +=
        fmt::format("TILT=INCLUDE\r\n{}\r\n{}\r\n", tilt->lamp_geometry, tilt->angles_deg.size());
    add_numbers(text, tilt->angles_deg);
    add_numbers(text, tilt->factors);
}

int type_of(Coordinates coordinates) {
    return coordinates == Coordinates::C ? 1 : coordinates == Coordinates::B ? 2 : 3;
}

void check_can_be_told(const Photometry& photometry, Symmetry symmetry) {
    if (photometry.coordinates != Coordinates::C && photometry.planes_deg.front() == 0 &&
        symmetry == Symmetry::None)
        throw Error{"photometry cannot be written as LM-63", "horizontal angles",
                    "some below 0, since a file from 0 on is taken for symmetric",
                    fmt::format("0 ... {}", photometry.planes_deg.back())};
}

}  // namespace

std::string to_lm63(const Photometry& photometry) {
    check(photometry, "photometry to be written");
    const Symmetry symmetry = symmetry_of(photometry);
    check_can_be_told(photometry, symmetry);
    const std::vector<std::size_t> kept = planes_kept(photometry, symmetry);
    const LampSet& lamps = photometry.lamps[static_cast<std::size_t>(photometry.lamp_set)];
    const glm::dvec3 opening_m = signs_of_opening(photometry.opening);
    constexpr int kMeters = 2;

    std::string text = "IESNA:LM-63-2002\r\n";
    add_labels(text, photometry);
    add_tilt(text, photometry.tilt);
    text += fmt::format("{} {} 1 {} {} {} {} {} {} {}\r\n", lamps.count,
                        photometry.is_absolute ? -1.0 : lamps.flux_lm / lamps.count,
                        photometry.angles_deg.size(), kept.size(), type_of(photometry.coordinates),
                        kMeters, opening_m.x, opening_m.y, opening_m.z);
    text += fmt::format("1 1 {}\r\n", lamps.input_w);
    add_numbers(text, photometry.angles_deg);
    std::vector<double> planes;
    planes.reserve(kept.size());
    for (const std::size_t p : kept)
        planes.push_back(photometry.planes_deg[p]);
    add_numbers(text, planes);
    const std::size_t angles = photometry.angles_deg.size();
    for (const std::size_t p : kept)
        add_numbers(text, std::span(photometry.intensity_cd).subspan(p * angles, angles));
    return text;
}

}  // namespace nearfield::photometry
