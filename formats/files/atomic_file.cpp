// SPDX-License-Identifier: Apache-2.0
#include "formats/files/atomic_file.h"

#include "formats/files/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace nearfield {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& path) {
    throw Error{what, path, "", std::strerror(errno)};
}

// Renaming onto a device or pipe would replace it.
void refuse_special_file(const std::string& path) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw Error{"cannot write file", path, "a regular file or a new name", "something else"};
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
    refuse_special_file(path_);
    // Two threads or processes that write the same name must not share a temporary one.
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
        temporary_path_ =
            path_ + ".tmp-" + std::to_string(getpid()) + "-" + std::to_string(attempt);
        descriptor_ = open(temporary_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor_ < 0 && errno != EEXIST)
            fail("cannot create file", path_);
    }
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0)
        close(descriptor_);
    if (!temporary_path_.empty())
        unlink(temporary_path_.c_str());
}

void AtomicFile::write_at(const void* bytes, std::size_t size, std::uint64_t offset) {
    const char* next = static_cast<const char*>(bytes);
    while (size > 0) {
        const ssize_t written = pwrite(descriptor_, next, size, static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            fail("cannot write file", path_);
        next += written;
        size -= static_cast<std::size_t>(written);
        offset += static_cast<std::uint64_t>(written);
    }
}

void AtomicFile::commit() {
    if (close(std::exchange(descriptor_, -1)) != 0)
        fail("cannot write file", path_);
    if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0)
        fail("cannot rename the finished file", path_);
    temporary_path_.clear();
}

void write_file(std::string_view content, const std::string& path) {
    AtomicFile file(path);
    file.write_at(content.data(), content.size(), 0);
    file.commit();
}

}  // namespace nearfield
