// SPDX-License-Identifier: Apache-2.0
#include "fit/rectify.h"

#include "fit/polygon.h"
#include "formats/files/error.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

// A texel narrower than this many cells of the lattice is interpolated.
constexpr double kNarrowCells = 1.0;

// Pixels of one color: cell (a, b) is the square of `step` pixels around the center of pixel
// first + step * (a, b).
struct Lattice {
    glm::ivec2 first{0};
    int step = 1;
    glm::ivec2 count{0};

    glm::dvec2 cell_from_px(glm::dvec2 px) const {
        return (px - (glm::dvec2(first) + 0.5)) / static_cast<double>(step) + 0.5;
    }
    std::uint32_t pixel(int a, int b, int columns) const {
        return static_cast<std::uint32_t>((first.y + step * b) * columns + first.x + step * a);
    }
};

std::vector<Lattice> lattices_of(glm::ivec2 size_px, const std::string& mosaic, int channel) {
    if (mosaic == "mono" && channel == 0)
        return {{{0, 0}, 1, size_px}};
    const auto colors = std::array<std::string, 4>{"rggb", "grbg", "gbrg", "bggr"};
    if (std::find(colors.begin(), colors.end(), mosaic) == colors.end() || channel < 0 ||
        channel > 2)
        throw Error{"cannot rectify", "mosaic", "mono (channel 0), rggb, grbg, gbrg or bggr",
                    fmt::format("'{}', channel {}", mosaic, channel)};
    std::vector<Lattice> lattices;
    for (int p = 0; p < 4; ++p)
        if (mosaic[static_cast<std::size_t>(p)] == "rgb"[channel]) {
            const glm::ivec2 first(p % 2, p / 2);
            lattices.push_back({first, 2, (size_px - first + 1) / 2});
        }
    return lattices;
}

using Quadrilateral = std::array<glm::dvec2, 4>;

std::optional<Quadrilateral> texel_px(const TexelGrid& grid,
                                      int i,
                                      int j,
                                      const ProjectS& project_px) {
    const glm::dvec2 texel_m = (grid.s_max_m - grid.s_min_m) / glm::dvec2(grid.texels);
    constexpr std::array<glm::ivec2, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    Quadrilateral corners{};
    for (std::size_t c = 0; c < 4; ++c) {
        const auto seen =
            project_px(grid.s_min_m + glm::dvec2(glm::ivec2(i, j) + kCorners[c]) * texel_m);
        if (!seen)
            return std::nullopt;
        corners[c] = *seen;
    }
    return corners;
}

double narrowest(const Quadrilateral& cells) {
    double least = glm::distance(cells[0], cells[3]);
    for (std::size_t c = 0; c + 1 < 4; ++c)
        least = std::min(least, glm::distance(cells[c], cells[c + 1]));
    return least;
}

// Shares of the quadrilateral's area in every cell that it meets.
void add_areas(const Lattice& lattice,
               const Quadrilateral& cells,
               int columns,
               double share,
               std::vector<Tap>& taps) {
    const Polygon whole(cells.begin(), cells.end());
    const double area = std::abs(signed_area(whole));
    if (!(area > 0.0))
        return;
    const auto [least, most] = bounds(whole);
    const glm::ivec2 begin = glm::max(glm::ivec2(glm::floor(least)), glm::ivec2(0));
    const glm::ivec2 end = glm::min(glm::ivec2(glm::ceil(most)), lattice.count);
    for (int b = begin.y; b < end.y; ++b) {
        const Polygon row = clipped(clipped(whole, 1, b, 1.0), 1, b + 1, -1.0);
        for (int a = begin.x; a < end.x; ++a) {
            const double part =
                std::abs(signed_area(clipped(clipped(row, 0, a, 1.0), 0, a + 1, -1.0)));
            if (part > 0.0)
                taps.push_back(
                    {lattice.pixel(a, b, columns), static_cast<float>(share * part / area)});
        }
    }
}

// Bilinear weights of the four cells around the quadrilateral's middle.
void add_interpolation(const Lattice& lattice,
                       const Quadrilateral& cells,
                       int columns,
                       double share,
                       std::vector<Tap>& taps) {
    const glm::dvec2 middle = 0.25 * (cells[0] + cells[1] + cells[2] + cells[3]) - 0.5;
    const glm::dvec2 base = glm::floor(middle);
    const glm::dvec2 f = middle - base;
    for (int c = 0; c < 4; ++c) {
        const glm::ivec2 at = glm::ivec2(base) + glm::ivec2(c % 2, c / 2);
        const double weight = (c % 2 == 1 ? f.x : 1.0 - f.x) * (c / 2 == 1 ? f.y : 1.0 - f.y);
        const bool is_inside =
            at.x >= 0 && at.y >= 0 && at.x < lattice.count.x && at.y < lattice.count.y;
        if (is_inside && weight > 0.0)
            taps.push_back(
                {lattice.pixel(at.x, at.y, columns), static_cast<float>(share * weight)});
    }
}

// One row of texels, before all rows are put one after the other.
struct MapRow {
    std::vector<Tap> taps;
    std::vector<std::uint32_t> count;
    std::vector<std::uint8_t> is_interpolated;
    double texel_cells_least = std::numeric_limits<double>::infinity();
};

MapRow map_row(const TexelGrid& grid,
               const std::vector<Lattice>& lattices,
               int columns,
               int j,
               const ProjectS& project_px) {
    MapRow row;
    for (int i = 0; i < grid.texels.x; ++i) {
        const std::size_t before = row.taps.size();
        bool is_narrow = false;
        if (const auto corners_px = texel_px(grid, i, j, project_px))
            for (const Lattice& lattice : lattices) {
                Quadrilateral cells = *corners_px;
                for (glm::dvec2& corner : cells)
                    corner = lattice.cell_from_px(corner);
                const double width = narrowest(cells);
                row.texel_cells_least = std::min(row.texel_cells_least, width);
                is_narrow = width < kNarrowCells;
                const double share = 1.0 / static_cast<double>(lattices.size());
                if (is_narrow)
                    add_interpolation(lattice, cells, columns, share, row.taps);
                else
                    add_areas(lattice, cells, columns, share, row.taps);
            }
        row.count.push_back(static_cast<std::uint32_t>(row.taps.size() - before));
        row.is_interpolated.push_back(is_narrow ? 1 : 0);
    }
    return row;
}

// Sum of products of two texels' weights on the pixels that they share.
double common_weight(std::span<const Tap> a, std::span<const Tap> b) {
    double sum = 0.0;
    for (const Tap& tap : a)
        for (const Tap& other : b)
            if (tap.pixel == other.pixel)
                sum += static_cast<double>(tap.weight) * static_cast<double>(other.weight);
    return sum;
}

std::span<const Tap> taps_of(const RectifyMap& map, std::size_t texel) {
    return std::span(map.taps).subspan(map.begin[texel], map.begin[texel + 1] - map.begin[texel]);
}

double mean_neighbor_correlation(const RectifyMap& map) {
    const auto width = static_cast<std::size_t>(map.texels.x);
    double sum = 0.0, count = 0.0;
    for (std::size_t texel = 0; texel + 1 < map.begin.size() - 1; ++texel) {
        const auto a = taps_of(map, texel), b = taps_of(map, texel + 1);
        if (texel % width + 1 == width || a.empty() || b.empty())
            continue;
        sum += common_weight(a, b) / std::sqrt(common_weight(a, a) * common_weight(b, b));
        count += 1.0;
    }
    return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

RectifyMap make_rectify_map(const TexelGrid& grid,
                            glm::ivec2 size_px,
                            const std::string& mosaic,
                            int channel,
                            const ProjectS& project_px) {
    const std::vector<Lattice> lattices = lattices_of(size_px, mosaic, channel);
    std::vector<MapRow> rows(static_cast<std::size_t>(grid.texels.y));
    tbb::parallel_for(0, grid.texels.y, [&](int j) {
        rows[static_cast<std::size_t>(j)] = map_row(grid, lattices, size_px.x, j, project_px);
    });
    RectifyMap map;
    map.texels = grid.texels;
    map.size_px = size_px;
    map.begin.push_back(0);
    map.texel_cells_least = std::numeric_limits<double>::infinity();
    for (const MapRow& row : rows) {
        map.taps.insert(map.taps.end(), row.taps.begin(), row.taps.end());
        for (const std::uint32_t count : row.count)
            map.begin.push_back(map.begin.back() + count);
        map.is_interpolated.insert(map.is_interpolated.end(), row.is_interpolated.begin(),
                                   row.is_interpolated.end());
        map.texel_cells_least = std::min(map.texel_cells_least, row.texel_cells_least);
    }
    const auto interpolated =
        std::count(map.is_interpolated.begin(), map.is_interpolated.end(), std::uint8_t{1});
    map.interpolated_share =
        static_cast<double>(interpolated) / static_cast<double>(map.is_interpolated.size());
    map.neighbor_correlation = mean_neighbor_correlation(map);
    return map;
}

RectifiedImage rectify(const RectifyMap& map,
                       std::span<const float> value,
                       std::span<const float> variance,
                       double least_share) {
    const std::size_t pixels =
        static_cast<std::size_t>(map.size_px.x) * static_cast<std::size_t>(map.size_px.y);
    if (value.size() != pixels || variance.size() != pixels)
        throw Error{"picture does not fit", "rectify", fmt::format("{} pixels", pixels),
                    fmt::format("{}, {}", value.size(), variance.size())};
    const std::size_t texels = map.begin.size() - 1;
    RectifiedImage image;
    image.value.assign(texels, 0.0F);
    image.variance.assign(texels, std::numeric_limits<float>::infinity());
    tbb::parallel_for(std::size_t{0}, texels, [&](std::size_t texel) {
        double weight = 0.0, sum = 0.0, square = 0.0;
        for (const Tap& tap : taps_of(map, texel)) {
            if (std::isinf(variance[tap.pixel]))
                continue;
            const double w = tap.weight;
            weight += w;
            sum += w * static_cast<double>(value[tap.pixel]);
            square += w * w * static_cast<double>(variance[tap.pixel]);
        }
        if (weight > 0.0 && weight >= least_share) {
            image.value[texel] = static_cast<float>(sum / weight);
            image.variance[texel] = static_cast<float>(square / (weight * weight));
        }
    });
    return image;
}

}  // namespace nearfield::fit
