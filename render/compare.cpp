// SPDX-License-Identifier: Apache-2.0
#include "render/compare.h"

#include "formats/files/error.h"
#include "formats/shared/tonemap.glsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace nearfield::render {
namespace {

constexpr float kFloor = 1e-3F;  // of the largest, as for relative errors

const Layer& default_layer(const Picture& picture, const char* which) {
    const auto found = std::find_if(
        picture.layers.begin(), picture.layers.end(),
        [](const Layer& layer) { return layer.name.empty() && layer.channels.size() == 3; });
    if (found == picture.layers.end())
        throw Error{"cannot compare pictures", which, "a default layer of R, G, B", "none"};
    return *found;
}

std::vector<float> luminances(const Layer& rgb) {
    std::vector<float> y(rgb.values.size() / 3);
    for (std::size_t k = 0; k < y.size(); ++k)
        y[k] =
            shared::luminance709({rgb.values[3 * k], rgb.values[3 * k + 1], rgb.values[3 * k + 2]});
    return y;
}

}  // namespace

Comparison compare_pictures(Picture& picture, const Picture& reference) {
    const Layer& of_reference = default_layer(reference, "the reference");
    const Layer& of_picture = default_layer(picture, "the picture");
    if (picture.size_px != reference.size_px)
        throw Error{"cannot compare pictures", "size",
                    fmt::format("{} x {} px", picture.size_px.x, picture.size_px.y),
                    fmt::format("{} x {} px", reference.size_px.x, reference.size_px.y)};
    const std::vector<float> y = luminances(of_picture), y_reference = luminances(of_reference);
    Comparison comparison{relative_error(y, y_reference),
                          lab_difference(of_picture.values, of_reference.values)};
    const float floor = y.empty() ? 0.0F : kFloor * *std::ranges::max_element(y_reference);
    Layer error{"error", {"Y"}, std::vector<float>(y.size(), 0.0F)};
    for (std::size_t k = 0; k < y.size(); ++k)
        if (y_reference[k] > floor)
            error.values[k] = y[k] / y_reference[k] - 1.0F;
    picture.layers.push_back(std::move(error));
    return comparison;
}

std::string summary(const Comparison& comparison) {
    const RelativeError& y = comparison.radiance_y;
    return fmt::format(
        "relative RMS of luminance {:.2g} %, median {:.2g} %, 95 % within {:.2g} %, largest {:.2g} "
        "%, bias {:.2g} %, of {} lit pixels; Lab difference {:.2g}",
        100.0 * y.rms, 100.0 * y.p50, 100.0 * y.p95, 100.0 * y.largest, 100.0 * y.bias, y.count,
        comparison.lab);
}

}  // namespace nearfield::render
