// SPDX-License-Identifier: Apache-2.0
#include "calibrate/filter_samples.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr float kSeenSigmas = 5.0F;
// The guess is the centroid of what is brighter than this share of the brightest: the profile's
// middle, whatever noise and stray light lie about it.
constexpr float kMiddleShare = 0.4F;
constexpr double kPixelVariance_px2 = 1.0 / 12.0;

glm::dvec2 pixel_center(std::size_t k, glm::ivec2 size_px) {
    const auto width = static_cast<std::size_t>(size_px.x);
    const std::size_t column = k % width, row = k / width;
    return {static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
}

std::string view_name(const FilterPicture& picture) {
    return fmt::format("filter view at position {} {}", picture.position.x, picture.position.y);
}

// Centroid on U of the bright middle.
glm::dvec2 guess_center_m(const FilterPicture& picture, const FilterGeometry& geometry) {
    float most = 0.0F;
    for (std::size_t k = 0; k < picture.transmission.size(); ++k) {
        if (picture.sigma[k] > 0.0F && picture.transmission[k] > kSeenSigmas * picture.sigma[k])
            most = std::max(most, picture.transmission[k]);
    }
    glm::dvec2 sum(0.0);
    double weights = 0;
    for (std::size_t k = 0; k < picture.transmission.size(); ++k) {
        if (!(picture.sigma[k] > 0.0F) || most == 0.0F ||
            picture.transmission[k] < kMiddleShare * most ||
            picture.transmission[k] < kSeenSigmas * picture.sigma[k])
            continue;
        const auto u_m = on_filter_plane(geometry, pixel_center(k, geometry.lens.size_px));
        if (!u_m)
            continue;
        sum += double(picture.transmission[k]) * *u_m;
        weights += picture.transmission[k];
    }
    if (!(weights > 0.0))
        throw Error{"no filter to be seen", view_name(picture), "light above noise", "none"};
    return sum / weights;
}

// Sigma of a pixel's footprint along U's axes: its square and the lens' core.
glm::dvec2 spread_m(const FilterGeometry& geometry, glm::dvec2 at_px, glm::dvec2 u_m) {
    const auto right = on_filter_plane(geometry, at_px + glm::dvec2(0.5, 0.0));
    const auto below = on_filter_plane(geometry, at_px + glm::dvec2(0.0, 0.5));
    if (!right || !below)
        return glm::dvec2(0.0);
    const glm::dvec2 a = 2.0 * (*right - u_m), b = 2.0 * (*below - u_m);
    const double sigma_px =
        std::sqrt(geometry.psf_sigma_px * geometry.psf_sigma_px + kPixelVariance_px2);
    return sigma_px * glm::sqrt(a * a + b * b);
}

}  // namespace

std::optional<glm::dvec2> on_filter_plane(const FilterGeometry& geometry, glm::dvec2 at_px) {
    const std::optional<glm::dvec3> ray = rig::ray_camera(geometry.lens, at_px);
    if (!ray)
        return std::nullopt;
    const glm::dmat3 u_from_camera = glm::transpose(geometry.camera_from_u.rotation);
    const glm::dvec3 direction = u_from_camera * *ray;
    const glm::dvec3 origin = -(u_from_camera * geometry.camera_from_u.translation_m);
    if (direction.z == 0.0)
        return std::nullopt;
    const double t = -origin.z / direction.z;
    if (!(t > 0.0))
        return std::nullopt;
    return glm::dvec2(origin + t * direction);
}

FilterSamples filter_samples_of(std::span<const FilterPicture> pictures,
                                const FilterGeometry& geometry,
                                double reach_pitches,
                                const std::vector<int>& color_of) {
    FilterSamples found;
    const glm::ivec2 size_px = geometry.lens.size_px;
    const double cosine = std::cos(geometry.turn_guess_rad);
    const double sine = std::sin(geometry.turn_guess_rad);
    for (std::size_t view = 0; view < pictures.size(); ++view) {
        const FilterPicture& picture = pictures[view];
        const glm::dvec2 guess_m = guess_center_m(picture, geometry);
        found.guess_u_m.push_back(guess_m);
        for (std::size_t k = 0; k < picture.transmission.size(); ++k) {
            const glm::dvec2 at_px = pixel_center(k, size_px);
            const auto u_m = on_filter_plane(geometry, at_px);
            if (!u_m)
                continue;
            const glm::dvec2 from_guess = *u_m - guess_m;
            const glm::dvec2 x(cosine * from_guess.x + sine * from_guess.y,
                               cosine * from_guess.y - sine * from_guess.x);
            const glm::dvec2 pitches = glm::abs(x / geometry.pitch_m);
            if (std::max(pitches.x, pitches.y) > reach_pitches)
                continue;
            const bool is_at_border = at_px.x < 1.0 || at_px.y < 1.0 || at_px.x > size_px.x - 1.0 ||
                                      at_px.y > size_px.y - 1.0;
            if (is_at_border && picture.transmission[k] > kSeenSigmas * picture.sigma[k] &&
                std::max(pitches.x, pitches.y) < reach_pitches - 0.5)
                throw Error{"the filter is cut off", view_name(picture),
                            "all of the filter in the picture",
                            fmt::format("light at pixel {:.0f} {:.0f}", at_px.x, at_px.y)};
            if (picture.sigma[k] > 0.0F)
                found.samples.push_back({*u_m, spread_m(geometry, at_px, *u_m),
                                         picture.transmission[k], picture.sigma[k], color_of[k],
                                         static_cast<int>(view)});
        }
    }
    return found;
}

}  // namespace nearfield::calibrate
