// SPDX-License-Identifier: Apache-2.0
#include "formats/model/luminaire.h"
#include "formats/rays/ray_file.h"
#include "formats/rays/to_lightfield.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

namespace nearfield {
namespace {

using std::numbers::pi;

// Illuminance on n x n points over the 6 x 6 mm square at the ray file's z = 0.1 mm.
std::vector<double> square_illuminance(const rays::Conversion& c, std::size_t n) {
    const double z_m = 1e-3 * (0.1 - c.report.slabs.front().s_plane_mm);
    std::vector<double> e(n * n);
    tbb::parallel_for(std::size_t{0}, n * n, [&](std::size_t k) {
        const auto at = [&](std::size_t i) {
            return 6e-3 * ((static_cast<double>(i) + 0.5) / static_cast<double>(n) - 0.5);
        };
        e[k] = model::luminance(
            model::irradiance(c.lightfield, {{at(k % n), at(k / n), z_m}, {0, 0, -1}}));
    });
    return e;
}

double flux_lm(const std::vector<double>& e) {
    double sum = 0.0;
    for (const double value : e)
        sum += value;
    return sum * 36e-6 / static_cast<double>(e.size());
}

double mean_intensity(const LightField& lf, double max_deg) {
    double sum = 0.0, weight = 0.0;
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 16; ++k) {
            const double t = max_deg * (i + 0.5) / 8 * pi / 180, p = 2 * pi * (k + 0.5) / 16;
            sum += std::sin(t) *
                   model::luminance(model::intensity(
                       lf, {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)}));
            weight += std::sin(t);
        }
    return sum / weight;
}

// Proves, on 100,000 measured rays of a real LED, that flux, near field and far field come out as
// counting rays gives them: 337.000 lm in all, 331.86 lm through a square before the chip, 112.8 cd
// within 5 degrees of the axis; and peak illuminance as the vendor states it from 5 million rays.
TEST(MeasuredLed, AgreesWithItsRaysNearAndFar) {
    const std::filesystem::path folder =
        std::filesystem::path(NEARFIELD_SOURCE_DIR) / "../shared/data/rays/osram_led";
    if (!std::filesystem::exists(folder))
        GTEST_SKIP() << "optional folder " << folder << " is not there";
    const std::string path = std::filesystem::directory_iterator(folder)->path().string();
    const rays::RaySet set = rays::read_rays(path);
    EXPECT_NEAR(rays::flux(set), 337.0, 1e-3);
    rays::ConvertOptions options;
    options.color = false;
    const rays::Conversion c = rays::to_lightfield(set, options);
    ASSERT_EQ(c.lightfield.slabs.size(), 5U);
    const double flux = model::luminance(model::flux(c.lightfield));
    EXPECT_GE(flux, 0.995 * 337.0);
    EXPECT_NEAR(flux, 337.0 - c.report.dropped(), 1e-3 * 337.0);

    const std::vector<double> coarse = square_illuminance(c, 25), fine = square_illuminance(c, 50);
    EXPECT_NEAR(flux_lm(coarse), flux_lm(fine), 0.003 * flux_lm(fine));  // converged
    EXPECT_NEAR(flux_lm(fine), 331.86, 0.015 * 331.86);
    EXPECT_NEAR(mean_intensity(c.lightfield, 5.0), 112.8, 0.05 * 112.8);
    // A point's value carries the noise of some 1000 rays, the largest of many points more: 10 %.
    EXPECT_NEAR(*std::max_element(fine.begin(), fine.end()), 1.2561e8, 0.1 * 1.2561e8);
}

}  // namespace
}  // namespace nearfield
