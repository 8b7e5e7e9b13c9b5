// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/optics.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::sample_data {
namespace {

constexpr double kCoreCut = 5.0;  // in sigmas: 6e-7 of the light lie beyond
constexpr int kVeilBlock_px = 8;
constexpr double kVeilCut = 4.0;

std::size_t at(int column, int row, int width) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
}

// Share of a gaussian around 0 that lies below x.
double below(double x, double sigma) {
    return sigma > 0.0 ? 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))) : (x > 0.0 ? 1.0 : 0.0);
}

// What each sample around a pixel adds to it: the first belongs to the sample margin_px pixels
// before the pixel's own first.
std::vector<float> core_weights(const BenchCamera& camera, const SampleGrid& grid) {
    const int count = (2 * grid.margin_px + 1) * grid.per_pixel;
    std::vector<double> weights;
    double sum = 0.0;
    for (int k = 0; k < count; ++k) {
        const double from_middle_px = (k + 0.5) / grid.per_pixel - (grid.margin_px + 0.5);
        weights.push_back(below(from_middle_px + 0.5, camera.psf_sigma_px) -
                          below(from_middle_px - 0.5, camera.psf_sigma_px));
        sum += weights.back();
    }
    std::vector<float> normalized;
    normalized.reserve(weights.size());
    for (const double weight : weights)
        normalized.push_back(static_cast<float>(weight / sum));
    return normalized;
}

// A row of samples to a row of pixels.
void blur_row(std::span<const float> samples,
              std::span<const float> weights,
              int per_pixel,
              std::span<float> pixels) {
    for (std::size_t x = 0; x < pixels.size(); ++x) {
        const float* const first = samples.data() + x * static_cast<std::size_t>(per_pixel);
        float sum = 0.0F;
        for (std::size_t k = 0; k < weights.size(); ++k)
            sum += weights[k] * first[k];
        pixels[x] = sum;
    }
}

template <typename Body>
void for_rows(int count, bool is_parallel, const Body& body) {
    if (is_parallel) {
        tbb::parallel_for(0, count, body);
        return;
    }
    for (int row = 0; row < count; ++row)
        body(row);
}

// Weights of neighboring blocks, from the nearest outwards; they and their mirror sum to 1.
std::vector<float> veil_weights(double sigma_blocks) {
    const int reach = static_cast<int>(std::ceil(kVeilCut * sigma_blocks));
    std::vector<float> weights;
    for (int k = 0; k <= reach; ++k)
        weights.push_back(
            static_cast<float>(below(k + 0.5, sigma_blocks) - below(k - 0.5, sigma_blocks)));
    return weights;
}

// Gaussian blur along x, result transposed: twice is both axes.
std::vector<float> blur_transposed(const std::vector<float>& in,
                                   glm::ivec2 size,
                                   const std::vector<float>& weights) {
    std::vector<float> out(in.size());
    const int reach = static_cast<int>(weights.size()) - 1;
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            float sum = 0.0F;
            for (int k = std::max(0, x - reach); k <= std::min(size.x - 1, x + reach); ++k)
                sum += weights[static_cast<std::size_t>(std::abs(k - x))] * in[at(k, y, size.x)];
            out[at(y, x, size.y)] = sum;
        }
    }
    return out;
}

// Adds the veil to a plane of one color.
void add_veil(const BenchCamera& camera, std::vector<float>& plane) {
    const glm::ivec2 size = camera.size_px;
    const glm::ivec2 blocks = (size + kVeilBlock_px - 1) / kVeilBlock_px;
    std::vector<float> sums(at(0, blocks.y, blocks.x));
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x)
            sums[at(x / kVeilBlock_px, y / kVeilBlock_px, blocks.x)] += plane[at(x, y, size.x)];
    }
    constexpr float kInverseArea = 1.0F / (kVeilBlock_px * kVeilBlock_px);
    const std::vector<float> weights = veil_weights(camera.veil_sigma_px / kVeilBlock_px);
    const std::vector<float> wide =
        blur_transposed(blur_transposed(sums, blocks, weights), {blocks.y, blocks.x}, weights);
    const auto share = static_cast<float>(camera.veil_share);
    const glm::vec2 last = glm::vec2(blocks - 1);
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
            const glm::vec2 block = glm::clamp(
                (glm::vec2(x, y) + 0.5F) / float(kVeilBlock_px) - 0.5F, glm::vec2(0.0F), last);
            const glm::ivec2 low = glm::min(glm::ivec2(block), glm::max(blocks - 2, 0));
            const glm::ivec2 high = glm::min(low + 1, blocks - 1);
            const glm::vec2 part = block - glm::vec2(low);
            const float top = glm::mix(wide[at(low.x, low.y, blocks.x)],
                                       wide[at(high.x, low.y, blocks.x)], part.x);
            const float bottom = glm::mix(wide[at(low.x, high.y, blocks.x)],
                                          wide[at(high.x, high.y, blocks.x)], part.x);
            float& pixel = plane[at(x, y, size.x)];
            pixel += share * (kInverseArea * glm::mix(top, bottom, part.y) - pixel);
        }
    }
}

// Screen coordinates and viewing cosine of a ray; none where it misses the plane.
std::optional<glm::dvec3> on_screen(const Rigid& screen_from_camera, glm::dvec3 ray_of_camera) {
    const glm::dvec3 ray = screen_from_camera.rotation * glm::normalize(ray_of_camera);
    const std::optional<double> t = meet_plane(screen_from_camera.translation_m, ray);
    if (!t || *t <= 0.0)
        return std::nullopt;
    const glm::dvec3 point = screen_from_camera.translation_m + *t * ray;
    return glm::dvec3(point.x, point.y, std::abs(ray.z));
}

}  // namespace

SampleGrid make_sample_grid(const BenchCamera& camera, int per_pixel) {
    SampleGrid grid;
    grid.per_pixel = per_pixel;
    grid.margin_px = static_cast<int>(std::ceil(kCoreCut * camera.psf_sigma_px));
    grid.count = (camera.size_px + 2 * grid.margin_px) * per_pixel;
    return grid;
}

SampleRays sample_rays(const BenchCamera& camera, const SampleGrid& grid) {
    SampleRays rays;
    rays.width = static_cast<std::size_t>(grid.count.x) + 1;
    rays.tangent.resize(rays.index(0, grid.count.y + 1));
    rays.vignetting.resize(rays.tangent.size());
    tbb::parallel_for(0, grid.count.y + 1, [&](int row) {
        for (int column = 0; column <= grid.count.x; ++column) {
            const glm::dvec2 position_px = grid.position_px(column, row);
            const std::size_t k = rays.index(column, row);
            rays.tangent[k] = glm::dvec2(ray_camera(camera, position_px));
            rays.vignetting[k] =
                static_cast<float>(vignetting(camera, position_px, rays.tangent[k]));
        }
    });
    return rays;
}

int color_count(const BenchCamera& camera) {
    return camera.mosaic == Mosaic::Mono ? 1 : 3;
}

int pixel_color(const BenchCamera& camera, int x, int y) {
    return camera.mosaic == Mosaic::Mono ? 0 : x % 2 + y % 2;
}

std::vector<float> form_picture(const BenchCamera& camera,
                                const SampleGrid& grid,
                                const SampleRow& sample_row,
                                bool is_parallel) {
    const int colors = color_count(camera);
    const glm::ivec2 size = camera.size_px;
    const auto width = static_cast<std::size_t>(size.x);
    const auto columns = static_cast<std::size_t>(grid.count.x);
    const std::vector<float> weights = core_weights(camera, grid);
    // Blurred along x: [color][sample row][pixel column].
    const std::size_t plane_size = static_cast<std::size_t>(grid.count.y) * width;
    std::vector<float> rows(static_cast<std::size_t>(colors) * plane_size);
    for_rows(grid.count.y, is_parallel, [&](int row) {
        std::vector<float> samples(static_cast<std::size_t>(colors) * columns);
        sample_row(row, samples);
        for (std::size_t p = 0; p < static_cast<std::size_t>(colors); ++p)
            blur_row({&samples[p * columns], columns}, weights, grid.per_pixel,
                     {&rows[p * plane_size + at(0, row, size.x)], width});
    });
    std::vector<float> picture(at(0, size.y, size.x));
    std::vector<float> plane(picture.size());
    for (int p = 0; p < colors; ++p) {
        const float* const from = &rows[static_cast<std::size_t>(p) * plane_size];
        for_rows(size.y, is_parallel, [&](int y) {
            float* const to = &plane[at(0, y, size.x)];
            std::fill(to, to + width, 0.0F);
            for (std::size_t k = 0; k < weights.size(); ++k) {
                const float* const line =
                    from + at(0, y * grid.per_pixel + static_cast<int>(k), size.x);
                for (std::size_t x = 0; x < width; ++x)
                    to[x] += weights[k] * line[x];
            }
        });
        if (camera.veil_share > 0.0)
            add_veil(camera, plane);
        for (int y = 0; y < size.y; ++y) {
            for (int x = 0; x < size.x; ++x) {
                if (pixel_color(camera, x, y) == p)
                    picture[at(x, y, size.x)] = plane[at(x, y, size.x)];
            }
        }
    }
    return picture;
}

ScreenGrid make_screen_grid(const Bench& bench, const Places& places, const SampleGrid& samples) {
    const Rigid screen_from_camera =
        inverse(places.bench_from_screen) * bench.camera.bench_from_camera;
    glm::dvec2 lower(1e30), upper(-1e30);
    const auto include = [&](glm::dvec2 position_px) {
        const std::optional<glm::dvec3> seen =
            on_screen(screen_from_camera, ray_camera(bench.camera, position_px));
        // A ray that misses the plane: all of the screen may be seen beside it.
        lower = glm::min(lower, seen ? glm::dvec2(*seen) : bench.screen.min_m);
        upper = glm::max(upper, seen ? glm::dvec2(*seen) : bench.screen.max_m);
    };
    // Positions along the picture's border, and some inside.
    constexpr int kAlong = 32;
    const glm::dvec2 first = samples.position_px(0, 0);
    const glm::dvec2 extent = samples.position_px(samples.count.x - 1, samples.count.y - 1) - first;
    for (int row = 0; row <= kAlong; ++row) {
        for (int column = 0; column <= kAlong; ++column)
            include(first + extent * glm::dvec2(column, row) / double(kAlong));
    }
    lower = glm::max(lower, bench.screen.min_m);
    upper = glm::min(upper, bench.screen.max_m);
    const glm::dvec2 center_px = 0.5 * glm::dvec2(bench.camera.size_px);
    const auto seen_at = [&](glm::dvec2 from_center_px) {
        return on_screen(screen_from_camera, ray_camera(bench.camera, center_px + from_center_px));
    };
    const auto center = seen_at({0.0, 0.0}), right = seen_at({1.0, 0.0}),
               down = seen_at({0.0, 1.0});
    if (!(lower.x < upper.x && lower.y < upper.y) || !center || !right || !down)
        throw Error("the camera does not see the screen", "camera.bench_from_camera",
                    "a picture whose middle shows the screen");
    const glm::dvec2 a = glm::dvec2(*right) - glm::dvec2(*center);
    const glm::dvec2 b = glm::dvec2(*down) - glm::dvec2(*center);
    const double pixel_m = std::sqrt(std::abs(a.x * b.y - a.y * b.x));
    ScreenGrid grid;
    grid.step_m = glm::dvec2(bench.accuracy.screen_step_px * pixel_m);
    grid.min_m = lower - grid.step_m;
    grid.count = glm::ivec2(glm::ceil((upper - lower) / grid.step_m)) + 3;
    constexpr double kMostPoints = 1 << 24;
    if (static_cast<double>(grid.count.x) * grid.count.y > kMostPoints)
        throw Error("too many points on the screen", "accuracy.screen_step_px",
                    "at most 2^24 points", fmt::format("{} x {}", grid.count.x, grid.count.y));
    return grid;
}

std::vector<ScreenSample> screen_samples(const Bench& bench,
                                         const Places& places,
                                         const SampleGrid& samples,
                                         const SampleRays& rays,
                                         const ScreenGrid& grid) {
    const Rigid screen_from_camera =
        inverse(places.bench_from_screen) * bench.camera.bench_from_camera;
    const BenchScreen& screen = bench.screen;
    std::vector<ScreenSample> result(at(0, samples.count.y, samples.count.x));
    tbb::parallel_for(0, samples.count.y, [&](int row) {
        for (int column = 0; column < samples.count.x; ++column) {
            const auto seen = on_screen(screen_from_camera, rays.ray(column, row));
            if (!seen)
                continue;
            const glm::dvec2 s_m(*seen);
            if (s_m.x < screen.min_m.x || s_m.y < screen.min_m.y || s_m.x > screen.max_m.x ||
                s_m.y > screen.max_m.y)
                continue;
            const double lobe = 1.0 - screen.lobe_share +
                                screen.lobe_share * std::pow(seen->z, screen.lobe_exponent);
            const glm::dvec2 index = (s_m - grid.min_m) / grid.step_m;
            result[at(column, row, samples.count.x)] = {
                static_cast<float>(index.x), static_cast<float>(index.y),
                rays.vignetting[rays.index(column, row)] *
                    static_cast<float>(lobe / glm::pi<double>())};
        }
    });
    return result;
}

float interpolated(std::span<const float> values, glm::ivec2 count, float x, float y) {
    const auto weights = [](float t) {
        return std::array<float, 4>{t * (-0.5F + t * (1.0F - 0.5F * t)),
                                    1.0F + t * t * (1.5F * t - 2.5F),
                                    t * (0.5F + t * (2.0F - 1.5F * t)), t * t * (0.5F * t - 0.5F)};
    };
    const int column = std::clamp(static_cast<int>(x), 0, count.x - 1);
    const int row = std::clamp(static_cast<int>(y), 0, count.y - 1);
    const std::array<float, 4> wx = weights(x - static_cast<float>(column));
    const std::array<float, 4> wy = weights(y - static_cast<float>(row));
    float sum = 0.0F;
    for (int j = 0; j < 4; ++j) {
        const int from_row = std::clamp(row + j - 1, 0, count.y - 1);
        float line = 0.0F;
        for (int i = 0; i < 4; ++i)
            line += wx[static_cast<std::size_t>(i)] *
                    values[at(std::clamp(column + i - 1, 0, count.x - 1), from_row, count.x)];
        sum += wy[static_cast<std::size_t>(j)] * line;
    }
    return sum;
}

}  // namespace nearfield::sample_data
