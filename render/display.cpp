// SPDX-License-Identifier: Apache-2.0
#include "render/display.h"

#include "formats/files/error.h"
#include "formats/shared/tonemap.glsl.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

// Saturation-based speed, ISO 12232: a surface of luminance 1.2 * 2^EV100 just saturates the
// sensor:
//   H = q t L / N^2 with q = 0.65, H_sat = 78 / 100 lx s, 2^EV100 = N^2 / t   =>   L_sat = 0.78 /
//   0.65 * 2^EV100
constexpr double kSaturation = 1.2;

glm::vec3 pixel(const Layer& rgb, std::size_t index) {
    return {rgb.values[3 * index], rgb.values[3 * index + 1], rgb.values[3 * index + 2]};
}

unsigned char encode(float linear) {
    return static_cast<unsigned char>(
        std::lround(255.0F * shared::srgb_from_linear(std::clamp(linear, 0.0F, 1.0F))));
}

}  // namespace

double white_of(double exposure_ev) {
    return kSaturation * std::exp2(exposure_ev);
}

double automatic_exposure_ev(const Layer& rgb, ToneMap tonemap) {
    std::vector<float> lit;
    double sum = 0.0;
    const std::size_t pixels = rgb.values.size() / 3;
    for (std::size_t i = 0; i < pixels; ++i) {
        const float y = shared::luminance709(pixel(rgb, i));
        sum += static_cast<double>(y);
        if (y > 0.0F)
            lit.push_back(y);
    }
    if (lit.empty())
        return 0.0;
    if (tonemap == ToneMap::Papers)
        return std::log2(sum / static_cast<double>(pixels) / kSaturation);
    const auto rank = lit.begin() + static_cast<std::ptrdiff_t>((lit.size() - 1) * 95 / 100);
    std::nth_element(lit.begin(), rank, lit.end());
    return std::log2(static_cast<double>(*rank) / kSaturation);
}

Display display(const Picture& picture, const DisplayOptions& options) {
    const auto found = std::find_if(
        picture.layers.begin(), picture.layers.end(),
        [](const Layer& layer) { return layer.name.empty() && layer.channels.size() == 3; });
    if (found == picture.layers.end())
        throw Error{"cannot display picture", "default layer", "R, G, B", "none"};
    Display result;
    result.exposure_ev =
        options.exposure_ev.value_or(automatic_exposure_ev(*found, options.tonemap));
    const auto white = static_cast<float>(white_of(result.exposure_ev));
    const std::size_t pixels = found->values.size() / 3;
    result.srgb.reserve(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        const glm::vec3 mapped = options.tonemap == ToneMap::Papers
                                     ? shared::tonemap_papers(pixel(*found, i), white)
                                     : shared::tonemap_filmic(pixel(*found, i) / white);
        for (int c = 0; c < 3; ++c)
            result.srgb.push_back(encode(mapped[c]));
    }
    return result;
}

}  // namespace nearfield::render
