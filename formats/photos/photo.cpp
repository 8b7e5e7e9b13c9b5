// SPDX-License-Identifier: Apache-2.0
#include "formats/photos/photo.h"

#include "formats/files/error.h"
#include "formats/photos/module.h"

#include <dlfcn.h>

#include <filesystem>

namespace nearfield::photos {
namespace {

// The module lies beside the program where it is built, and in the libraries' folder where it is
// installed.
void* open_module() {
    std::error_code failed;
    const std::filesystem::path folder =
        std::filesystem::read_symlink("/proc/self/exe", failed).parent_path();
    std::string reason;
    for (const std::filesystem::path& place : {folder, folder / NEARFIELD_MODULES_FROM_PROGRAM}) {
        const std::string path = (place / "nearfield_photos.so").string();
        if (void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL))
            return module;
        // NOLINTNEXTLINE(concurrency-mt-unsafe): glibc keeps it for each thread.
        reason = dlerror();
    }
    throw Error{"cannot read photographs", "nearfield_photos.so", "the module beside the program",
                reason};
}

/// A function of the module, found once.
template <typename Function>
Function* function_of_module(const char* name) {
    static void* const module = open_module();
    auto* function = reinterpret_cast<Function*>(dlsym(module, name));
    if (function == nullptr)
        throw Error{"cannot read photographs", "nearfield_photos.so", "this program's own module",
                    "another"};
    return function;
}

}  // namespace

Photo read_photo(const std::string& path) {
    static const auto read =
        function_of_module<decltype(nearfield_read_photo)>("nearfield_read_photo");
    Photo photo;
    std::string complaint;
    if (!read(path, photo, complaint))
        throw Error{"cannot read photograph", path, "PNG, JPEG, TIFF or raw", complaint};
    return photo;
}

RadiancePicture read_radiance(const std::string& path) {
    static const auto read =
        function_of_module<decltype(nearfield_read_radiance)>("nearfield_read_radiance");
    RadiancePicture picture;
    std::string complaint;
    if (!read(path, picture, complaint))
        throw Error{"cannot read picture of light", path, "Radiance (.hdr)", complaint};
    return picture;
}

}  // namespace nearfield::photos
