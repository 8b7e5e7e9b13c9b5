// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/develop.h"

#include "formats/shared/tonemap.glsl.h"
#include "render/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::viewer {
namespace {

constexpr double kLeastError = 1e-3, kMostError = 1.0;  // ends of the errors' scale

double luminance_at(const std::vector<float>& rgb, std::size_t k) {
    return static_cast<double>(shared::luminance709({rgb[3 * k], rgb[3 * k + 1], rgb[3 * k + 2]}));
}

void set(std::vector<unsigned char>& rgba, std::size_t k, glm::u8vec3 color) {
    for (std::size_t c = 0; c < 3; ++c)
        rgba[4 * k + c] = color[static_cast<int>(c)];
    rgba[4 * k + 3] = 255;
}

Developed tone_mapped(const Mixed& mixed, const render::DisplayOptions& options) {
    Picture picture{mixed.size_px, {{"", {"R", "G", "B"}, mixed.radiance}}, {}};
    const render::Display display = render::display(picture, options);
    Developed developed{mixed.size_px, std::vector<unsigned char>(4 * (display.srgb.size() / 3)),
                        display.exposure_ev};
    for (std::size_t k = 0; 3 * k < display.srgb.size(); ++k)
        set(developed.rgba, k,
            {display.srgb[3 * k], display.srgb[3 * k + 1], display.srgb[3 * k + 2]});
    return developed;
}

template <typename Value>
Developed in_false_colors(const Frame& frame, double least, double most, const Value& value) {
    const std::size_t pixels = frame.depth_m.size();
    Developed developed{frame.size_px, std::vector<unsigned char>(4 * pixels), 0.0};
    for (std::size_t k = 0; k < pixels; ++k)
        set(developed.rgba, k,
            frame.depth_m[k] > 0.0F ? scale_color(scale_position(value(k), least, most))
                                    : glm::u8vec3(0));
    return developed;
}

/// Lines where light passes a level between a pixel and the next one right or below.
void draw_isolux(const Frame& frame, const Mixed& mixed, const Look& look, Developed& developed) {
    const auto width = static_cast<std::size_t>(frame.size_px.x);
    const std::size_t pixels = frame.depth_m.size();
    const auto level_of = [&](std::size_t k) {
        const double lux = luminance_at(mixed.irradiance, k);
        return std::count_if(look.isolux.begin(), look.isolux.end(),
                             [&](double level) { return level <= lux; });
    };
    std::vector<std::ptrdiff_t> levels(pixels);
    for (std::size_t k = 0; k < pixels; ++k)
        levels[k] = frame.depth_m[k] > 0.0F ? level_of(k) : 0;
    for (std::size_t k = 0; k + width < pixels; ++k) {
        const bool is_last = (k + 1) % width == 0;
        if (levels[k] != levels[k + width] || (!is_last && levels[k] != levels[k + 1]))
            set(developed.rgba, k,
                look.shown == Shown::Picture ? glm::u8vec3(90, 220, 255) : glm::u8vec3(0));
    }
}

}  // namespace

bool Look::operator==(const Look& other) const {
    return shown == other.shown && display.tonemap == other.display.tonemap &&
           display.exposure_ev == other.display.exposure_ev && least_lux == other.least_lux &&
           most_lux == other.most_lux && has_isolux == other.has_isolux && isolux == other.isolux;
}

glm::u8vec3 scale_color(double position) {
    static const std::array<glm::vec3, 7> stops = {{{12, 10, 60},
                                                    {30, 70, 200},
                                                    {20, 180, 200},
                                                    {70, 200, 70},
                                                    {240, 220, 50},
                                                    {230, 60, 30},
                                                    {255, 240, 240}}};
    const double at = std::clamp(position, 0.0, 1.0) * (stops.size() - 1);
    const auto stop = std::min(static_cast<std::size_t>(at), stops.size() - 2);
    const auto share = static_cast<float>(at - static_cast<double>(stop));
    return glm::u8vec3(glm::mix(stops[stop], stops[stop + 1], share) + 0.5F);
}

double scale_position(double value, double least, double most) {
    if (!(value > 0.0))
        return 0.0;
    return std::clamp(std::log(value / least) / std::log(most / least), 0.0, 1.0);
}

Developed develop(const Frame& frame, const Mixed& mixed, const Look& look) {
    Developed developed;
    if (look.shown == Shown::Picture)
        developed = tone_mapped(mixed, look.display);
    else if (look.shown == Shown::Lux)
        developed = in_false_colors(frame, look.least_lux, look.most_lux, [&](std::size_t k) {
            return luminance_at(mixed.irradiance, k);
        });
    else
        developed = in_false_colors(frame, kLeastError, kMostError, [&](std::size_t k) {
            const double y = luminance_at(mixed.radiance, k);
            return y > 0.0 ? static_cast<double>(mixed.sigma[k] + mixed.bias[k]) / y : 0.0;
        });
    if (look.has_isolux)
        draw_isolux(frame, mixed, look, developed);
    return developed;
}

Developed beside(const Developed& left, const Developed& right, double split) {
    Developed both = right;
    const auto at_px = static_cast<int>(split * right.size_px.x);
    for (int y = 0; y < both.size_px.y; ++y)
        for (int x = 0; x <= std::min(at_px, both.size_px.x - 1); ++x) {
            const glm::ivec2 from = glm::ivec2(x, y) * left.size_px / both.size_px;
            const auto other = static_cast<std::size_t>(from.y * left.size_px.x + from.x);
            set(both.rgba, static_cast<std::size_t>(y * both.size_px.x + x),
                x == at_px ? glm::u8vec3(255)
                           : glm::u8vec3(left.rgba[4 * other], left.rgba[4 * other + 1],
                                         left.rgba[4 * other + 2]));
        }
    return both;
}

Difference difference_of(const Mixed& a, const Mixed& b) {
    Difference difference;
    difference.lab = render::lab_difference(a.radiance, b.radiance);
    const std::size_t pixels = b.radiance.size() / 3;
    std::vector<float> y(pixels), reference_y(pixels);
    for (std::size_t k = 0; k < pixels; ++k) {
        y[k] = static_cast<float>(luminance_at(a.radiance, k));
        reference_y[k] = static_cast<float>(luminance_at(b.radiance, k));
    }
    const render::RelativeError error = render::relative_error(y, reference_y);
    difference.rms_rel = error.rms;
    difference.p95_rel = error.p95;
    difference.map = {b.size_px, std::vector<unsigned char>(4 * pixels), 0.0};
    for (std::size_t k = 0; k < pixels; ++k) {
        const double relative = reference_y[k] > 0.0F
                                    ? std::abs(static_cast<double>(y[k] / reference_y[k]) - 1.0)
                                    : 0.0;
        set(difference.map.rgba, k, scale_color(scale_position(relative, kLeastError, kMostError)));
    }
    return difference;
}

}  // namespace nearfield::viewer
