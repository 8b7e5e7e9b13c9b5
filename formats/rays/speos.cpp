// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/speos.h"

#include <array>
#include <cmath>
#include <cstring>

namespace nearfield::rays {
namespace {

constexpr std::size_t kHeaderFloats = 7, kColumns = 8;
constexpr std::size_t kRadiantFlux = 0, kLuminousFlux = 6;
constexpr std::uint64_t kHeaderBytes = kHeaderFloats * sizeof(float),
                        kRowBytes = kColumns * sizeof(float);
using Head = std::array<float, kHeaderFloats + kColumns>;  // header and first ray

Head head_of(ByteReader& file) {
    Head head{};
    const std::string bytes = file.head(sizeof head);
    std::memcpy(head.data(), bytes.data(), bytes.size());
    return head;
}

}  // namespace

bool is_speos(ByteReader& file) {
    if (file.size() < sizeof(Head))
        return false;
    const Head head = head_of(file);
    const float* ray = head.data() + kHeaderFloats;
    constexpr float kUnitLength = 1e-3F;  // six digits, and some
    constexpr float kLeast_nm = 100, kMost_nm = 1e5F;
    return std::isfinite(head[kRadiantFlux]) && head[kRadiantFlux] > 0 &&
           std::abs(std::hypot(ray[3], ray[4], ray[5]) - 1) < kUnitLength && ray[6] >= kLeast_nm &&
           ray[6] <= kMost_nm && ray[7] >= 0;
}

RayLayout read_speos_header(ByteReader& file) {
    const Head head = head_of(file);
    RayLayout layout;
    layout.format = "Speos";
    layout.radiant_flux_w = head[kRadiantFlux];
    layout.luminous_flux_lm = head[kLuminousFlux];
    layout.wavelength = 6;
    layout.radiant = 7;
    layout.columns = kColumns;
    layout.data_byte = kHeaderBytes;
    file.seek(kHeaderBytes);
    layout.ray_count = (file.remaining() + kRowBytes - 1) / kRowBytes;  // a part of one is missing
    check_length(file, layout);
    return layout;
}

}  // namespace nearfield::rays
