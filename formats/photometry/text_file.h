// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nearfield::photometry {

/// More planes or angles than any goniophotometer takes: 0.05 degrees apart.
constexpr int kMostAngles = 7201;

/// What DOS ends text files with.
constexpr const char* kEndOfDosFile = "\x1A";

/// A text file by lines, so that errors can name them.
struct TextFile {
    std::string path;
    std::vector<std::string> lines;  // without line ends (LF, CR LF or CR) and blanks around

    /// "lamp.ies, line 12", counted from 1.
    std::string at(std::size_t line) const;
};

/// A byte order mark (UTF-8) is left out; texts are bytes, in whatever encoding the file has.
/// Throws Error if the file cannot be read, is larger than 64 MiB or holds a zero byte.
TextFile read_text(const std::string& path);

/// The same of a file's bytes; `path` names them in errors. Throws Error at a zero byte.
TextFile split_lines(const std::string& path, const std::string& bytes);

/// A word in quotes for a message, long ones cut.
std::string shown(std::string_view word);

/// A number and nothing else, finite; a sign "+" is taken, and a comma for the decimal point where
/// `is_comma_point`.
std::optional<double> number_of(std::string_view word, bool is_comma_point = false);

/// Whether an angle ends a range: files round their angles to hundredths.
bool is_angle(double angle_deg, double expected_deg);

/// The numbers of a text, with blanks, commas or line ends between them.
class NumberReader {
  public:
    NumberReader(const TextFile& file, std::size_t line) : file_(file), line_(line) {}

    /// The next number. Throws Error with its line and `what` it was to be, where the file ends or
    /// something else stands there.
    double next(const std::string& what);
    /// The same with a sign. Throws Error too where it has another.
    double next_positive(const std::string& what);
    double next_not_negative(const std::string& what);
    /// The same, whole and within bounds. Throws Error too where it is not.
    int next_whole(const std::string& what, int least, int most);
    std::vector<double> next_many(const std::string& what, int count);
    /// Throws Error where anything but blanks is left of the file.
    void expect_end();

    /// Where the last number stood.
    std::string where() const { return file_.at(line_of_last_); }
    /// Where the next number may stand.
    std::size_t line() const { return line_; }

  private:
    std::string_view next_word();  // empty: the end

    const TextFile& file_;
    std::size_t line_, column_ = 0, line_of_last_ = 0;
};

}  // namespace nearfield::photometry
