// SPDX-License-Identifier: Apache-2.0
// The bench's pictures against a Monte Carlo simulation that is written from the definition alone:
// a point of the pixel, the ray through the distorted lens, the screen, a point of the lamp's lens,
// the filter. It shares the lamp's formula with the bench, and nothing else.
#include "sample_data/bench/prepared.h"
#include "sample_data/headlight.h"
#include "tests/sample_data/bench_small.h"
#include "tests/support/random.h"
#include "tests/support/z_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

namespace nearfield::sample_data {
namespace {

using support::Random;
constexpr double kPi = std::numbers::pi;

struct Plane {
    glm::dvec3 origin{0.0}, x{0.0}, y{0.0}, normal{0.0};
};

// A plane turned about x, then about y.
Plane tilted_plane(glm::dvec2 tilt_deg, double z_m) {
    const double a = tilt_deg.x * kPi / 180.0, b = tilt_deg.y * kPi / 180.0;
    return {{0.0, 0.0, z_m},
            {std::cos(b), 0.0, -std::sin(b)},
            {std::sin(b) * std::sin(a), std::cos(a), std::cos(b) * std::sin(a)},
            {std::sin(b) * std::cos(a), -std::sin(a), std::cos(b) * std::cos(a)}};
}

// Where the line through p and q meets a plane.
glm::dvec3 meet(const Plane& plane, glm::dvec3 p, glm::dvec3 q) {
    const double t = glm::dot(plane.origin - p, plane.normal) / glm::dot(q - p, plane.normal);
    return p + t * (q - p);
}

glm::dvec2 in_plane(const Plane& plane, glm::dvec3 point) {
    return {glm::dot(point - plane.origin, plane.x), glm::dot(point - plane.origin, plane.y)};
}

class Simulation {
  public:
    explicit Simulation(const Bench& bench)
        : bench_(bench),
          headlight_(make_headlight(bench.lamp.headlight_seed)),
          filter_(tilted_plane(bench.filter.tilt_deg, -bench.delta_m)),
          screen_(tilted_plane(bench.screen.tilt_deg, 0.0)) {}

    // One sample of the pixel's electrons per second.
    double sample(glm::ivec2 pixel, glm::ivec2 position, Random& random) const {
        const BenchCamera& camera = bench_.camera;
        const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
        const double angle = 2.0 * kPi * random.uniform();
        const glm::dvec2 at_px =
            glm::dvec2(pixel) + glm::dvec2(random.uniform(), random.uniform()) +
            camera.psf_sigma_px * radius * glm::dvec2(std::cos(angle), std::sin(angle));
        const glm::dvec3 ray = undistorted(at_px);
        const double cosine = 1.0 / glm::length(ray);
        const glm::dvec2 half_px = 0.5 * glm::dvec2(camera.size_px);
        const double r2 = glm::dot(at_px - half_px, at_px - half_px) / glm::dot(half_px, half_px);
        const double vignetting =
            std::pow(cosine, 4) * (1.0 + camera.vignetting.x * r2 + camera.vignetting.y * r2 * r2 +
                                   camera.vignetting.z * r2 * r2 * r2);
        const glm::dvec3 direction = glm::normalize(camera.bench_from_camera.rotation * ray);
        const int color = camera.mosaic == Mosaic::Mono ? 0 : pixel.x % 2 + pixel.y % 2;
        const glm::dvec3 seen = bench_.setup == Setup::Direct
                                    ? direct(direction, position)
                                    : off_screen(direction, position, random);
        double electrons = 0.0;
        for (int channel = 0; channel < 3; ++channel)
            electrons += camera.response_e_per_cd_m2_s[channel][color] * seen[channel];
        return vignetting * electrons;
    }

  private:
    // Brown's model undone by repeated substitution.
    glm::dvec3 undistorted(glm::dvec2 at_px) const {
        const BenchCamera& c = bench_.camera;
        const double u = (at_px.x - c.cx_px) / c.fx_px, v = (at_px.y - c.cy_px) / c.fy_px;
        double x = u, y = v;
        for (int step = 0; step < 60; ++step) {
            const double r2 = x * x + y * y;
            const double radial = 1.0 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2;
            const double dx = 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x);
            const double dy = c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y;
            x = (u - dx) / radial;
            y = (v - dy) / radial;
        }
        return {x, y, 1.0};
    }

    glm::dvec2 center(glm::ivec2 position) const {
        const BenchFilter& f = bench_.filter;
        const double x = (position.x - 0.5 * (f.grid.x - 1)) * f.pitch_m.x * f.stage_scale.x;
        const double y = (position.y - 0.5 * (f.grid.y - 1)) * f.pitch_m.y * f.stage_scale.y;
        const double skew = f.stage_skew_deg * kPi / 180.0;
        return f.center_m + glm::dvec2(x + y * std::sin(skew), y * std::cos(skew));
    }

    // Radiance of the lamp along the line from p to q, p nearer to it; the lens is not turned.
    glm::dvec3 lamp(glm::dvec3 p, glm::dvec3 q) const {
        const glm::dvec3 lens =
            bench_.lamp.u_from_lamp.translation_m - glm::dvec3(0.0, 0.0, bench_.delta_m);
        const glm::dvec2 tangent = glm::dvec2(q - p) / (q.z - p.z);
        const glm::dvec2 a = glm::dvec2(p - lens) + (lens.z - p.z) * tangent;
        return radiance(headlight_, a, tangent);
    }

    glm::dvec3 direct(glm::dvec3 towards_lamp, glm::ivec2 position) const {
        const glm::dvec2 at = center(position);
        const glm::dvec3 u = filter_.origin + at.x * filter_.x + at.y * filter_.y;
        return lamp(u + towards_lamp, u);
    }

    glm::dvec3 off_screen(glm::dvec3 direction, glm::ivec2 position, Random& random) const {
        const glm::dvec3 eye = bench_.camera.bench_from_camera.translation_m;
        const glm::dvec3 s = meet(screen_, eye, eye + direction);
        const glm::dvec2 on_screen = in_plane(screen_, s);
        const BenchScreen& screen = bench_.screen;
        if (on_screen.x < screen.min_m.x || on_screen.x > screen.max_m.x ||
            on_screen.y < screen.min_m.y || on_screen.y > screen.max_m.y)
            return glm::dvec3(0.0);
        const double cosine = std::abs(glm::dot(direction, screen_.normal));
        const double lobe =
            1.0 - screen.lobe_share + screen.lobe_share * std::pow(cosine, screen.lobe_exponent);
        const glm::dvec3 irradiance = bench_.setup == Setup::Filter
                                          ? through_filter(s, position, random)
                                          : through_hole(s, position, random);
        return screen.reflectance * irradiance * lobe / kPi;
    }

    // The integral over U itself (the bench integrates over the lens). A sum of three uniform
    // numbers is distributed as the B-spline, one as the box: the transmission is the density.
    glm::dvec3 through_filter(glm::dvec3 s, glm::ivec2 position, Random& random) const {
        const bool is_box = bench_.filter.profile.name == "box";
        const auto drawn = [&] {
            return is_box ? random.uniform() - 0.5
                          : random.uniform() + random.uniform() + random.uniform() - 1.5;
        };
        const double x = drawn();
        const glm::dvec2 at = center(position) + glm::dvec2(x, drawn()) * bench_.filter.pitch_m;
        const glm::dvec3 u = filter_.origin + at.x * filter_.x + at.y * filter_.y;
        const double area = bench_.filter.pitch_m.x * bench_.filter.pitch_m.y;
        const glm::dvec3 d = s - u;
        const double r2 = glm::dot(d, d);
        return bench_.filter.transmission * lamp(u, s) *
               (area * glm::dot(d, filter_.normal) * glm::dot(d, screen_.normal) / (r2 * r2));
    }

    glm::dvec3 through_hole(glm::dvec3 s, glm::ivec2 position, Random& random) const {
        const double r = bench_.filter.hole_radius_m * std::sqrt(random.uniform());
        const double angle = 2.0 * kPi * random.uniform();
        const glm::dvec2 at = center(position) + r * glm::dvec2(std::cos(angle), std::sin(angle));
        const glm::dvec3 u = filter_.origin + at.x * filter_.x + at.y * filter_.y;
        const double area = kPi * bench_.filter.hole_radius_m * bench_.filter.hole_radius_m;
        const glm::dvec3 d = s - u;
        const double r2 = glm::dot(d, d);
        return lamp(u, s) *
               (area * glm::dot(d, filter_.normal) * glm::dot(d, screen_.normal) / (r2 * r2));
    }

    const Bench& bench_;
    Headlight headlight_;
    Plane filter_, screen_;
};

double root_mean_square(const std::vector<float>& values) {
    double sum = 0.0;
    for (const float value : values)
        sum += double(value) * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

// Pixels spread over the picture, each with its own position: every one within noise and the
// stated error.
void expect_as_simulated(const Bench& bench, int samples, double sampling_error = 0.0) {
    const Prepared prepared = prepare(bench);
    // The bench's own estimate is an RMS over points: three of them are allowed.
    const double optics_error = 3.0 * prepared->error.total_rel + sampling_error;
    const Simulation simulation(bench);
    constexpr int kPixels = 40;
    const double z_limit = support::sidak_z_limit(kPixels);
    double worst = 0.0, sum_bench = 0.0, sum_simulated = 0.0, sum_variance = 0.0;
    for (int k = 0; k < kPixels; ++k) {
        Random random{static_cast<std::uint64_t>(k) * 1000003U + 17U};
        const glm::ivec2 pixel(3 + static_cast<int>(random.uniform() * 34),
                               8 + static_cast<int>(random.uniform() * 14));
        Shot shot;
        shot.position = {static_cast<int>(random.uniform() * bench.filter.grid.x),
                         static_cast<int>(random.uniform() * bench.filter.grid.y)};
        const std::vector<float> signal = signal_e_per_s(*prepared, shot);
        const double value =
            signal[static_cast<std::size_t>(pixel.y * bench.camera.size_px.x + pixel.x)];
        double sum = 0.0, square = 0.0;
        for (int n = 0; n < samples; ++n) {
            const double sample = simulation.sample(pixel, shot.position, random);
            sum += sample;
            square += sample * sample;
        }
        const double mean = sum / samples;
        const double variance = std::max(0.0, square / samples - mean * mean) / samples;
        const double allowed = optics_error * root_mean_square(signal);
        EXPECT_LE(std::abs(value - mean), z_limit * std::sqrt(variance) + allowed)
            << "pixel " << pixel.x << " " << pixel.y << " position " << shot.position.x << " "
            << shot.position.y << ": bench " << value << ", simulated " << mean << " +- "
            << std::sqrt(variance);
        worst = std::max(worst, std::abs(value - mean) / root_mean_square(signal));
        sum_bench += value;
        sum_simulated += mean;
        sum_variance += variance;
    }
    EXPECT_GT(sum_simulated, 0.0);
    EXPECT_LE(std::abs(sum_bench - sum_simulated),
              3.0 * std::sqrt(sum_variance) + optics_error * sum_simulated);
    std::cout << "largest difference " << worst << " of the RMS, all pixels "
              << sum_bench / sum_simulated - 1.0 << " +- "
              << std::sqrt(sum_variance) / sum_simulated << ", stated error "
              << prepared->error.total_rel << " (quadrature " << prepared->error.quadrature_rel
              << ")\n";
}

TEST(BenchOptics, FilterAndScreenAgreeWithMonteCarlo) {
    expect_as_simulated(test::small_bench(), 20000);
}

TEST(BenchOptics, ColorsOfAMosaicAgreeWithMonteCarlo) {
    Bench bench = test::small_bench();
    bench.camera.mosaic = Mosaic::Rggb;
    bench.camera.response_e_per_cd_m2_s = {210, 40, 6, 60, 230, 45, 8, 35, 190};
    expect_as_simulated(bench, 10000);
}

TEST(BenchOptics, BoxFilterAgreesWithMonteCarlo) {
    Bench bench = test::small_bench();
    bench.filter.profile = model::make_profile("box");
    expect_as_simulated(bench, 20000);
}

TEST(BenchOptics, PinholeAgreesWithMonteCarlo) {
    Bench bench = test::small_bench();
    bench.setup = Setup::Pinhole;
    bench.filter.hole_radius_m = 0.002;
    expect_as_simulated(bench, 10000);
}

TEST(BenchOptics, CameraIntoTheLampAgreesWithMonteCarlo) {
    Bench bench = test::small_bench();
    bench.setup = Setup::Direct;
    bench.camera.fx_px = 30;
    bench.camera.fy_px = 60;
    bench.camera.bench_from_camera.rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    bench.accuracy.subsamples = 8;
    // Sharp edges of facets against 8 x 8 samples of a pixel: at most 1/16 of a step of about a
    // quarter of the radiance.
    expect_as_simulated(bench, 10000, 1.6e-2);
}

// A partition of unity on the filter's plane: all positions together are the open lamp.
TEST(BenchOptics, PositionsOfAPartitionOfUnitySumToTheOpenLamp) {
    Bench bench = test::small_bench();
    bench.lamp.u_from_lamp.translation_m = glm::dvec3(0.0);
    bench.filter.grid = {9, 9};
    bench.filter.center_m = glm::dvec2(0.0);
    bench.filter.transmission = glm::dvec3(1.0);
    bench.filter.tilt_deg = glm::dvec2(0.0);
    bench.filter.stage_scale = glm::dvec2(1.0);
    bench.filter.stage_skew_deg = 0.0;
    const Prepared prepared = prepare(bench);
    std::vector<double> sum(prepared->open.size());
    for (const std::vector<float>& position : prepared->positions) {
        for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] += position[k];
    }
    const float largest = *std::max_element(prepared->open.begin(), prepared->open.end());
    for (std::size_t k = 0; k < sum.size(); ++k) {
        // Floats of 81 pictures: 81 roundings of 6e-8.
        EXPECT_NEAR(sum[k], prepared->open[k], 5e-6 * largest) << k;
    }
}

// What strays is the share of what the filter holds back, and lights the screen evenly, and the
// photometer as much. The camera weighs colors as the eye does, after the screen's reflectance.
TEST(BenchOptics, BlockedLightStraysOntoTheScreen) {
    Bench bench = test::small_bench();
    bench.accuracy.lens_step = 3.0;
    bench.camera.response_e_per_cd_m2_s = {500 * 0.2126 / 0.7, 0, 0, 500 * 0.7152 / 0.8, 0, 0,
                                           500 * 0.0722 / 0.9, 0, 0};
    const Prepared without = prepare(bench);
    bench.stray.blocked_share = 0.01;
    bench.stray.veil_lx = 3.0;
    const Prepared with = prepare(bench);
    const std::size_t middle = 15 * 40 + 20;
    const double per_lx = with->room[middle] / 3.0;  // white, as the camera weighs it
    ASSERT_GT(per_lx, 0.0);
    double most = 0.0, least = 1e30;
    for (std::size_t k = 0; k < with->room.size(); ++k) {
        const double difference = with->positions[4][k] - without->positions[4][k];
        if (with->room[k] > 0.5F * with->room[middle]) {
            most = std::max(most, difference / with->room[k]);
            least = std::min(least, difference / with->room[k]);
        }
    }
    // Differences of floats a thousand times larger.
    EXPECT_NEAR(most / least, 1.0, 0.02);
    // The middle position holds back some part of all light, and 1 % of that strays.
    const double stray_lx = 3.0 * most;
    const double open_lx = test::mean_of(without->open) / per_lx;
    EXPECT_GT(stray_lx, 0.002 * open_lx);
    EXPECT_LT(stray_lx, 0.02 * open_lx);
    // An opaque plate holds back all that the positions, a partition of unity, let through. (What
    // pixels see of the screen's middle is not quite its mean: a few per cent.)
    Shot plate;
    plate.subject = Subject::Blocked;
    const double plate_lx = 3.0 * with->blocked[middle] / with->room[middle];
    EXPECT_GT(plate_lx, stray_lx);
    EXPECT_NEAR(photometer_lx(*with, plate) / (3.0 + plate_lx), 1.0, 0.01);
    const double through = test::mean_of(without->positions[4]) / test::mean_of(without->open);
    EXPECT_NEAR(stray_lx / plate_lx, 1.0 - through, 0.1 * through);
    plate.lamp_on = false;
    EXPECT_NEAR(photometer_lx(*with, plate), 3.0, 1e-9);
    // The photometer's is a mean over fewer points.
    EXPECT_NEAR((with->photometer_lx[4] - without->photometer_lx[4]) / stray_lx, 1.0, 0.01);
}

// The photometer against the formula's own quadrature.
TEST(BenchOptics, PhotometerReadsTheFormulasIlluminance) {
    Bench bench = test::small_bench();
    bench.photometer.position_m = {0.1, -0.05, 0.75};
    const Prepared prepared = prepare(bench);
    Shot shot;
    shot.subject = Subject::Open;
    model::Receiver receiver;
    receiver.position_m = bench.photometer.position_m -
                          (bench.lamp.u_from_lamp.translation_m - glm::dvec3(0, 0, bench.delta_m));
    const double truth_lx = model::luminance(irradiance(make_headlight(1), receiver));
    EXPECT_NEAR(photometer_lx(*prepared, shot) / truth_lx, 1.0, 1e-3);
    shot.lamp_on = false;
    EXPECT_EQ(photometer_lx(*prepared, shot), 0.0);
}

}  // namespace
}  // namespace nearfield::sample_data
