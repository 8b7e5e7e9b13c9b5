// SPDX-License-Identifier: Apache-2.0
#include "formats/files/atomic_file.h"

#include "formats/files/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <utility>

namespace nearfield {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& path) {
    throw Error{what, path, "", system_error()};
}

// Renaming onto a device or pipe would replace it.
void refuse_bad_name(const std::string& path) {
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path, failure);
    if (status.type() == std::filesystem::file_type::none)  // such as a name that is too long
        throw Error{"cannot create file", path, "", failure.message()};
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw Error{"cannot write file", path, "a regular file or a new name",
                    std::filesystem::is_directory(status) ? "a folder" : "a device or pipe"};
    if (std::filesystem::path(path).filename().empty())
        throw Error{"cannot create file", path, "a file's name", "'" + path + "'"};
}

std::string folder_of(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

// Where linkat() finds a file that is open and has no name.
std::string link_to(int descriptor) {
    return "/proc/self/fd/" + std::to_string(descriptor);
}

// An unnamed file in the folder, or -1 where it cannot be had or could not be named later.
int open_unnamed(const std::string& folder) {
    const int descriptor = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0 && access(link_to(descriptor).c_str(), F_OK) != 0) {
        close(descriptor);
        return -1;
    }
    return descriptor;
}

// Calls make(name) with hidden names beside `path` until one is new, and returns that. Two threads
// or processes that write the same file must not share a temporary one.
template <typename Make>
std::string make_temporary(const std::string& path, const Make& make) {
    for (int attempt = 0;; ++attempt) {
        std::string name = folder_of(path) + "/.nearfield-" + std::to_string(getpid()) + "-" +
                           std::to_string(attempt);
        if (make(name.c_str()))
            return name;
        if (errno != EEXIST)
            fail("cannot create file", path);
    }
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
    refuse_bad_name(path_);
    descriptor_ = open_unnamed(folder_of(path_));
    if (descriptor_ >= 0)
        return;
    temporary_path_ = make_temporary(path_, [this](const char* name) {
        descriptor_ = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        return descriptor_ >= 0;
    });
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
    if (temporary_path_.empty()) {
        const auto link_as = [source = link_to(descriptor_)](const char* name) {
            return linkat(AT_FDCWD, source.c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
        };
        if (!link_as(path_.c_str())) {
            if (errno != EEXIST)
                fail("cannot name the finished file", path_);
            temporary_path_ = make_temporary(path_, link_as);
        }
    }
    if (close(std::exchange(descriptor_, -1)) != 0)
        fail("cannot write file", path_);
    if (!temporary_path_.empty() && std::rename(temporary_path_.c_str(), path_.c_str()) != 0)
        fail("cannot rename the finished file", path_);
    temporary_path_.clear();
}

void write_file(std::string_view content, const std::string& path) {
    AtomicFile file(path);
    file.write_at(content.data(), content.size(), 0);
    file.commit();
}

}  // namespace nearfield
