// SPDX-License-Identifier: Apache-2.0
#include "tests/rays/ray_file.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>

namespace nearfield::test {
namespace {

template <typename T>
void put(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
}

}  // namespace

std::string to_bytes(const RayFile& file) {
    std::string bytes = file.magic;
    put(bytes, file.version);
    put(bytes, std::int32_t{0});
    put(bytes, file.luminous_flux_lm);
    put(bytes, file.radiant_flux_w);
    put(bytes, file.ray_count);
    bytes.resize(60, '\0');
    put(bytes, file.spectral_data);
    put(bytes, file.wavelength_nm);
    bytes.resize(76, '\0');
    put(bytes, static_cast<std::int32_t>(file.tables.size()));
    bytes.resize(256, '\0');
    for (const std::int32_t flag : file.flags)
        put(bytes, flag);
    bytes.resize(36288, '\0');
    for (const auto& table : file.tables) {
        put(bytes, static_cast<std::int32_t>(table.size()));
        for (const auto& [wavelength, weight] : table) {
            put(bytes, wavelength);
            put(bytes, weight);
        }
    }
    bytes.resize(36288 + (bytes.size() - 36288 + 31) / 32 * 32, '\0');
    for (const auto& row : file.rows)
        for (const float value : row)
            put(bytes, value);
    return bytes;
}

RayFile to_file(const std::vector<rays::Ray>& rays) {
    RayFile file;
    file.ray_count = rays.size();
    for (const rays::Ray& ray : rays) {
        const glm::vec3 p = 1e3F * ray.position_m, d = ray.direction;
        file.rows.push_back({p.x, p.y, p.z, d.x, d.y, d.z, ray.flux});
    }
    return file;
}

std::string write_bytes(const std::string& name, const std::string& bytes) {
    std::ofstream(name, std::ios::binary) << bytes;
    return name;
}

double uniform(std::uint64_t seed, std::uint64_t index) {
    std::uint64_t z = seed * 0xD1342543DE82EF95ULL + 0x9E3779B97F4A7C15ULL * (index + 1);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
}

std::vector<rays::Ray> lambertian_disk(std::size_t count,
                                       double radius_m,
                                       double z_m,
                                       double flux_lm,
                                       std::uint64_t seed,
                                       double run_m) {
    std::vector<rays::Ray> rays;
    for (std::size_t r = 0; r < count; ++r) {
        const auto xi = [&](std::uint64_t k) { return uniform(seed, 5 * r + k); };
        const double radius = radius_m * std::sqrt(xi(0)), angle = 2 * std::numbers::pi * xi(1);
        const double sine = std::sqrt(xi(2)), azimuth = 2 * std::numbers::pi * xi(3);
        const glm::dvec3 direction{sine * std::cos(azimuth), sine * std::sin(azimuth),
                                   std::sqrt(1.0 - sine * sine)};
        const glm::dvec3 start{radius * std::cos(angle), radius * std::sin(angle), z_m};
        rays.push_back({glm::vec3(start + run_m * xi(4) * direction), glm::vec3(direction),
                        static_cast<float>(flux_lm / static_cast<double>(count))});
    }
    return rays;
}

}  // namespace nearfield::test
