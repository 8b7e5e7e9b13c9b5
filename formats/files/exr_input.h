// SPDX-License-Identifier: Apache-2.0
/// How OpenEXR gets at a file's bytes and at memory: what exr_read.cpp gives a context.
#pragma once

#include "formats/files/error.h"
#include "formats/files/exr_context.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <limits>

namespace nearfield::exr {

/// What OpenEXR may allocate in one piece while it parses a header; its attributes lie in the file.
inline thread_local std::size_t allocation_limit = std::numeric_limits<std::size_t>::max();

struct LimitAllocations {
    explicit LimitAllocations(std::size_t bytes) { allocation_limit = bytes; }
    ~LimitAllocations() { allocation_limit = std::numeric_limits<std::size_t>::max(); }
    LimitAllocations(const LimitAllocations&) = delete;
    LimitAllocations& operator=(const LimitAllocations&) = delete;
};

inline void* allocate(std::size_t bytes) {
    return bytes > allocation_limit ? nullptr : std::malloc(bytes);
}

/// The file that OpenEXR reads through the functions below.
struct Input {
    std::string path;
    int descriptor = -1;
    std::uint64_t size = 0;
    Messages messages;

    explicit Input(const std::string& file_path) : path(file_path) {
        descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
        if (descriptor < 0)
            throw Error{"cannot read file", path, "", system_error()};
        struct stat status {};
        if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
            close(descriptor);
            throw Error{"cannot read file", path, "a regular file", "something else"};
        }
        size = static_cast<std::uint64_t>(status.st_size);
    }
    ~Input() { close(descriptor); }
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;
};

inline int64_t read_bytes(exr_const_context_t,
                          void* user,
                          void* buffer,
                          uint64_t size,
                          uint64_t offset,
                          exr_stream_error_func_ptr_t) {
    const auto* input = static_cast<const Input*>(user);
    uint64_t done = 0;
    while (done < size) {
        const ssize_t got = pread(input->descriptor, static_cast<char*>(buffer) + done, size - done,
                                  static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        done += static_cast<uint64_t>(got);
    }
    return static_cast<int64_t>(done);
}

inline int64_t query_size(exr_const_context_t, void* user) {
    return static_cast<int64_t>(static_cast<const Input*>(user)->size);
}

inline void keep_message(exr_const_context_t context, exr_result_t, const char* message) {
    void* user = nullptr;
    if (context != nullptr && exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user)
        static_cast<Input*>(user)->messages.keep(message);
}

}  // namespace nearfield::exr
