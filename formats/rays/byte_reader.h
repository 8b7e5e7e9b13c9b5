// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/error.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace nearfield::rays {

/// A ray file, read in order of rising offsets, with its size known before anything is allocated.
class ByteReader {
  public:
    explicit ByteReader(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
        std::error_code error;
        size_ = std::filesystem::is_regular_file(path, error)
                    ? static_cast<std::uint64_t>(std::filesystem::file_size(path, error))
                    : 0;
        if (!stream_ || error)
            throw Error{"cannot open ray file", path, "a readable file"};
    }

    std::string at(std::uint64_t byte) const { return fmt::format("{}, byte {}", path_, byte); }
    std::uint64_t position() const { return position_; }
    std::uint64_t remaining() const { return size_ - position_; }
    std::uint64_t size() const { return size_; }

    void seek(std::uint64_t byte) {
        need(byte > position_ ? byte - position_ : 0);
        stream_.seekg(static_cast<std::streamoff>(byte));
        position_ = byte;
    }

    void read(void* destination, std::uint64_t bytes) {
        need(bytes);
        stream_.read(static_cast<char*>(destination), static_cast<std::streamsize>(bytes));
        if (!stream_)
            throw Error{"cannot read ray file", at(position_)};
        position_ += bytes;
    }

    template <typename T>
    T read() {
        T value{};
        read(&value, sizeof value);
        return value;
    }

    /// The file must hold `bytes` more.
    void need(std::uint64_t bytes) const {
        if (bytes > remaining())
            throw Error{"ray file is truncated", at(size_),
                        fmt::format("{} more bytes after byte {}", bytes, position_),
                        fmt::format("{}", remaining())};
    }

  private:
    std::string path_;
    std::ifstream stream_;
    std::uint64_t size_ = 0, position_ = 0;
};

}  // namespace nearfield::rays
