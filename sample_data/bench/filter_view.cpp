// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/filter_view.h"

#include "sample_data/bench/optics.h"
#include "sample_data/bench/prepare_parts.h"
#include "sample_data/bench/transmission.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace nearfield::sample_data {
namespace {

// Samples that may see light: [first, last).
struct SampleBox {
    glm::ivec2 first{0}, last{0};
};

class FilterSampler {
  public:
    FilterSampler(const Bench& bench,
                  const Places& places,
                  std::size_t position_index,
                  const SampleGrid& grid)
        : bench_(bench),
          grid_(grid),
          center_m_(places.position_m[position_index]),
          filter_from_camera_(inverse(places.bench_from_filter) * bench.camera.bench_from_camera) {
        const bool is_filter = bench.setup == Setup::Filter;
        const auto cells = static_cast<double>(bench.filter.profile.cells.size());
        half_support_m_ =
            is_filter ? 0.5 * cells * bench.filter.pitch_m : glm::dvec2(bench.filter.hole_radius_m);
        for (const glm::dvec3& color :
             seen_colors(bench, is_filter ? bench.filter.transmission : glm::dvec3(1.0)))
            open_.push_back(bench.flat_cd_m2 * channel_sum(color));
        box_ = lit_box();
    }

    void sample_row(int row, std::span<float> values) const {
        if (row < box_.first.y || row >= box_.last.y)
            return;
        const auto width = static_cast<std::size_t>(grid_.count.x);
        std::optional<glm::dvec2> here = at_m(box_.first.x, row);
        for (int column = box_.first.x; column < box_.last.x; ++column) {
            const std::optional<glm::dvec2> right = at_m(column + 1, row);
            const std::optional<glm::dvec2> below = at_m(column, row + 1);
            if (here && right && below) {
                const double seen =
                    transmission(*here, *right - *here, *below - *here) * dimming(column, row);
                for (std::size_t p = 0; p < open_.size(); ++p)
                    values[p * width + static_cast<std::size_t>(column)] =
                        static_cast<float>(open_[p] * seen);
            }
            here = right;
        }
    }

  private:
    // Where a sample's ray meets the filter's plane, from the filter's center.
    std::optional<glm::dvec2> at_m(int column, int row) const {
        const glm::dvec3 ray = filter_from_camera_.rotation *
                               ray_camera(bench_.camera, grid_.position_px(column, row));
        const std::optional<double> t = meet_plane(filter_from_camera_.translation_m, ray);
        if (!t || *t <= 0.0)
            return std::nullopt;
        return glm::dvec2(filter_from_camera_.translation_m + *t * ray) - center_m_;
    }

    double transmission(glm::dvec2 here_m, glm::dvec2 a_m, glm::dvec2 b_m) const {
        const glm::dvec2 size_m = glm::sqrt(a_m * a_m + b_m * b_m);
        if (bench_.setup == Setup::Pinhole)
            return disk_share(here_m, size_m, bench_.filter.hole_radius_m);
        const glm::dvec2 x = here_m / bench_.filter.pitch_m;
        const glm::dvec2 width = size_m / bench_.filter.pitch_m;
        return mean_transmission(bench_.filter.profile, x.x, width.x) *
               mean_transmission(bench_.filter.profile, x.y, width.y);
    }

    double dimming(int column, int row) const {
        const glm::dvec2 position_px = grid_.position_px(column, row);
        return vignetting(bench_.camera, position_px,
                          glm::dvec2(ray_camera(bench_.camera, position_px)));
    }

    // Around the projected outline of the filter's support; everything where a part of it is beside
    // or behind the camera.
    SampleBox lit_box() const {
        const Rigid camera_from_filter = inverse(filter_from_camera_);
        constexpr int kAlong = 16;
        constexpr double kAround_px = 2.0;
        glm::dvec2 low_px(1e30), high_px(-1e30);
        for (int k = 0; k <= 4 * kAlong; ++k) {
            const double t = 2.0 * (k % kAlong) / kAlong - 1.0;
            const int side = k / kAlong % 4;
            const glm::dvec2 on_outline = side == 0   ? glm::dvec2(t, -1.0)
                                          : side == 1 ? glm::dvec2(1.0, t)
                                          : side == 2 ? glm::dvec2(-t, 1.0)
                                                      : glm::dvec2(-1.0, -t);
            const std::optional<glm::dvec2> seen_px = project_px(
                bench_.camera, apply(camera_from_filter,
                                     glm::dvec3(center_m_ + on_outline * half_support_m_, 0.0)));
            if (!seen_px)
                return {glm::ivec2(0), grid_.count};
            low_px = glm::min(low_px, *seen_px);
            high_px = glm::max(high_px, *seen_px);
        }
        const auto sample_of = [this](glm::dvec2 position_px) {
            const glm::dvec2 at = (position_px + double(grid_.margin_px)) * double(grid_.per_pixel);
            return glm::ivec2(glm::clamp(at, glm::dvec2(0.0), glm::dvec2(grid_.count)));
        };
        return {sample_of(low_px - kAround_px), sample_of(high_px + kAround_px)};
    }

    const Bench& bench_;
    const SampleGrid& grid_;
    glm::dvec2 center_m_, half_support_m_{0.0};
    Rigid filter_from_camera_;
    std::vector<double> open_;  // [color]: at transmission 1 of the profile
    SampleBox box_;
};

}  // namespace

std::vector<float> filter_picture(const Bench& bench,
                                  const Places& places,
                                  std::size_t position_index) {
    // Edges are sharp, as those of boards.
    const SampleGrid samples = make_sample_grid(bench.camera, 2 * bench.accuracy.subsamples);
    const FilterSampler sampler(bench, places, position_index, samples);
    return form_picture(
        bench.camera, samples,
        [&](int row, std::span<float> values) { sampler.sample_row(row, values); }, true);
}

}  // namespace nearfield::sample_data
