// SPDX-License-Identifier: Apache-2.0
#include "formats/files/points.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iostream>
#include <string_view>

namespace nearfield {
namespace {

constexpr std::array<std::string_view, 6> kColumns = {"x_m", "y_m", "z_m", "nx", "ny", "nz"};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos)
        return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> fields;
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
        comma = line.find(',');
        fields.push_back(trimmed(line.substr(0, comma)));
        line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
    }
    return fields;
}

/// For each of kColumns its place in a row.
std::array<std::size_t, kColumns.size()> find_columns(std::string_view header,
                                                      const std::string& where) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (header.starts_with(kByteOrderMark))
        header.remove_prefix(kByteOrderMark.size());
    const std::vector<std::string_view> names = split(header);
    std::array<std::size_t, kColumns.size()> places{};
    for (std::size_t k = 0; k < kColumns.size(); ++k) {
        const auto count = std::count(names.begin(), names.end(), kColumns[k]);
        if (count != 1)
            throw Error{"bad header", where, fmt::format("columns {}, each once", kPointColumns),
                        fmt::format("{} times {}", count, kColumns[k])};
        places[k] = static_cast<std::size_t>(std::find(names.begin(), names.end(), kColumns[k]) -
                                             names.begin());
    }
    return places;
}

double parse_number(std::string_view text, const std::string& where) {
    double value = 0;
    std::string_view digits = text;
    if (digits.starts_with('+'))  // which std::from_chars does not take
        digits.remove_prefix(1);
    const char* end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    if (error != std::errc{} || stop != end || !std::isfinite(value))
        throw Error{"bad number", where, "a finite number",
                    fmt::format("'{}'", text.substr(0, 60))};
    return value;
}

void add_point(PointList& points,
               const std::vector<std::string_view>& fields,
               const std::array<std::size_t, kColumns.size()>& places,
               const std::string& where) {
    std::array<double, kColumns.size()> v{};
    std::string line;
    for (std::size_t k = 0; k < kColumns.size(); ++k) {
        const std::string place = fmt::format("{}, column {}", where, kColumns[k]);
        if (places[k] >= fields.size())
            throw Error{"missing value", place, fmt::format("{} columns at least", places[k] + 1),
                        fmt::format("{}", fields.size())};
        const std::string_view text = fields[places[k]];
        v[k] = parse_number(text, place);
        line += (k == 0 ? "" : ",");
        line += text;
    }
    // Scaled first, so that the length neither overflows nor vanishes.
    const double largest = std::max({std::abs(v[3]), std::abs(v[4]), std::abs(v[5])});
    if (largest == 0.0)
        throw Error{"bad normal", where + ", columns nx,ny,nz", "not zero", "0,0,0"};
    points.lines_text.push_back(std::move(line));
    points.positions_m.emplace_back(v[0], v[1], v[2]);
    points.normals.push_back(
        glm::normalize(glm::dvec3(v[3] / largest, v[4] / largest, v[5] / largest)));
}

PointList read(std::istream& stream, const std::string& name) {
    std::string line;
    if (!std::getline(stream, line))
        throw Error{"empty file", name, fmt::format("header {}", kPointColumns)};
    const auto places = find_columns(line, name + ", line 1");
    PointList points;
    for (std::size_t number = 2; std::getline(stream, line); ++number)
        if (!trimmed(line).empty())
            add_point(points, split(line), places, fmt::format("{}, line {}", name, number));
    if (stream.bad())
        throw Error{"cannot read file", name, "", system_error()};
    return points;
}

}  // namespace

PointList read_points(const std::string& path) {
    if (path == "-")
        return read(std::cin, "standard input");
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error{"cannot read file", path, "", system_error()};
    return read(file, path);
}

}  // namespace nearfield
