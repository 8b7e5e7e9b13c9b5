// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/text_file.h"

#include "formats/files/error.h"
#include "formats/files/read_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace nearfield::photometry {
namespace {

constexpr const char* kBlanks = " \t\f\v";
// A comma too, and kEndOfDosFile.
constexpr const char* kBetween = " \t\f\v,\x1A";

std::string trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    return first == std::string_view::npos
               ? std::string()
               : std::string(text.substr(first, text.find_last_not_of(kBlanks) - first + 1));
}

}  // namespace

std::string shown(std::string_view word) {
    constexpr std::size_t kMostShown = 40;
    return word.size() > kMostShown ? fmt::format("'{}'...", word.substr(0, kMostShown))
                                    : fmt::format("'{}'", word);
}

std::string TextFile::at(std::size_t line) const {
    return fmt::format("{}, line {}", path, line + 1);
}

TextFile read_text(const std::string& path) {
    return split_lines(path, read_file(path));
}

TextFile split_lines(const std::string& path, const std::string& bytes) {
    TextFile file{path, {}};
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    for (std::size_t at = bytes.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
         at < bytes.size();) {
        const std::size_t end = std::min(bytes.find_first_of("\r\n", at), bytes.size());
        file.lines.push_back(trimmed(std::string_view(bytes).substr(at, end - at)));
        at = end + (bytes.compare(end, 2, "\r\n") == 0 ? 2 : 1);
        if (file.lines.back().find('\0') != std::string::npos)
            throw Error{"photometric file is not a text", file.at(file.lines.size() - 1),
                        "characters", "a zero byte"};
    }
    return file;
}

std::optional<double> number_of(std::string_view word, bool is_comma_point) {
    std::string text(word);
    if (is_comma_point)
        std::replace(text.begin(), text.end(), ',', '.');
    const char* first = text.data();
    const char* last = first + text.size();
    if (text.size() > 1 && text[0] == '+' && text[1] != '-')
        ++first;
    double number = 0;
    const auto [end, failure] = std::from_chars(first, last, number);
    if (failure != std::errc{} || end != last || !std::isfinite(number))
        return std::nullopt;
    return number;
}

bool is_angle(double angle_deg, double expected_deg) {
    return std::abs(angle_deg - expected_deg) < 0.01;
}

std::string_view NumberReader::next_word() {
    for (; line_ < file_.lines.size(); ++line_, column_ = 0) {
        const std::string_view line = file_.lines[line_];
        const std::size_t first = line.find_first_not_of(kBetween, column_);
        if (first == std::string_view::npos)
            continue;
        column_ = std::min(line.find_first_of(kBetween, first), line.size());
        line_of_last_ = line_;
        return line.substr(first, column_ - first);
    }
    line_of_last_ = file_.lines.empty() ? 0 : file_.lines.size() - 1;
    return {};
}

double NumberReader::next(const std::string& what) {
    const std::string_view word = next_word();
    const auto number = number_of(word);
    if (!number)
        throw Error{what + " of photometric file", where(), "a number",
                    word.empty() ? "the end of the file" : shown(word)};
    return *number;
}

double NumberReader::next_positive(const std::string& what) {
    const double number = next(what);
    if (!(number > 0))
        throw Error{what + " of photometric file", where(), "> 0", fmt::format("{}", number)};
    return number;
}

double NumberReader::next_not_negative(const std::string& what) {
    const double number = next(what);
    if (!(number >= 0))
        throw Error{what + " of photometric file", where(), ">= 0", fmt::format("{}", number)};
    return number;
}

int NumberReader::next_whole(const std::string& what, int least, int most) {
    const double number = next(what);
    if (!(number >= least && number <= most) || number != std::floor(number))
        throw Error{what + " of photometric file", where(),
                    fmt::format("a whole number of {} ... {}", least, most),
                    fmt::format("{}", number)};
    return static_cast<int>(number);
}

std::vector<double> NumberReader::next_many(const std::string& what, int count) {
    std::vector<double> numbers;
    numbers.reserve(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k)
        numbers.push_back(next(fmt::format("{} {} of {}", what, k + 1, count)));
    return numbers;
}

void NumberReader::expect_end() {
    const std::string_view word = next_word();
    if (!word.empty())
        throw Error{"photometric file is longer than its counts say", where(),
                    "the end of the file", shown(word)};
}

}  // namespace nearfield::photometry
