// SPDX-License-Identifier: Apache-2.0
#include "fit/texel_spool.h"

#include "formats/files/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <limits>
#include <system_error>
#include <utility>

namespace nearfield::fit {
namespace {

[[noreturn]] void fail_spool(const std::string& what, const std::string& folder) {
    throw Error{what, folder, "", std::system_category().message(errno)};
}

int open_unnamed(const std::string& folder) {
    int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (descriptor >= 0)
        return descriptor;
    // File systems without unnamed files (NFS, FAT): a name that goes at once.
    std::string path = folder + "/nearfield-fit-XXXXXX";
    descriptor = mkstemp(path.data());
    if (descriptor < 0)
        fail_spool("cannot write temporary file", folder);
    unlink(path.c_str());
    return descriptor;
}

}  // namespace

TexelSpool::TexelSpool(const std::string& folder, glm::ivec2 texels, int channels, int positions)
    : folder_(folder.empty() ? "." : folder),
      texels_(texels),
      channels_(channels),
      positions_(positions),
      is_put_(static_cast<std::size_t>(channels) * static_cast<std::size_t>(positions), false),
      descriptor_(open_unnamed(folder_)) {}

TexelSpool::TexelSpool(TexelSpool&& other) noexcept
    : folder_(std::move(other.folder_)),
      texels_(other.texels_),
      channels_(other.channels_),
      positions_(other.positions_),
      is_put_(std::move(other.is_put_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

TexelSpool::~TexelSpool() {
    if (descriptor_ >= 0)
        close(descriptor_);
}

std::size_t TexelSpool::texel_count() const {
    return static_cast<std::size_t>(texels_.x) * static_cast<std::size_t>(texels_.y);
}

std::uint64_t TexelSpool::offset(int position, int channel, bool is_variance, int row) const {
    const auto image =
        2 * (static_cast<std::uint64_t>(channel) * static_cast<std::uint64_t>(positions_) +
             static_cast<std::uint64_t>(position)) +
        (is_variance ? 1 : 0);
    return sizeof(float) * (image * texel_count() + static_cast<std::uint64_t>(row) *
                                                        static_cast<std::uint64_t>(texels_.x));
}

void TexelSpool::put(int position, int channel, const RectifiedImage& image) {
    for (const bool is_variance : {false, true}) {
        const std::vector<float>& values = is_variance ? image.variance : image.value;
        const char* bytes = reinterpret_cast<const char*>(values.data());
        std::size_t left = values.size() * sizeof(float);
        auto at = static_cast<off_t>(offset(position, channel, is_variance, 0));
        while (left > 0) {
            const ssize_t written = pwrite(descriptor_, bytes, left, at);
            if (written < 0 && errno != EINTR)
                fail_spool("cannot write temporary file", folder_);
            if (written <= 0)
                continue;
            bytes += written;
            at += written;
            left -= static_cast<std::size_t>(written);
        }
    }
    is_put_[static_cast<std::size_t>(channel) * static_cast<std::size_t>(positions_) +
            static_cast<std::size_t>(position)] = true;
}

TileInput TexelSpool::read(TileRange rows) const {
    const std::size_t count =
        static_cast<std::size_t>(rows.row_count) * static_cast<std::size_t>(texels_.x);
    TileInput tile;
    tile.value.assign(is_put_.size() * count, 0.0F);
    tile.variance.assign(is_put_.size() * count, std::numeric_limits<float>::infinity());
    for (std::size_t image = 0; image < is_put_.size(); ++image) {
        if (!is_put_[image])
            continue;
        const int channel = static_cast<int>(image) / positions_;
        const int position = static_cast<int>(image) % positions_;
        for (const bool is_variance : {false, true}) {
            float* values = (is_variance ? tile.variance : tile.value).data() + image * count;
            const auto wanted = static_cast<ssize_t>(count * sizeof(float));
            const auto at =
                static_cast<off_t>(offset(position, channel, is_variance, rows.first_row));
            if (pread(descriptor_, values, count * sizeof(float), at) != wanted)
                fail_spool("cannot read temporary file", folder_);
        }
    }
    return tile;
}

}  // namespace nearfield::fit
