// SPDX-License-Identifier: Apache-2.0
/// From radiance along rays to electrons per second in pixels.
///
///     pixel = integral over its square of ((1 - v) G(psf_sigma) + v G(veil_sigma)) * (vignetting *
///     L)
///
/// Radiance is sampled at the centers of k x k parts of each pixel, in a margin around the picture
/// too; the core gaussian is integrated over the pixel's square exactly for a sample as a point,
/// and cut at 5 sigma. The veil is computed from means of 8 x 8 pixels, interpolated linearly: some
/// per cent of the veil itself. Light from beyond the margin adds no veil.
#pragma once

#include "sample_data/bench/places.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace nearfield::sample_data {

/// The samples of a picture and its margin.
struct SampleGrid {
    int per_pixel = 2;  // k
    int margin_px = 0;
    glm::ivec2 count{0};  // samples along x and y

    glm::dvec2 position_px(int column, int row) const {
        return (glm::dvec2(column, row) + 0.5) / double(per_pixel) - double(margin_px);
    }
};

SampleGrid make_sample_grid(const BenchCamera& camera, int per_pixel);

/// Rays (x / z, y / z of `camera`) and vignetting of all samples: [row][column]. One row and
/// column more than the grid, so that every sample has neighbors to the right and below.
struct SampleRays {
    std::size_t width = 0;
    std::vector<glm::dvec2> tangent;
    std::vector<float> vignetting;

    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
    }
    glm::dvec3 ray(int column, int row) const { return {tangent[index(column, row)], 1.0}; }
};
SampleRays sample_rays(const BenchCamera& camera, const SampleGrid& grid);

/// Number of pixel colors: 1 or 3; and the color of a pixel.
int color_count(const BenchCamera& camera);
int pixel_color(const BenchCamera& camera, int x, int y);

/// Fills one row of samples: [color][column], electrons per second of a whole pixel, vignetting
/// included.
using SampleRow = std::function<void(int row, std::span<float> values)>;

/// One value a pixel, its own color's. Rows are sampled in parallel if is_parallel.
std::vector<float> form_picture(const BenchCamera& camera,
                                const SampleGrid& grid,
                                const SampleRow& sample_row,
                                bool is_parallel);

/// Irradiance on a regular grid of points on the screen, in `screen`.
struct ScreenGrid {
    glm::dvec2 min_m{0.0}, step_m{1.0};
    glm::ivec2 count{0};

    std::size_t size() const {
        return static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y);
    }
};

/// Covers what the camera sees of the screen, `step_px` pixels apart. Throws Error if it sees
/// nothing of it.
ScreenGrid make_screen_grid(const Bench& bench, const Places& places, const SampleGrid& samples);

/// Where each sample's ray meets the screen: in units of the screen grid, and what turns irradiance
/// into seen light: vignetting * lobe / pi; 0 beside the screen.
struct ScreenSample {
    float x = 0, y = 0, factor = 0;
};
std::vector<ScreenSample> screen_samples(const Bench& bench,
                                         const Places& places,
                                         const SampleGrid& samples,
                                         const SampleRays& rays,
                                         const ScreenGrid& grid);

/// Catmull and Rom's cubic interpolation between the points, the outermost repeated beyond the
/// edges. Linear in the values, hence a little below 0 beside steep edges of dark regions.
float interpolated(std::span<const float> values, glm::ivec2 count, float x, float y);

}  // namespace nearfield::sample_data
