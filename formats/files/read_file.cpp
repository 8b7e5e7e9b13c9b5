// SPDX-License-Identifier: Apache-2.0
#include "formats/files/read_file.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <memory>

namespace nearfield {

std::string read_file(const std::string& path, std::size_t most_bytes) {
    constexpr std::size_t kBlock = std::size_t{1} << 16;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               std::fclose);
    if (!file)
        throw Error{"cannot read file", path, "", system_error()};
    std::string bytes;
    std::size_t size = 0, got = 0;
    do {
        bytes.resize(size + kBlock);
        got = std::fread(bytes.data() + size, 1, kBlock, file.get());
        size += got;
        if (size > most_bytes)
            throw Error{"cannot read file", path, fmt::format("at most {} bytes", most_bytes),
                        "more"};
    } while (got == kBlock);
    if (std::ferror(file.get()) != 0)
        throw Error{"cannot read file", path, "", system_error()};
    bytes.resize(size);
    return bytes;
}

}  // namespace nearfield
