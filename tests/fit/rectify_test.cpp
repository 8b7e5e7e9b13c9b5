// SPDX-License-Identifier: Apache-2.0
// Pictures known by formula through an oblique camera. What is not tested here: that the
// projection is the real camera's.
#include "fit/rectify.h"

#include "formats/files/error.h"
#include "tests/fit/bench_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace nearfield::fit {
namespace {

constexpr glm::ivec2 kSizePx{200, 160};
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A camera that looks at S askew: rows of the picture fall with y.
std::optional<glm::dvec2> seen_askew(glm::dvec2 s_m) {
    const double depth = 1.0 + 0.3 * s_m.x - 0.1 * s_m.y;
    return glm::dvec2(100.0 + (180.0 * s_m.x + 12.0 * s_m.y) / depth,
                      80.0 - (170.0 * s_m.y - 9.0 * s_m.x) / depth);
}

std::optional<glm::dvec2> seen_straight(glm::dvec2 s_m) {
    return glm::dvec2(100.0 + 200.0 * s_m.x, 80.0 - 200.0 * s_m.y);
}

// Pixels' means of a function of the picture position, by 16 x 16 points each.
std::vector<float> picture(const std::function<double(glm::dvec2)>& f) {
    std::vector<float> values;
    for (int y = 0; y < kSizePx.y; ++y)
        for (int x = 0; x < kSizePx.x; ++x) {
            double sum = 0.0;
            for (int p = 0; p < 256; ++p)
                sum += f(glm::dvec2(x, y) + (glm::dvec2(p % 16, p / 16) + 0.5) / 16.0);
            values.push_back(static_cast<float>(sum / 256.0));
        }
    return values;
}

std::vector<float> evenly(float value) {
    return std::vector<float>(static_cast<std::size_t>(kSizePx.x * kSizePx.y), value);
}

TexelGrid grid_of(int texels) {
    return {{texels, texels * 3 / 4}, {-0.35, -0.3}, {0.35, 0.3}};
}

TEST(Rectify, KeepsAConstantPictureConstant) {
    for (const char* mosaic : {"mono", "rggb"})
        for (int channel = 0; channel < (mosaic[0] == 'm' ? 1 : 3); ++channel)
            for (const int texels : {7, 40, 300}) {
                const RectifyMap map =
                    make_rectify_map(grid_of(texels), kSizePx, mosaic, channel, seen_askew);
                const RectifiedImage image = rectify(map, evenly(0.3F), evenly(1.0F));
                for (const float value : image.value)
                    ASSERT_EQ(value, 0.3F) << mosaic << channel << " " << texels;
            }
}

TEST(Rectify, WeightsAreAreas) {
    // Each texel's weights add up to 1, and every pixel under the grid hands out its whole area.
    const TexelGrid grid = grid_of(24);
    const RectifyMap map = make_rectify_map(grid, kSizePx, "mono", 0, seen_straight);
    std::vector<double> handed_out(evenly(0).size(), 0.0);
    const double texel_px2 = 200.0 * 0.7 / 24 * 200.0 * 0.6 / 18;
    for (std::size_t texel = 0; texel + 1 < map.begin.size(); ++texel) {
        double sum = 0.0;
        for (std::uint32_t t = map.begin[texel]; t < map.begin[texel + 1]; ++t) {
            sum += static_cast<double>(map.taps[t].weight);
            handed_out[map.taps[t].pixel] += static_cast<double>(map.taps[t].weight) * texel_px2;
        }
        EXPECT_NEAR(sum, 1.0, 1e-6);
    }
    // The grid covers pixels 30 ... 170 and 20 ... 140.
    for (int y = 0; y < kSizePx.y; ++y)
        for (int x = 0; x < kSizePx.x; ++x) {
            const bool is_inside = x >= 30 && x < 170 && y >= 20 && y < 140;
            EXPECT_NEAR(handed_out[static_cast<std::size_t>(y * kSizePx.x + x)],
                        is_inside ? 1.0 : 0.0, 1e-5)
                << x << " " << y;
        }
    EXPECT_EQ(map.interpolated_share, 0.0);
}

TEST(Rectify, ConservesFluxOfNoise) {
    // Seen straight, texels' values times their area are the pixels' sum, whatever the picture.
    support::Random random{2};
    std::vector<float> noise;
    double sum = 0.0;
    for (int y = 0; y < kSizePx.y; ++y)
        for (int x = 0; x < kSizePx.x; ++x) {
            noise.push_back(static_cast<float>(random.uniform()));
            if (x >= 30 && x < 170 && y >= 20 && y < 140)
                sum += static_cast<double>(noise.back());
        }
    const TexelGrid grid = grid_of(24);
    const RectifiedImage image =
        rectify(make_rectify_map(grid, kSizePx, "mono", 0, seen_straight), noise, evenly(1.0F));
    double texel_sum = 0.0;
    for (const float value : image.value)
        texel_sum += static_cast<double>(value);
    EXPECT_NEAR(texel_sum * (140.0 / 24) * (120.0 / 18), sum, 1e-5 * sum);
}

// Mean over texel (i, j) of a function of S, by 40 x 40 points.
double texel_mean(const TexelGrid& grid, int i, int j, const std::function<double(glm::dvec2)>& f) {
    const glm::dvec2 texel_m = (grid.s_max_m - grid.s_min_m) / glm::dvec2(grid.texels);
    double sum = 0.0;
    for (int p = 0; p < 1600; ++p)
        sum += f(grid.s_min_m +
                 (glm::dvec2(i, j) + (glm::dvec2(p % 40, p / 40) + 0.5) / 40.0) * texel_m);
    return sum / 1600.0;
}

TEST(Rectify, LeavesACutOffWhereItWas) {
    // Light below a slanted line on S, none above: the line's place, seen by each column of texels
    // as its light's sum, against the formula's, in texels. Mosaics' colors each for themselves.
    const auto light = [](glm::dvec2 s_m) { return s_m.y < 0.037 + 0.08 * s_m.x ? 1.0 : 0.0; };
    // The inverse of seen_askew by Newton's method on the picture's pixels.
    const auto s_of = [](glm::dvec2 px) {
        glm::dvec2 s_m(0.0);
        for (int step = 0; step < 8; ++step) {
            const glm::dvec2 off = px - *seen_askew(s_m);
            s_m += glm::dvec2(off.x, -off.y) / 180.0;
        }
        return s_m;
    };
    const std::vector<float> seen = picture([&](glm::dvec2 px) { return light(s_of(px)); });
    const TexelGrid grid = grid_of(40);
    for (const auto& [mosaic, channel, limit] :
         {std::tuple{"mono", 0, 0.03}, {"rggb", 0, 0.2}, {"rggb", 1, 0.15}, {"bggr", 0, 0.2}}) {
        const RectifiedImage image = rectify(
            make_rectify_map(grid, kSizePx, mosaic, channel, seen_askew), seen, evenly(1.0F));
        double mean = 0.0;
        for (int i = 0; i < 40; ++i) {
            double measured = 0.0, truth = 0.0;
            for (int j = 0; j < 30; ++j) {
                measured += static_cast<double>(image.value[static_cast<std::size_t>(j * 40 + i)]);
                truth += texel_mean(grid, i, j, light);
            }
            EXPECT_NEAR(measured, truth, limit) << mosaic << channel << " column " << i;
            mean += (measured - truth) / 40.0;
        }
        EXPECT_NEAR(mean, 0.0, 0.02) << mosaic << channel;
    }
}

TEST(Rectify, ReproducesRampsByInterpolation) {
    // Texels smaller than pixels: a ramp stays the same ramp, for every color.
    const std::vector<float> ramp =
        picture([](glm::dvec2 px) { return 3.0 + 0.5 * px.x - 0.25 * px.y; });
    const TexelGrid grid = grid_of(400);
    for (const auto& [mosaic, channel] : {std::pair{"mono", 0}, {"grbg", 0}, {"grbg", 1}}) {
        const RectifyMap map = make_rectify_map(grid, kSizePx, mosaic, channel, seen_straight);
        EXPECT_EQ(map.interpolated_share, 1.0);
        EXPECT_NEAR(map.texel_cells_least, mosaic[0] == 'm' ? 0.35 : 0.175, 1e-9);
        const RectifiedImage image = rectify(map, ramp, evenly(1.0F));
        for (const int i : {0, 133, 399})
            for (const int j : {0, 200, 299}) {
                const glm::dvec2 px(30.0 + 140.0 * (i + 0.5) / 400,
                                    140.0 - 120.0 * (j + 0.5) / 300);
                EXPECT_NEAR(image.value[static_cast<std::size_t>(j * 400 + i)],
                            3.0 + 0.5 * px.x - 0.25 * px.y, 1e-4)
                    << mosaic << channel;
            }
    }
}

TEST(Rectify, ColorsTakeTheirOwnPixelsAlone) {
    // R, G and B of every mosaic get different numbers at their own pixels.
    const float color[] = {1.0F, 2.0F, 3.0F};
    for (const char* mosaic : {"rggb", "grbg", "gbrg", "bggr"}) {
        std::vector<float> values;
        for (int y = 0; y < kSizePx.y; ++y)
            for (int x = 0; x < kSizePx.x; ++x)
                values.push_back(color[std::string("rgb").find(mosaic[2 * (y % 2) + x % 2])]);
        for (int channel = 0; channel < 3; ++channel)
            for (const int texels : {30, 300}) {
                const RectifiedImage image =
                    rectify(make_rectify_map(grid_of(texels), kSizePx, mosaic, channel, seen_askew),
                            values, evenly(1.0F));
                for (const float value : image.value)
                    ASSERT_EQ(value, color[channel]) << mosaic;
            }
    }
}

TEST(Rectify, VarianceIsThatOfTheMean) {
    // Many noisy pictures of nothing: the spread of texels and of sums of neighbors.
    const TexelGrid grid = grid_of(40);
    const RectifyMap map = make_rectify_map(grid, kSizePx, "mono", 0, seen_askew);
    support::Random random{4};
    const std::size_t texels = map.begin.size() - 1;
    double squares = 0.0, reported = 0.0, products = 0.0, count = 0.0;
    for (int n = 0; n < 20; ++n) {
        std::vector<float> noise, variance;
        for (int p = 0; p < kSizePx.x * kSizePx.y; ++p) {
            variance.push_back(static_cast<float>(random.uniform(0.5, 2.0)));
            noise.push_back(static_cast<float>(std::sqrt(static_cast<double>(variance.back())) *
                                               normal_number(random)));
        }
        const RectifiedImage image = rectify(map, noise, variance);
        for (std::size_t t = 0; t + 1 < texels; ++t)
            if (t % 40 != 39) {
                squares += std::pow(static_cast<double>(image.value[t]), 2.0);
                reported += static_cast<double>(image.variance[t]);
                products +=
                    static_cast<double>(image.value[t]) * static_cast<double>(image.value[t + 1]);
                count += 1.0;
            }
    }
    EXPECT_NEAR(squares / reported, 1.0, 0.04);  // 5 sigma of 23,000 texels
    EXPECT_NEAR(products / squares, map.neighbor_correlation, 0.04);
    EXPECT_GT(map.neighbor_correlation, 0.05);
}

TEST(Rectify, LeavesBadPixelsOutAndSaysWhatIsMissing) {
    const RectifyMap map = make_rectify_map(grid_of(20), kSizePx, "mono", 0, seen_straight);
    std::vector<float> values = evenly(2.0F), variance = evenly(1.0F);
    constexpr std::size_t kTexel = 280;  // (0, 14) of 20 a row
    // One bad pixel in it, at picture (30 ... 37, 20 ... 28): its number is not used.
    values[static_cast<std::size_t>(22 * kSizePx.x + 33)] = std::nanf("");
    variance[static_cast<std::size_t>(22 * kSizePx.x + 33)] = kInfinity;
    RectifiedImage image = rectify(map, values, variance);
    EXPECT_EQ(image.value[kTexel], 2.0F);
    EXPECT_GT(image.variance[kTexel], image.variance[kTexel + 5]);
    // Half of them bad: missing.
    for (int y = 20; y < 24; ++y)
        for (int x = 30; x < 37; ++x)
            variance[static_cast<std::size_t>(y * kSizePx.x + x)] = kInfinity;
    image = rectify(map, values, variance);
    EXPECT_EQ(image.variance[kTexel], kInfinity);
    EXPECT_TRUE(std::isfinite(image.variance[kTexel + 1]));
    // Texels beside the picture or behind the camera are missing.
    const RectifyMap beside =
        make_rectify_map({{2, 1}, {0.38, 0.0}, {0.78, 0.2}}, kSizePx, "mono", 0,
                         [](glm::dvec2 s_m) -> std::optional<glm::dvec2> {
                             return s_m.x > 0.6 ? std::nullopt : seen_straight(s_m);
                         });
    image = rectify(beside, evenly(2.0F), evenly(1.0F));
    EXPECT_EQ(image.variance[0], kInfinity);
    EXPECT_EQ(image.variance[1], kInfinity);
}

TEST(Rectify, RefusesUnknownMosaicsAndSizes) {
    EXPECT_THROW((void)make_rectify_map(grid_of(4), kSizePx, "xtrans", 0, seen_askew), Error);
    EXPECT_THROW((void)make_rectify_map(grid_of(4), kSizePx, "mono", 1, seen_askew), Error);
    EXPECT_THROW((void)make_rectify_map(grid_of(4), kSizePx, "rggb", 3, seen_askew), Error);
    const RectifyMap map = make_rectify_map(grid_of(4), kSizePx, "mono", 0, seen_askew);
    EXPECT_THROW((void)rectify(map, std::vector<float>(3), evenly(1.0F)), Error);
}

}  // namespace
}  // namespace nearfield::fit
