// SPDX-License-Identifier: Apache-2.0
#include "tests/environment/skies.h"

#include <cmath>

namespace nearfield::test {

environment::LatLong sky(int height_px, const std::function<glm::vec3(glm::dvec3)>& radiance) {
    const double pi = std::acos(-1.0);
    environment::LatLong picture{{2 * height_px, height_px}, {}};
    for (int y = 0; y < height_px; ++y)
        for (int x = 0; x < 2 * height_px; ++x) {
            const double polar = pi * (y + 0.5) / height_px;
            const double azimuth = pi * ((x + 0.5) / height_px - 1.0);
            picture.radiance.push_back(
                radiance({std::sin(polar) * std::sin(azimuth), std::cos(polar),
                          -std::sin(polar) * std::cos(azimuth)}));
        }
    return picture;
}

environment::LatLong sunny_sky(int height_px) {
    const glm::dvec3 glow = glm::normalize(glm::dvec3(-1.0, 0.3, 0.5));
    environment::LatLong picture = sky(height_px, [&](glm::dvec3 d) {
        const auto around = static_cast<float>(std::exp(8.0 * (glm::dot(d, glow) - 1.0)));
        const glm::vec3 base = d.y > 0.0
                                   ? glm::vec3(0.3F, 0.5F, 1.0F) * static_cast<float>(1.2 - d.y)
                                   : glm::vec3(0.2F, 0.15F, 0.1F);
        return base + around * glm::vec3(3.0F, 2.0F, 1.0F);
    });
    picture.radiance[picture.index({height_px / 3, height_px / 4})] = glm::vec3(2e4F);
    return picture;
}

environment::LatLong lone_sun(int height_px, glm::ivec2 pixel, float radiance) {
    environment::LatLong picture = sky(height_px, [](glm::dvec3) { return glm::vec3(0.0F); });
    picture.radiance[picture.index(pixel)] = glm::vec3(radiance);
    return picture;
}

double over_sphere(int n, const std::function<double(glm::dvec3)>& value) {
    const double pi = std::acos(-1.0);
    double sum = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < 2 * n; ++j) {
            const double z = (2.0 * i + 1.0) / n - 1.0, azimuth = pi * (j + 0.5) / n;
            const double across = std::sqrt(1.0 - z * z);
            sum += value({across * std::cos(azimuth), across * std::sin(azimuth), z});
        }
    return sum * 2.0 * pi / (static_cast<double>(n) * n);
}

}  // namespace nearfield::test
