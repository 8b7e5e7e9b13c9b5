// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/board.h"
#include "sample_data/bench/optics.h"
#include "sample_data/bench/prepare_parts.h"

#include <glm/gtc/constants.hpp>

#include <optional>

namespace nearfield::sample_data {
namespace {

// A ray's point on a plane in the plane's frame; none where it looks away from it.
std::optional<glm::dvec2> on_plane(const Rigid& plane_from_camera, glm::dvec3 ray_of_camera) {
    const glm::dvec3 ray = plane_from_camera.rotation * ray_of_camera;
    const std::optional<double> t = meet_plane(plane_from_camera.translation_m, ray);
    if (!t || *t <= 0.0)
        return std::nullopt;
    return glm::dvec2(plane_from_camera.translation_m + *t * ray);
}

// Lights up what the camera sees of the board and, behind it, of the bare screen.
class BoardSampler {
  public:
    BoardSampler(const Bench& bench, const Places& places, std::size_t view, const SampleRays& rays)
        : bench_(bench), rays_(rays), colors_(seen_colors(bench, glm::dvec3(1.0))) {
        const Rigid& bench_from_camera = bench.camera.bench_from_camera;
        board_from_camera_ = inverse(places.bench_from_board[view]) * bench_from_camera;
        screen_from_camera_ = inverse(places.bench_from_screen) * bench_from_camera;
        has_screen_ = bench.targets.views[view].plane == BoardPlane::Screen;
        is_seen_from_front_ = board_from_camera_.translation_m.z < 0.0;
    }

    void sample_row(int row, std::span<float> values) const {
        const std::size_t width = rays_.width - 1;
        const double luminance_of_white = bench_.targets.room_lx / glm::pi<double>();
        for (std::size_t i = 0; i < width; ++i) {
            const int column = static_cast<int>(i);
            const glm::dvec3 reflectance = seen_reflectance(
                rays_.ray(column, row), rays_.ray(column + 1, row), rays_.ray(column, row + 1));
            const double factor = luminance_of_white * rays_.vignetting[rays_.index(column, row)];
            for (std::size_t p = 0; p < colors_.size(); ++p)
                values[p * width + i] =
                    static_cast<float>(factor * glm::dot(colors_[p], reflectance));
        }
    }

  private:
    glm::dvec3 seen_reflectance(glm::dvec3 ray, glm::dvec3 right, glm::dvec3 below) const {
        BoardArea seen;
        const auto here = on_plane(board_from_camera_, ray);
        const auto at_right = on_plane(board_from_camera_, right);
        const auto at_below = on_plane(board_from_camera_, below);
        if (is_seen_from_front_ && here && at_right && at_below) {
            // The sample's share of the pixel is a parallelogram; the rectangle along the board's
            // axes that stands for it has the same spread along each.
            const glm::dvec2 a = *at_right - *here, b = *at_below - *here;
            seen = board_area(bench_.targets.board, *here, glm::sqrt(a * a + b * b));
        }
        const glm::dvec3 backdrop =
            has_screen_ && seen.covered < 1.0 ? screen_reflectance(ray) : glm::dvec3(0.0);
        return glm::dvec3(seen.reflectance) + (1.0 - seen.covered) * backdrop;
    }

    glm::dvec3 screen_reflectance(glm::dvec3 ray) const {
        const BenchScreen& screen = bench_.screen;
        const auto at_m = on_plane(screen_from_camera_, ray);
        const bool is_on_screen = at_m && at_m->x >= screen.min_m.x && at_m->y >= screen.min_m.y &&
                                  at_m->x <= screen.max_m.x && at_m->y <= screen.max_m.y;
        return is_on_screen ? screen.reflectance : glm::dvec3(0.0);
    }

    const Bench& bench_;
    const SampleRays& rays_;
    SeenColors colors_;
    Rigid board_from_camera_, screen_from_camera_;
    bool has_screen_ = false, is_seen_from_front_ = false;
};

}  // namespace

void prepare_targets(PreparedBench& prepared) {
    const Bench& bench = prepared.bench;
    // Edges are sharp: twice the samples.
    const SampleGrid samples = make_sample_grid(bench.camera, 2 * bench.accuracy.subsamples);
    const SampleRays rays = sample_rays(bench.camera, samples);
    for (std::size_t view = 0; view < bench.targets.views.size(); ++view) {
        const BoardSampler sampler(bench, prepared.places, view, rays);
        prepared.targets.push_back(form_picture(
            bench.camera, samples,
            [&](int row, std::span<float> values) { sampler.sample_row(row, values); }, true));
    }
    const SeenColors colors = seen_colors(bench, glm::dvec3(bench.flat_cd_m2));
    const auto width = static_cast<std::size_t>(samples.count.x);
    const auto flat_row = [&](int row, std::span<float> values) {
        for (std::size_t k = 0; k < values.size(); ++k)
            values[k] = rays.vignetting[rays.index(static_cast<int>(k % width), row)] *
                        static_cast<float>(channel_sum(colors[k / width]));
    };
    prepared.flat = form_picture(bench.camera, samples, flat_row, true);
}

}  // namespace nearfield::sample_data
