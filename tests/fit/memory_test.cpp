// SPDX-License-Identifier: Apache-2.0
// Proves that a light field larger than a tile goes from measurements to its file in the memory of
// a tile and an image. Alone in its program, since the peak is the process' own.
#include "fit/stream.h"
#include "formats/files/lightfield_rows.h"
#include "tests/fit/bench_planes.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdio>

namespace nearfield::fit {
namespace {

constexpr int kTexels = 4096;  // along an axis
constexpr double kTileBytes = 64e6;

double peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

// Light that differs from texel to texel and position to position.
float light_at(std::size_t k, std::size_t t) {
    return 1e-6F * static_cast<float>(1 + (t + 3 * k) % 97);
}

TileInput tile_of(const Design& design, TileRange rows) {
    const auto width = static_cast<std::size_t>(design.texels.x);
    const std::size_t first = static_cast<std::size_t>(rows.first_row) * width;
    const std::size_t count = static_cast<std::size_t>(rows.row_count) * width;
    TileInput tile;
    for (std::size_t k = 0; k < static_cast<std::size_t>(design.measurement_count); ++k)
        for (std::size_t t = 0; t < count; ++t)
            tile.value.push_back(light_at(k, first + t));
    tile.variance.assign(tile.value.size(), 1e-12F);
    return tile;
}

TEST(Memory, IsThatOfATileAndAnImage) {
    Slab planes = test_planes({2, 2}, "box");
    planes.texels = glm::ivec2(kTexels);
    const Design design = make_design(planes, test_filter(planes, 0.0, "box"));
    FitOptions options;
    options.solve.wants_sigma = true;
    options.tile_bytes = kTileBytes;
    const double before = peak_bytes();
    LightFieldRows rows(planes, {true, 0}, ".");
    const FitReport report = solve_lightfield(
        design, options, [&](TileRange range) { return tile_of(design, range); },
        [&](const TileResult& tile) {
            rows.put(tile.rows.first_row, tile.rows.row_count, tile.coeffs, tile.sigma);
        });
    LightField about;
    rows.write(about, {}, "large.lightfield.exr");
    const double image_bytes = sizeof(float) * static_cast<double>(planes.texel_count());
    const double all_bytes = 2 * 4 * image_bytes;
    std::printf("%d x %d texels: %.0f MB of light field, peak %.0f MB above %.0f MB\n", kTexels,
                kTexels, 1e-6 * all_bytes, 1e-6 * (peak_bytes() - before), 1e-6 * before);
    EXPECT_EQ(report.texel_count, std::int64_t{kTexels} * kTexels);
    // The tile twice, while vectors grow or a tile is replaced; an image, and what it is packed to.
    EXPECT_LT(peak_bytes() - before, 3 * kTileBytes + 3 * image_bytes);
    EXPECT_LT(peak_bytes() - before, 0.8 * all_bytes);

    const std::vector<float> image = rows.image(3).coeffs;
    const double area_m2 = planes.pitch_m.x * planes.pitch_m.y;
    for (std::size_t t = 0; t < image.size(); t += 99991)
        EXPECT_NEAR(static_cast<double>(image[t]) * area_m2, static_cast<double>(light_at(3, t)),
                    1e-11);
}

}  // namespace
}  // namespace nearfield::fit
