// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/line_reader.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <cmath>

namespace nearfield::photometry {

std::string LineReader::text(const std::string& what) {
    last_ = next_;
    if (next_ >= file_.lines.size())
        refuse(what, "a line", "the end of the file");
    return file_.lines[next_++];
}

double LineReader::number(const std::string& what) {
    const std::string word = text(what);
    const auto value = number_of(word, true);
    if (!value)
        refuse(what, "a number", shown(word));
    return *value;
}

double LineReader::not_negative(const std::string& what) {
    const double value = number(what);
    if (!(value >= 0))
        refuse(what, ">= 0", fmt::format("{}", value));
    return value;
}

double LineReader::number_or_0(const std::string& what, double least) {
    if (next_ < file_.lines.size() && file_.lines[next_].empty()) {
        last_ = next_++;
        return 0;
    }
    const double value = number(what);
    if (!(value >= least))
        refuse(what, fmt::format("at least {}", least), fmt::format("{}", value));
    return value;
}

int LineReader::whole(const std::string& what, int least, int most) {
    const double value = number(what);
    if (!(value >= least && value <= most) || value != std::floor(value))
        refuse(what, fmt::format("a whole number of {} ... {}", least, most),
               fmt::format("{}", value));
    return static_cast<int>(value);
}

void LineReader::expect_end() {
    for (; next_ < file_.lines.size(); ++next_)
        if (!file_.lines[next_].empty() && file_.lines[next_] != kEndOfDosFile) {
            last_ = next_;
            refuse("end", "nothing after the last intensity", shown(file_.lines[next_]));
        }
}

void LineReader::refuse(const std::string& what,
                        const std::string& expected,
                        const std::string& got) const {
    throw Error{what + " of photometric file", file_.at(last_), expected, got};
}

}  // namespace nearfield::photometry
