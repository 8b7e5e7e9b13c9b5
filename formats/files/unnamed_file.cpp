// SPDX-License-Identifier: Apache-2.0
#include "formats/files/unnamed_file.h"

#include "formats/files/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

namespace nearfield {
namespace {

[[noreturn]] void fail_nameless(const char* what, const std::string& folder) {
    throw Error{what, folder, "", std::system_category().message(errno)};
}

int open_nameless(const std::string& folder) {
    int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (descriptor >= 0)
        return descriptor;
    // File systems without unnamed files (NFS, FAT): a name that goes at once.
    std::string path = folder + "/nearfield-XXXXXX";
    descriptor = mkstemp(path.data());
    if (descriptor < 0)
        fail_nameless("cannot write temporary file", folder);
    unlink(path.c_str());
    return descriptor;
}

}  // namespace

UnnamedFile::UnnamedFile(const std::string& folder)
    : folder_(folder.empty() ? "." : folder), descriptor_(open_nameless(folder_)) {}

UnnamedFile::~UnnamedFile() {
    close(descriptor_);
}

void UnnamedFile::write_at(const void* bytes, std::size_t size, std::uint64_t offset) {
    const char* from = static_cast<const char*>(bytes);
    while (size > 0) {
        const ssize_t written = pwrite(descriptor_, from, size, static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            fail_nameless("cannot write temporary file", folder_);
        from += written;
        offset += static_cast<std::uint64_t>(written);
        size -= static_cast<std::size_t>(written);
    }
}

void UnnamedFile::read_at(void* bytes, std::size_t size, std::uint64_t offset) const {
    char* to = static_cast<char*>(bytes);
    while (size > 0) {
        const ssize_t got = pread(descriptor_, to, size, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            fail_nameless("cannot read temporary file", folder_);
        to += got;
        offset += static_cast<std::uint64_t>(got);
        size -= static_cast<std::size_t>(got);
    }
}

}  // namespace nearfield
