// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/ray_rows.h"

#include "formats/files/error.h"
#include "formats/rays/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace nearfield::rays {
namespace {

constexpr std::uint64_t kRowsAtATime = 65536;
constexpr std::uint64_t kTextBytes = 1 << 20, kLongestLine = 65536;

bool is_blank(std::string_view line) {
    return line.find_first_not_of(" \t\r") == std::string_view::npos;
}

}  // namespace

std::string RowReader::where(const RayRows& rows, std::size_t r) const {
    const std::uint64_t byte =
        layout_.is_text ? rows.bytes[r] : rows.bytes.front() + r * layout_.columns * sizeof(float);
    return fmt::format("{}, ray {}", file_.at(byte), rows.first_ray + r);
}

void RowReader::next(RayRows& rows) {
    rows.first_ray = done_;
    rows.count = 0;
    layout_.is_text ? next_text(rows) : next_binary(rows);
    done_ += rows.count;
}

void RowReader::next_binary(RayRows& rows) {
    rows.count = std::min(kRowsAtATime, layout_.ray_count - done_);
    rows.values.resize(rows.count * layout_.columns);
    rows.bytes = {file_.position()};
    file_.read(rows.values.data(), rows.values.size() * sizeof(float));
}

void RowReader::fill() {
    text_.erase(0, at_);
    at_ = 0;
    const std::size_t had = text_.size();
    text_.resize(had + std::min(kTextBytes, file_.remaining()));
    file_.read(text_.data() + had, text_.size() - had);
}

bool RowReader::next_line(std::string_view& line, std::uint64_t& byte) {
    std::size_t end = text_.find('\n', at_);
    if (end == std::string::npos && file_.remaining() > 0 && text_.size() - at_ <= kLongestLine) {
        fill();
        end = text_.find('\n', at_);
    }
    byte = file_.position() - (text_.size() - at_);
    if (at_ == text_.size())
        return false;
    end = std::min(end, text_.size());
    line = std::string_view(text_).substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    return true;
}

// Behind the last row: the format's own words, or nothing.
void RowReader::check_end(std::string_view line, std::uint64_t byte) {
    is_over_ = true;
    const std::uint64_t rest = file_.remaining() + text_.size() - at_;
    if (rest > kLongestLine ||
        !is_blank(std::string_view(text_).substr(std::min(at_, text_.size()))))
        throw Error{"ray file is longer than its rays", file_.at(byte + line.size()),
                    "the end of the file", fmt::format("{} more bytes", rest)};
}

void RowReader::next_text(RayRows& rows) {
    const auto columns = static_cast<int>(layout_.columns);
    rows.values.resize(kRowsAtATime * layout_.columns);
    rows.bytes.clear();
    std::string_view line;
    std::uint64_t byte = 0;
    while (!is_over_ && rows.count < kRowsAtATime) {
        const std::uint64_t ray = done_ + rows.count;
        const bool is_last = layout_.ray_count > 0 && ray == layout_.ray_count;
        if (is_last)
            return check_end("", file_.position() - (text_.size() - at_));
        if (!next_line(line, byte))
            throw Error{"ray file is truncated", fmt::format("{}, ray {}", file_.at(byte), ray),
                        layout_.ray_count > 0 ? fmt::format("{} rays", layout_.ray_count)
                                              : "a line '" + layout_.end + "'",
                        fmt::format("{} whole rays", ray)};
        if (!layout_.end.empty() && line.substr(0, layout_.end.size()) == layout_.end)
            return check_end(line, byte);
        if (is_blank(line))
            continue;
        float* row = rows.values.data() + rows.count * layout_.columns;
        const int numbers = parse_numbers(line, row, columns);
        if (numbers != columns)
            throw Error{"ray file holds a line that is no ray",
                        fmt::format("{}, ray {}", file_.at(byte), ray),
                        fmt::format("{} numbers", columns),
                        numbers < 0 ? "'" + std::string(line.substr(0, 40)) + "'"
                                    : fmt::format("{}", numbers)};
        rows.bytes.push_back(byte);
        ++rows.count;
    }
}

}  // namespace nearfield::rays
