// SPDX-License-Identifier: Apache-2.0
/// Rows of a ray file, some ten thousands at a time, whatever its format.
#pragma once

#include "formats/rays/byte_reader.h"
#include "formats/rays/ray_layout.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::rays {

struct RayRows {
    std::vector<float> values;  // row r, column c at r * columns + c
    std::size_t count = 0;
    std::uint64_t first_ray = 0;
    std::vector<std::uint64_t> bytes;  // where each row starts in text; one entry, the first row's,
                                       // in binary
};

/// Reads on from where it was.
class RowReader {
  public:
    /// Both must outlive it; the file stands at the first row.
    RowReader(ByteReader& file, const RayLayout& layout) : file_(file), layout_(layout) {}

    /// The next rows; none: the end. Throws Error naming byte and ray where the file ends early,
    /// has more than its header says, or holds a line that is no row.
    void next(RayRows& rows);
    /// "PATH, byte 40316, ray 17" of row r, for errors.
    std::string where(const RayRows& rows, std::size_t r) const;

  private:
    void next_binary(RayRows& rows);
    void next_text(RayRows& rows);
    void fill();
    /// The next line without its end, and the byte where it starts; false: the end.
    bool next_line(std::string_view& line, std::uint64_t& byte);
    void check_end(std::string_view line, std::uint64_t byte);

    ByteReader& file_;
    const RayLayout& layout_;
    std::uint64_t done_ = 0;  // rays
    bool is_over_ = false;
    std::string text_;  // read, and from at_ on not used yet
    std::size_t at_ = 0;
};

}  // namespace nearfield::rays
