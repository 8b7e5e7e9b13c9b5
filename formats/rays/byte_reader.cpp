// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/byte_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace nearfield::rays {

ByteReader::ByteReader(const std::string& path) : path_(path), stream_(path, std::ios::binary) {
    std::error_code error;
    size_ = std::filesystem::is_regular_file(path, error)
                ? static_cast<std::uint64_t>(std::filesystem::file_size(path, error))
                : 0;
    if (!stream_ || error)
        throw Error{"cannot open ray file", path, "a readable file"};
}

std::string ByteReader::at(std::uint64_t byte) const {
    return fmt::format("{}, byte {}", path_, byte);
}

std::string ByteReader::bytes_at(std::uint64_t byte, std::uint64_t count) {
    std::string bytes(std::min(count, size_ - std::min(byte, size_)), '\0');
    stream_.seekg(static_cast<std::streamoff>(byte));
    stream_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream_)
        throw Error{"cannot read ray file", at(byte)};
    stream_.seekg(static_cast<std::streamoff>(position_));
    return bytes;
}

std::string ByteReader::head(std::uint64_t bytes) {
    return bytes_at(0, bytes);
}

bool ByteReader::starts_with(std::string_view bytes) {
    return head(bytes.size()) == bytes;
}

bool ByteReader::ends_with(std::string_view bytes) {
    return size_ >= bytes.size() && bytes_at(size_ - bytes.size(), bytes.size()) == bytes;
}

void ByteReader::seek(std::uint64_t byte) {
    need(byte > position_ ? byte - position_ : 0);
    stream_.seekg(static_cast<std::streamoff>(byte));
    position_ = byte;
}

void ByteReader::read(void* destination, std::uint64_t bytes) {
    need(bytes);
    stream_.read(static_cast<char*>(destination), static_cast<std::streamsize>(bytes));
    if (!stream_)
        throw Error{"cannot read ray file", at(position_)};
    position_ += bytes;
}

void ByteReader::need(std::uint64_t bytes) const {
    if (bytes > remaining())
        throw Error{"ray file is truncated", at(size_),
                    fmt::format("{} more bytes after byte {}", bytes, position_),
                    fmt::format("{}", remaining())};
}

void check_length(const ByteReader& file, const RayLayout& layout) {
    const std::uint64_t row_bytes = layout.columns * sizeof(float);
    const std::uint64_t whole_rays = file.remaining() / row_bytes;
    if (layout.ray_count == 0)
        throw Error{"ray file without rays", file.at(file.position()), ">= 1 ray", "0"};
    if (whole_rays < layout.ray_count)
        throw Error{"ray file is truncated",
                    fmt::format("{}, ray {}", file.at(file.size()), whole_rays),
                    fmt::format("{} rays of {} bytes", layout.ray_count, row_bytes),
                    fmt::format("{} whole rays", whole_rays)};
    const std::uint64_t rest = file.remaining() - layout.ray_count * row_bytes;
    if (rest > 0)
        throw Error{"ray file is longer than its header says", file.at(file.size() - rest),
                    "the end of the file", fmt::format("{} more bytes", rest)};
}

}  // namespace nearfield::rays
