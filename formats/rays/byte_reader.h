// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/error.h"
#include "formats/rays/ray_layout.h"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace nearfield::rays {

/// A ray file, read in order of rising offsets, with its size known before anything is allocated.
class ByteReader {
  public:
    /// Throws Error where it is no file that can be read.
    explicit ByteReader(const std::string& path);

    /// "PATH, byte 17", for errors.
    std::string at(std::uint64_t byte) const;
    const std::string& path() const { return path_; }
    std::uint64_t position() const { return position_; }
    std::uint64_t remaining() const { return size_ - position_; }
    std::uint64_t size() const { return size_; }

    /// Whether these bytes stand at the file's start (at its end). The position stays.
    bool starts_with(std::string_view bytes);
    bool ends_with(std::string_view bytes);
    /// At most so many bytes from the file's start. The position stays.
    std::string head(std::uint64_t bytes);

    /// Forward. Throws Error where the file ends before.
    void seek(std::uint64_t byte);
    void read(void* destination, std::uint64_t bytes);
    template <typename T>
    T read() {
        T value{};
        read(&value, sizeof value);
        return value;
    }
    /// The file must hold `bytes` more.
    void need(std::uint64_t bytes) const;

  private:
    std::string bytes_at(std::uint64_t byte, std::uint64_t count);

    std::string path_;
    std::ifstream stream_;
    std::uint64_t size_ = 0, position_ = 0;
};

/// Compares the rays that a header promises with the file's size, before anything is allocated for
/// them; the reader stands at the first row.
void check_length(const ByteReader& file, const RayLayout& layout);

}  // namespace nearfield::rays
