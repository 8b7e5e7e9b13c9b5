// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace nearfield {

/// What does not fit into memory, on disk: a file without a name, gone with the program however it
/// ends.
///
/// Throws Error naming the folder, with the system's reason (disk full...).
class UnnamedFile {
  public:
    explicit UnnamedFile(const std::string& folder);
    ~UnnamedFile();
    UnnamedFile(const UnnamedFile&) = delete;
    UnnamedFile& operator=(const UnnamedFile&) = delete;

    /// All of it, at an offset in bytes.
    void write_at(const void* bytes, std::size_t size, std::uint64_t offset);
    void read_at(void* bytes, std::size_t size, std::uint64_t offset) const;

  private:
    std::string folder_;
    int descriptor_ = -1;
};

}  // namespace nearfield
