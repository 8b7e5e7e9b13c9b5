// SPDX-License-Identifier: Apache-2.0
#include "formats/rig/veil.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::rig {
namespace {

constexpr double kBlocksPerSigma = 5.0;
constexpr double kVeilReach = 4.5;  // in sigmas: 7e-6 of the light lie beyond
// I = (P - v G * I) / (1 - v), again and again: the error shrinks by v / (1 - v) each time.
constexpr double kVeilError = 1e-6;

std::size_t index_of(int column, int row, int width) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
}

// Gaussian weights of blocks at distance 0, 1, ..., which sum to 1 with their mirror.
std::vector<float> gaussian_weights(double sigma_blocks) {
    const int reach = std::max(1, static_cast<int>(std::ceil(kVeilReach * sigma_blocks)));
    std::vector<double> weights;
    double sum = 0.0;
    for (int k = 0; k <= reach; ++k) {
        weights.push_back(std::exp(-0.5 * k * k / (sigma_blocks * sigma_blocks)));
        sum += (k == 0 ? 1.0 : 2.0) * weights.back();
    }
    std::vector<float> normalized;
    normalized.reserve(weights.size());
    for (const double weight : weights)
        normalized.push_back(static_cast<float>(weight / sum));
    return normalized;
}

// Blurs along x and transposes; the result is one block wider at both ends, so that what is
// interpolated at the border has a neighbor.
std::vector<float> blur_and_turn(const std::vector<float>& in,
                                 glm::ivec2 size,
                                 const std::vector<float>& weights) {
    const int reach = static_cast<int>(weights.size()) - 1;
    std::vector<float> out(index_of(0, size.x + 2, size.y));
    for (int y = 0; y < size.y; ++y) {
        for (int x = -1; x <= size.x; ++x) {
            float sum = 0.0F;
            for (int k = std::max(0, x - reach); k <= std::min(size.x - 1, x + reach); ++k)
                sum +=
                    weights[static_cast<std::size_t>(std::abs(k - x))] * in[index_of(k, y, size.x)];
            out[index_of(y, x + 1, size.y)] = sum;
        }
    }
    return out;
}

}  // namespace

std::vector<float> wide_blur(std::span<const float> picture, glm::ivec2 size_px, double sigma_px) {
    const int block_px = std::max(1, static_cast<int>(sigma_px / kBlocksPerSigma));
    const glm::ivec2 blocks = (size_px + block_px - 1) / block_px;
    std::vector<float> means(index_of(0, blocks.y, blocks.x));
    const auto inverse_area = 1.0F / static_cast<float>(block_px * block_px);
    for (int y = 0; y < size_px.y; ++y) {
        for (int x = 0; x < size_px.x; ++x)
            means[index_of(x / block_px, y / block_px, blocks.x)] +=
                inverse_area * picture[index_of(x, y, size_px.x)];
    }
    // Gathering light in blocks and interpolating between them spreads it too: by b^2/12 and, on
    // average over t (1 - t), by b^2/6.
    const double sigma_blocks =
        std::sqrt(std::max(0.04, std::pow(sigma_px / block_px, 2.0) - (block_px > 1 ? 0.25 : 0.0)));
    const std::vector<float> weights = gaussian_weights(sigma_blocks);
    const std::vector<float> wide =
        blur_and_turn(blur_and_turn(means, blocks, weights), {blocks.y, blocks.x + 2}, weights);
    const int wide_columns = blocks.x + 2;
    std::vector<float> veil(picture.size());
    for (int y = 0; y < size_px.y; ++y) {
        const float block_y = (static_cast<float>(y) + 0.5F) / static_cast<float>(block_px) + 0.5F;
        const int row = static_cast<int>(block_y);
        for (int x = 0; x < size_px.x; ++x) {
            const float block_x =
                (static_cast<float>(x) + 0.5F) / static_cast<float>(block_px) + 0.5F;
            const int column = static_cast<int>(block_x);
            const float part = block_x - static_cast<float>(column);
            const float top = glm::mix(wide[index_of(column, row, wide_columns)],
                                       wide[index_of(column + 1, row, wide_columns)], part);
            const float bottom = glm::mix(wide[index_of(column, row + 1, wide_columns)],
                                          wide[index_of(column + 1, row + 1, wide_columns)], part);
            veil[index_of(x, y, size_px.x)] =
                glm::mix(top, bottom, block_y - static_cast<float>(row));
        }
    }
    return veil;
}

glm::ivec2 Interleave::size_px(glm::ivec2 whole_px, int plane) const {
    const glm::ivec2 first(plane % step.x, plane / step.x % step.y);
    return (whole_px - first + step - 1) / step;
}

std::vector<float> Interleave::plane_of(std::span<const float> whole,
                                        glm::ivec2 whole_px,
                                        int plane) const {
    const glm::ivec2 first(plane % step.x, plane / step.x % step.y);
    const int channel = plane / (step.x * step.y);
    const glm::ivec2 size = size_px(whole_px, plane);
    std::vector<float> values;
    values.reserve(index_of(0, size.y, size.x));
    for (int y = first.y; y < whole_px.y; y += step.y) {
        for (int x = first.x; x < whole_px.x; x += step.x)
            values.push_back(whole[index_of(x, y, whole_px.x) * static_cast<std::size_t>(channels) +
                                   static_cast<std::size_t>(channel)]);
    }
    return values;
}

void Interleave::put(std::span<const float> plane_values,
                     int plane,
                     glm::ivec2 whole_px,
                     std::span<float> whole) const {
    const glm::ivec2 first(plane % step.x, plane / step.x % step.y);
    const int channel = plane / (step.x * step.y);
    std::size_t next = 0;
    for (int y = first.y; y < whole_px.y; y += step.y) {
        for (int x = first.x; x < whole_px.x; x += step.x)
            whole[index_of(x, y, whole_px.x) * static_cast<std::size_t>(channels) +
                  static_cast<std::size_t>(channel)] = plane_values[next++];
    }
}

Interleave interleave_of(const std::string& mosaic) {
    if (mosaic == "mono")
        return {};
    return mosaic == "rgb" ? Interleave{{1, 1}, 3} : Interleave{{2, 2}, 1};
}

std::vector<float> remove_veil(std::span<const float> picture,
                               glm::ivec2 size_px,
                               const std::string& mosaic,
                               double share,
                               double sigma_px) {
    const Interleave interleave = interleave_of(mosaic);
    const std::size_t count =
        index_of(0, size_px.y, size_px.x) * static_cast<std::size_t>(interleave.channels);
    if (picture.size() != count)
        throw Error{"cannot remove veil", "picture", fmt::format("{} values", count),
                    fmt::format("{}", picture.size())};
    if (!(share >= 0.0 && share < 0.5))
        throw Error{"cannot remove veil", "veil_share", "0 ... 0.5", fmt::format("{}", share)};
    std::vector<float> clear(picture.begin(), picture.end());
    if (share == 0.0)
        return clear;
    const int rounds =
        static_cast<int>(std::ceil(std::log(kVeilError) / std::log(share / (1.0 - share)))) + 1;
    const auto v = static_cast<float>(share);
    for (int plane = 0; plane < interleave.planes(); ++plane) {
        const std::vector<float> seen = interleave.plane_of(picture, size_px, plane);
        const glm::ivec2 size = interleave.size_px(size_px, plane);
        std::vector<float> without = seen;
        for (int round = 0; round < rounds; ++round) {
            const std::vector<float> veil = wide_blur(without, size, sigma_px / interleave.step.x);
            for (std::size_t k = 0; k < seen.size(); ++k)
                without[k] = (seen[k] - v * veil[k]) / (1.0F - v);
        }
        interleave.put(without, plane, size_px, clear);
    }
    return clear;
}

std::vector<float> remove_veil(std::span<const float> picture,
                               glm::ivec2 size_px,
                               const Radiometry& radiometry) {
    return remove_veil(picture, size_px, radiometry.mosaic, radiometry.veil_share,
                       radiometry.veil_sigma_px);
}

}  // namespace nearfield::rig
