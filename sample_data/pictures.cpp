// SPDX-License-Identifier: Apache-2.0
#include "sample_data/pictures.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::sample_data {
namespace {

constexpr int kGap_px = 2;

unsigned char srgb_byte(double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
    return static_cast<unsigned char>(std::lround(255.0 * encoded));
}

PixelImage blank(glm::ivec2 size_px) {
    return {size_px,
            std::vector<unsigned char>(
                3 * static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y), 60)};
}

void put(PixelImage& image, glm::ivec2 at, glm::dvec3 linear) {
    const std::size_t offset =
        3 * (static_cast<std::size_t>(at.y) * static_cast<std::size_t>(image.size_px.x) +
             static_cast<std::size_t>(at.x));
    for (int c = 0; c < 3; ++c) {
        image.rgb[offset + static_cast<std::size_t>(c)] = srgb_byte(linear[c]);
    }
}

// Mean color of a block of texels of an image C_m.
glm::dvec3 block_mean(const Slab& slab, int m, glm::ivec2 first, glm::ivec2 size) {
    glm::dvec3 sum(0.0);
    for (int c = 0; c < 3; ++c) {
        const float* const image = &slab.coeffs[slab.image_offset(slab.channels == 1 ? 0 : c, m)];
        for (int j = first.y; j < first.y + size.y; ++j) {
            for (int i = first.x; i < first.x + size.x; ++i) {
                sum[c] += static_cast<double>(image[j * slab.texels.x + i]);
            }
        }
    }
    return sum / static_cast<double>(size.x * size.y);
}

}  // namespace

PixelImage atlas_picture(const LightField& lightfield, int max_texels_px) {
    const Slab& slab = lightfield.slabs.front();
    const int step = (slab.texels.x + max_texels_px - 1) / max_texels_px;
    const int step_y = std::min(step, slab.texels.y);
    const glm::ivec2 thumb = slab.texels / glm::ivec2(step, step_y);
    PixelImage picture = blank(slab.grid * (thumb + kGap_px) - kGap_px);
    const double brightest =
        static_cast<double>(*std::max_element(slab.coeffs.begin(), slab.coeffs.end()));
    for (int m = 0; m < slab.image_count(); ++m) {
        // Rows of images and of texels rise with y, rows of the picture fall.
        const glm::ivec2 cell(m % slab.grid.x, slab.grid.y - 1 - m / slab.grid.x);
        for (int j = 0; j < thumb.y; ++j) {
            for (int i = 0; i < thumb.x; ++i) {
                const glm::ivec2 at = cell * (thumb + kGap_px) + glm::ivec2(i, thumb.y - 1 - j);
                const glm::dvec3 mean =
                    block_mean(slab, m, {i * step, j * step_y}, {step, step_y}) /
                    std::max(brightest, 1e-300);
                // A cube root of luminance shows three decades; color keeps its ratios.
                const double y = model::luminance(mean);
                put(picture, at, y > 0.0 ? mean * std::pow(y, 1.0 / 3.0 - 1.0) * 0.8 : mean);
            }
        }
    }
    return picture;
}

PixelImage lens_picture(const Headlight& headlight,
                        const LightField& lightfield,
                        const std::vector<glm::dvec2>& tangents,
                        int height_px) {
    const Slab& slab = lightfield.slabs.front();
    const double half_m = 1.15 * kLensHalf_m.x;  // a square around the lens
    const glm::ivec2 cell(height_px, height_px);
    const int columns = static_cast<int>(tangents.size());
    PixelImage picture = blank(glm::ivec2(columns, 2) * (cell + kGap_px) - kGap_px);
    for (int column = 0; column < columns; ++column) {
        const glm::dvec2 tangent = tangents[static_cast<std::size_t>(column)];
        const std::size_t pixels =
            static_cast<std::size_t>(cell.x) * static_cast<std::size_t>(cell.y);
        std::vector<glm::dvec3> seen(2 * pixels);
        tbb::parallel_for(std::size_t{0}, pixels, [&](std::size_t k) {
            const int pixel = static_cast<int>(k);
            const glm::dvec2 share =
                (glm::dvec2(pixel % cell.x, pixel / cell.x) + 0.5) / glm::dvec2(cell);
            const glm::dvec2 u_m(half_m * (2.0 * share.x - 1.0), half_m * (1.0 - 2.0 * share.y));
            seen[k] = radiance(headlight, u_m, tangent);
            seen[pixels + k] = model::radiance(slab, u_m, u_m + slab.delta_m * tangent);
        });
        double brightest = 0.0;
        for (const glm::dvec3& color : seen) {
            brightest = std::max(brightest, model::luminance(color));
        }
        for (int k = 0; k < 2 * cell.x * cell.y; ++k) {
            const int row = k / (cell.x * cell.y), inside = k % (cell.x * cell.y);
            put(picture,
                glm::ivec2(column, row) * (cell + kGap_px) +
                    glm::ivec2(inside % cell.x, inside / cell.x),
                seen[static_cast<std::size_t>(k)] / std::max(brightest, 1e-300));
        }
    }
    return picture;
}

}  // namespace nearfield::sample_data
