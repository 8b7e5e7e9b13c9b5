// SPDX-License-Identifier: Apache-2.0
// Pictures of the filter itself against projections and means written here from the definition:
// where it is seen, how much light comes through, and single pixels at its edges.
#include "formats/files/error.h"
#include "sample_data/bench/filter_view.h"
#include "sample_data/bench/transmission.h"
#include "tests/sample_data/bench_small.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

namespace nearfield::sample_data {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kOpen = 1000.0 * (150 * 0.9 + 250 * 0.8 + 90 * 0.7);  // electrons per second

// Everything tilted, small enough on the filter's plane that perspective is nearly linear there.
Bench filter_bench() {
    Bench bench = test::small_bench();
    bench.filter.pitch_m = {0.006, 0.005};
    bench.camera.size_px = {80, 60};
    bench.camera.fx_px = 420;
    bench.camera.fy_px = 424;
    bench.camera.cx_px = 7;  // what the filter lies in is right of the axis
    bench.camera.cy_px = 37;
    bench.camera.vignetting_cos4 = 0.0;
    bench.camera.vignetting = glm::dvec3(0.0);
    return bench;
}

std::vector<float> picture_of(const Bench& bench, glm::ivec2 position) {
    return filter_picture(bench, make_places(bench),
                          static_cast<std::size_t>(position.y * bench.filter.grid.x + position.x));
}

// A point of the filter's plane, turned about x, then about y.
glm::dvec3 on_filter_bench(const Bench& bench, glm::dvec2 at_m) {
    const double a = bench.filter.tilt_deg.x * kDeg, b = bench.filter.tilt_deg.y * kDeg;
    return glm::dvec3(0.0, 0.0, -bench.delta_m) +
           at_m.x * glm::dvec3(std::cos(b), 0.0, -std::sin(b)) +
           at_m.y * glm::dvec3(std::sin(b) * std::sin(a), std::cos(a), std::cos(b) * std::sin(a));
}

glm::dvec2 center_m(const Bench& bench, glm::ivec2 position) {
    const BenchFilter& f = bench.filter;
    const double x = (position.x - 0.5 * (f.grid.x - 1)) * f.pitch_m.x * f.stage_scale.x;
    const double y = (position.y - 0.5 * (f.grid.y - 1)) * f.pitch_m.y * f.stage_scale.y;
    const double skew = f.stage_skew_deg * kDeg;
    return f.center_m + glm::dvec2(x + y * std::sin(skew), y * std::cos(skew));
}

glm::dvec2 projected_px(const Bench& bench, glm::dvec3 point_bench) {
    const BenchCamera& c = bench.camera;
    const glm::dvec3 p = glm::transpose(c.bench_from_camera.rotation) *
                         (point_bench - c.bench_from_camera.translation_m);
    const double x = p.x / p.z, y = p.y / p.z, r2 = x * x + y * y;
    const double radial = 1.0 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2;
    return {c.fx_px * (x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x)) + c.cx_px,
            c.fy_px * (y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y) + c.cy_px};
}

// The point of the filter's plane that is seen at a position: Newton's iteration on the projection.
glm::dvec2 seen_m(const Bench& bench, glm::dvec2 at_px) {
    glm::dvec2 at_m(0.0);
    for (int step = 0; step < 5; ++step) {
        constexpr double kStep_m = 1e-5;
        const auto px = [&](glm::dvec2 d) {
            return projected_px(bench, on_filter_bench(bench, at_m + d));
        };
        const glm::dmat2 slope((px({kStep_m, 0}) - px({-kStep_m, 0})) / (2 * kStep_m),
                               (px({0, kStep_m}) - px({0, -kStep_m})) / (2 * kStep_m));
        at_m += glm::inverse(slope) * (at_px - px({0, 0}));
    }
    return at_m;
}

struct Blob {
    glm::dvec2 centroid_px{0.0};
    double sum = 0;
};

Blob blob_of(const Bench& bench, const std::vector<float>& picture) {
    Blob blob;
    for (int y = 0; y < bench.camera.size_px.y; ++y) {
        for (int x = 0; x < bench.camera.size_px.x; ++x) {
            const double value = picture[static_cast<std::size_t>(y * bench.camera.size_px.x + x)];
            blob.sum += value;
            blob.centroid_px += value * glm::dvec2(x + 0.5, y + 0.5);
        }
    }
    blob.centroid_px /= blob.sum;
    return blob;
}

// Pixels that a square of a metre covers, at a place of the filter.
double pixels_per_m2(const Bench& bench, glm::dvec2 at_m) {
    constexpr double kStep_m = 1e-5;
    const auto px = [&](double x, double y) {
        return projected_px(bench, on_filter_bench(bench, at_m + glm::dvec2(x, y)));
    };
    const glm::dvec2 a = (px(kStep_m, 0) - px(-kStep_m, 0)) / (2 * kStep_m);
    const glm::dvec2 b = (px(0, kStep_m) - px(0, -kStep_m)) / (2 * kStep_m);
    return std::abs(a.x * b.y - a.y * b.x);
}

TEST(BenchFilterView, LiesWhereItIsProjectedAndLetsThroughWhatItShould) {
    const Bench bench = filter_bench();
    double worst_px = 0.0, worst_rel = 0.0;
    for (const glm::ivec2 position : {glm::ivec2(0, 0), glm::ivec2(2, 1), glm::ivec2(1, 2)}) {
        const glm::dvec2 at_m = center_m(bench, position);
        const glm::dvec2 truth_px = projected_px(bench, on_filter_bench(bench, at_m));
        const Blob blob = blob_of(bench, picture_of(bench, position));
        worst_px = std::max(worst_px, glm::length(blob.centroid_px - truth_px));
        // The B-spline's integral is 1 in both axes.
        const double expected =
            kOpen * bench.filter.pitch_m.x * bench.filter.pitch_m.y * pixels_per_m2(bench, at_m);
        worst_rel = std::max(worst_rel, std::abs(blob.sum / expected - 1.0));
    }
    // Perspective over the filter's support moves the centroid by some thousandths of a pixel.
    EXPECT_LT(worst_px, 0.02);
    EXPECT_LT(worst_rel, 2e-3);
    std::cout << "worst centroid " << worst_px << " px, light " << worst_rel << "\n";
}

// The mean over a pixel's square of a transmission of the point seen, by 60 x 60 points.
template <typename Transmission>
double brute_pixel(const Bench& bench, glm::ivec2 pixel, const Transmission& transmission) {
    constexpr int kAlong = 60;
    double sum = 0.0;
    for (int j = 0; j < kAlong; ++j)
        for (int i = 0; i < kAlong; ++i)
            sum += transmission(
                seen_m(bench, glm::dvec2(pixel) + (glm::dvec2(i, j) + 0.5) / double(kAlong)));
    return sum / (kAlong * kAlong);
}

// Largest difference of single pixels around a position's edge, of the open filter's.
template <typename Transmission>
double worst_pixel(const Bench& bench,
                   glm::ivec2 position,
                   glm::dvec2 half_m,
                   double open,
                   const Transmission& transmission) {
    const std::vector<float> picture = picture_of(bench, position);
    double worst = 0.0;
    int partly = 0;
    for (int k = 0; k < 12; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / 12;
        // From the middle through the corner of the support to beyond it.
        const glm::dvec2 at_m =
            center_m(bench, position) +
            (0.4 + 0.07 * k) * glm::dvec2(std::cos(angle), std::sin(angle)) * half_m;
        const glm::ivec2 pixel(glm::floor(projected_px(bench, on_filter_bench(bench, at_m))));
        const double expected = brute_pixel(bench, pixel, transmission);
        partly += expected > 0.0 && expected < 1.0 ? 1 : 0;
        const double value =
            picture[static_cast<std::size_t>(pixel.y * bench.camera.size_px.x + pixel.x)];
        worst = std::max(worst, std::abs(value / open - expected));
    }
    EXPECT_GT(partly, 2);
    return worst;
}

TEST(BenchFilterView, PixelsAreTheMeanOfWhatTheySee) {
    Bench bench = filter_bench();
    bench.camera.psf_sigma_px = 0.0;
    const glm::ivec2 position(2, 1);
    const glm::dvec2 at_m = center_m(bench, position);
    const auto box = [&](glm::dvec2 seen) {
        const glm::dvec2 x = glm::abs((seen - at_m) / bench.filter.pitch_m);
        return x.x < 0.5 && x.y < 0.5 ? 1.0 : 0.0;
    };
    const auto tent = [&](glm::dvec2 seen) {
        const glm::dvec2 x =
            glm::max(1.0 - glm::abs((seen - at_m) / bench.filter.pitch_m), glm::dvec2(0.0));
        return x.x * x.y;
    };
    const auto hole = [&](glm::dvec2 seen) {
        return glm::length(seen - at_m) < bench.filter.hole_radius_m ? 1.0 : 0.0;
    };
    // Samples are rectangles along the filter's axes that stand for parallelograms: at a jump that
    // moves an edge by a few hundredths of a sixth of a pixel; so do 60 x 60 points.
    bench.filter.profile = model::make_profile("bilinear");
    EXPECT_LT(worst_pixel(bench, position, bench.filter.pitch_m, kOpen, tent), 1e-3);
    bench.filter.profile = model::make_profile("box");
    EXPECT_LT(worst_pixel(bench, position, 0.5 * bench.filter.pitch_m, kOpen, box), 0.02);
    bench.setup = Setup::Pinhole;
    bench.filter.hole_radius_m = 0.004;
    EXPECT_LT(worst_pixel(bench, position, glm::dvec2(0.004), 1000.0 * (150 + 250 + 90), hole),
              0.02);
}

TEST(BenchFilterView, IsOfTheCameraAndTheEvenSourceAlone) {
    Bench bench = test::small_bench();
    const Prepared prepared = prepare(bench);
    Shot shot;
    shot.subject = Subject::Filter;
    shot.position = {1, 1};
    EXPECT_EQ(signal_e_per_s(*prepared, shot), picture_of(bench, {1, 1}));
    shot.exposure_us = 15000;
    const std::vector<std::uint16_t> lit = expose(*prepared, shot);
    EXPECT_GT(*std::max_element(lit.begin(), lit.end()), 500);
    shot.lamp_on = false;
    EXPECT_EQ(lit, expose(*prepared, shot));
    EXPECT_EQ(photometer_lx(*prepared, shot), 0.0);
    shot.position = {3, 0};
    EXPECT_THROW(expose(*prepared, shot), Error);
    bench.setup = Setup::Direct;
    shot.position = {1, 1};
    EXPECT_THROW(expose(*prepare(bench), shot), Error);
}

// Against counted points, and tiles against the disk's area.
TEST(DiskShare, IsTheShareOfTheRectangle) {
    constexpr double kRadius_m = 0.7;
    support::Random random{5};
    double worst = 0.0;
    for (int k = 0; k < 60; ++k) {
        const glm::dvec2 center(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
        const glm::dvec2 size(0.05 + 1.5 * random.uniform(), 0.05 + 1.5 * random.uniform());
        constexpr int kAlong = 300;
        int inside = 0;
        for (int j = 0; j < kAlong; ++j)
            for (int i = 0; i < kAlong; ++i) {
                const glm::dvec2 p = center + size * ((glm::dvec2(i, j) + 0.5) / 300.0 - 0.5);
                inside += glm::dot(p, p) < kRadius_m * kRadius_m ? 1 : 0;
            }
        worst = std::max(worst, std::abs(disk_share(center, size, kRadius_m) -
                                         inside / double(kAlong * kAlong)));
    }
    EXPECT_LT(worst, 2e-3);  // points on the rim: 300 of 90,000 a crossing, half of them wrong
    double area_m2 = 0.0;
    for (double y = -0.95; y < 1.0; y += 0.1)
        for (double x = -0.95; x < 1.0; x += 0.1)
            area_m2 += 0.01 * disk_share({x, y}, {0.1, 0.1}, kRadius_m);
    EXPECT_NEAR(area_m2, std::numbers::pi * kRadius_m * kRadius_m, 1e-12);
}

}  // namespace
}  // namespace nearfield::sample_data
