// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace nearfield {

/// A file that appears under its name whole or not at all. Every writer goes through it.
///
/// Until commit() the file has no name (Linux' O_TMPFILE), so that nothing is left of it however
/// the program ends, kill -9 included. Where a file of that name exists, commit() links the new one
/// under a hidden name beside it and renames it over the old one at once. File systems that know no
/// unnamed files (NFS, FAT) get the hidden name from the start, which only the destructor removes.
///
/// Throws Error with path and the system's reason (no such folder, disk full...).
class AtomicFile {
  public:
    explicit AtomicFile(std::string path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Writes all of it at an offset.
    void write_at(const void* bytes, std::size_t size, std::uint64_t offset);

    /// Gives the file its name. Errors that the system kept back (quota, network) show here.
    void commit();

  private:
    std::string path_, temporary_path_;  // temporary_path_ is empty while the file has no name
    int descriptor_ = -1;
};

/// Writes a text or a buffer as one file, whole or not at all.
void write_file(std::string_view content, const std::string& path);

}  // namespace nearfield
