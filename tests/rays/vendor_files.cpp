// SPDX-License-Identifier: Apache-2.0
#include "tests/rays/vendor_files.h"

#include <cstring>

namespace nearfield::test {
namespace {

template <typename T>
void put(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
}

void put_rows(std::string& bytes, const Rows& rows) {
    for (const auto& row : rows)
        for (const float value : row)
            put(bytes, value);
}

}  // namespace

std::string to_bytes(const ZemaxFile& file) {
    std::string bytes;
    put(bytes, file.identifier);
    put(bytes, file.ray_count == 0 ? static_cast<std::uint32_t>(file.rows.size()) : file.ray_count);
    bytes.resize(108, ' ');
    put(bytes, file.source_flux);
    put(bytes, file.source_flux);
    put(bytes, file.wavelength_um);
    bytes.resize(136, '\0');
    put(bytes, file.unit);
    bytes.resize(192, '\0');
    put(bytes, file.ray_format);
    put(bytes, file.flux_type);
    bytes.resize(208, '\0');
    put_rows(bytes, file.rows);
    return bytes;
}

std::string to_bytes(const LightToolsFile& file) {
    std::string bytes = "LTRF";
    for (const std::uint32_t value :
         {file.version, 0U, file.is_luminous, file.far_field, file.color, file.unit})
        put(bytes, value);
    for (const float value : file.origin)
        put(bytes, value);
    put(bytes, file.flux);
    if (file.version == 3)
        put(bytes, 0U);
    put_rows(bytes, file.rows);
    return bytes + file.end;
}

std::string to_bytes(const SpeosFile& file) {
    std::string bytes;
    put(bytes, file.radiant_flux_w);
    for (int k = 0; k < 5; ++k)
        put(bytes, 2.0F);
    put(bytes, file.luminous_flux_lm);
    put_rows(bytes, file.rows);
    return bytes;
}

Rows three_rows() {
    return {{1, 2, 3, 0, 0, 1, 1}, {-1, 0, 0.5F, 0.6F, 0, 0.8F, 2}, {0, 0, 0, 0, -1, 0, 3}};
}

}  // namespace nearfield::test
