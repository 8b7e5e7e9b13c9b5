// SPDX-License-Identifier: Apache-2.0
// All noisy pictures of the virtual bench's boards: their corners lie where they are, and give the
// bench's planes back. Filter centers come from its truth here, with noise.
#include "calibrate/geometry.h"
#include "tests/calibrate/corner_errors.h"
#include "tests/calibrate/simulated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

namespace nearfield::calibrate {
namespace {

using sample_data::Bench;

constexpr double kFilterNoise_px = 0.02;

capture::TargetPlane plane_of(sample_data::BoardPlane plane) {
    switch (plane) {
        case sample_data::BoardPlane::Screen:
            return capture::TargetPlane::Screen;
        case sample_data::BoardPlane::Filter:
            return capture::TargetPlane::Filter;
        case sample_data::BoardPlane::Free:
            break;
    }
    return capture::TargetPlane::Free;
}

void expect_corners(const Bench& bench, const std::vector<std::vector<Corner>>& found) {
    const test::CornerErrors errors = test::errors_of(bench, found);
    std::cout << errors << "\n";
    EXPECT_GE(errors.found, 0.98 * errors.visible);
    EXPECT_LT(errors.rms_px(), 0.010);
    EXPECT_LT(errors.worst_px, 0.035);
    EXPECT_LT(glm::length(errors.mean_px()), 0.001);  // half a pixel wrong: 0.7
}

Observations observed(const Bench& whole, const std::vector<std::vector<Corner>>& found) {
    const sample_data::Places places = sample_data::make_places(whole);
    Observations seen;
    seen.size_px = whole.camera.size_px;
    seen.grid = whole.filter.grid;
    seen.pitch_m = whole.filter.pitch_m;
    for (std::size_t view = 0; view < found.size(); ++view)
        seen.boards.push_back({static_cast<int>(view), plane_of(whole.targets.views[view].plane),
                               "view " + std::to_string(view), found[view]});
    for (const int row : {0, 3, 6}) {
        for (const int column : {0, 4, 8}) {
            const auto index = static_cast<std::size_t>(row * seen.grid.x + column);
            const glm::dvec3 center(places.position_m[index], 0.0);
            const glm::dvec2 noise(test::normal(3, 0, index), test::normal(3, 1, index));
            seen.filters.push_back({{column, row},
                                    test::seen_px(whole, apply(places.bench_from_filter, center)) +
                                        kFilterNoise_px * noise,
                                    glm::dmat2(kFilterNoise_px * kFilterNoise_px)});
        }
    }
    return seen;
}

// Distance of the grid's middle from the real, tilted screen.
double true_delta_m(const Bench& bench) {
    const sample_data::Places places = sample_data::make_places(bench);
    const glm::dvec3 middle =
        apply(places.bench_from_filter, glm::dvec3(bench.filter.center_m, 0.0));
    const Rigid& screen = places.bench_from_screen;
    return glm::dot(screen.rotation[2], screen.translation_m - middle);
}

void expect_bench(const std::string& name, const std::string& mosaic) {
    const Bench bench =
        sample_data::read_bench(std::string(NEARFIELD_SOURCE_DIR) + "/sample_data/" + name);
    const Bench targets = test::target_bench(name);
    const std::vector<std::vector<Corner>> corners = test::found_corners(targets, mosaic);
    expect_corners(targets, corners);
    const Geometry found = calibrate_geometry(observed(bench, corners), {});
    const std::vector<std::pair<std::string, double>> truth = {
        {"fx_px", bench.camera.fx_px},
        {"fy_px", bench.camera.fy_px},
        {"cx_px", bench.camera.cx_px},
        {"cy_px", bench.camera.cy_px},
        {"k1", bench.camera.k1},
        {"k2", bench.camera.k2},
        {"p1", bench.camera.p1},
        {"p2", bench.camera.p2},
        {"k3", bench.camera.k3},
        {"delta_m", true_delta_m(bench)},
        {"pitch_x_m", bench.filter.pitch_m.x * bench.filter.stage_scale.x},
        {"pitch_y_m", bench.filter.pitch_m.y * bench.filter.stage_scale.y},
        {"skew_rad", bench.filter.stage_skew_deg * 0.0174532925199},
    };
    int checked = 0;
    for (const rig::Parameter& parameter : found.parameters) {
        for (const auto& [key, value] : truth) {
            if (key != parameter.name)
                continue;
            ++checked;
            const double off = (parameter.value - value) / parameter.sigma;
            std::cout << key << " " << parameter.value << " +- " << parameter.sigma << ", off by "
                      << off << " sigma\n";
            // Errors of corners that pixels make are not all noise: four sigmas.
            EXPECT_LT(std::abs(off), 4.0) << key;
        }
    }
    EXPECT_EQ(checked, 13);
    std::cout << name << ": RMS " << found.rms_px << " px, " << found.outliers.size()
              << " outliers, held out " << found.held_out->rms_px << " px, step "
              << found.planes->step_sigma_m << " m, taken for parallel "
              << found.planes->parallel.position_m << " m, bend " << found.bend->significance_sigma
              << " sigma, " << found.time_s << " s\n";
}

TEST(BenchGeometry, NearBenchIsRecoveredFromItsPictures) {
    expect_bench("bench_near.json", "mono");
}

TEST(BenchGeometry, FarBenchIsRecoveredFromItsPictures) {
    expect_bench("bench_far.json", "rggb");
}

}  // namespace
}  // namespace nearfield::calibrate
