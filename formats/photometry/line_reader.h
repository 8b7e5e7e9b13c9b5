// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/photometry/text_file.h"

#include <string>

namespace nearfield::photometry {

/// A text with a value a line. All throw Error with the line, what it was to be and what is there,
/// where it is something else or the file ends.
class LineReader {
  public:
    explicit LineReader(const TextFile& file) : file_(file) {}

    std::string text(const std::string& what);
    double number(const std::string& what);
    double not_negative(const std::string& what);
    /// At least `least`; 0 where the line is empty: lengths and remarks that many files leave out.
    double number_or_0(const std::string& what, double least);
    int whole(const std::string& what, int least, int most);
    void expect_end();

    /// Throws the Error for the line that was read last.
    [[noreturn]] void refuse(const std::string& what,
                             const std::string& expected,
                             const std::string& got) const;

  private:
    const TextFile& file_;
    std::size_t next_ = 0, last_ = 0;
};

}  // namespace nearfield::photometry
