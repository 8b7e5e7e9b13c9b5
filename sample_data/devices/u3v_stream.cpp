// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/u3v_stream.h"

#include "sample_data/devices/little_endian.h"

namespace nearfield::devices {
namespace {

constexpr std::uint64_t kLeaderKey = 0x4C563355, kTrailerKey = 0x54563355;

}  // namespace

std::vector<std::uint8_t> u3v_leader(const gige::Settings& settings,
                                     std::uint64_t block_id,
                                     std::uint64_t time_ns) {
    constexpr std::uint64_t kBytes = 52, kImage = 1;
    std::vector<std::uint8_t> bytes;
    append(bytes, kLeaderKey, 4);
    append(bytes, 0, 2);
    append(bytes, kBytes, 2);
    append(bytes, block_id, 8);
    append(bytes, 0, 2);
    append(bytes, kImage, 2);
    append(bytes, time_ns, 8);
    append(bytes, static_cast<std::uint32_t>(settings.format), 4);
    for (const int number :
         {settings.size_px.x, settings.size_px.y, settings.offset_px.x, settings.offset_px.y})
        append(bytes, static_cast<std::uint32_t>(number), 4);
    append(bytes, 0, 4);  // padding
    return bytes;
}

std::vector<std::uint8_t> u3v_trailer(const gige::Settings& settings,
                                      std::uint64_t block_id,
                                      std::uint64_t payload_bytes) {
    constexpr std::uint64_t kBytes = 32;
    std::vector<std::uint8_t> bytes;
    append(bytes, kTrailerKey, 4);
    append(bytes, 0, 2);
    append(bytes, kBytes, 2);
    append(bytes, block_id, 8);
    append(bytes, 0, 4);
    append(bytes, payload_bytes, 8);
    append(bytes, static_cast<std::uint32_t>(settings.size_px.y), 4);
    return bytes;
}

}  // namespace nearfield::devices
