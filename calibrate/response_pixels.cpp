// SPDX-License-Identifier: Apache-2.0
#include "calibrate/response_pixels.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace nearfield::calibrate {
namespace {

constexpr int kSmooth = 14;  // most that the neighbors of a chosen pixel differ by

int well_exposed(std::span<const Photograph> photographs, std::size_t first, int channels) {
    int count = 0;
    for (const Photograph& photograph : photographs) {
        bool is_well = true;
        for (int c = 0; c < channels; ++c) {
            const int value = photograph.values[first + static_cast<std::size_t>(c)];
            is_well = is_well && value >= kWellDark && value <= kWellBright;
        }
        count += is_well ? 1 : 0;
    }
    return count;
}

// In the photograph where the pixel is nearest to the middle, by the middle channel.
bool is_smooth(std::span<const Photograph> photographs, std::size_t pixel, int channels) {
    const auto step = static_cast<std::size_t>(channels);
    const auto width = static_cast<std::size_t>(photographs[0].width_px);
    const std::size_t pixels = photographs[0].values.size() / step;
    if (pixel < width + 1 || pixel + width + 1 >= pixels)
        return false;
    const auto off_middle = [&](const Photograph& photograph) {
        return std::abs(int{photograph.values[pixel * step + step / 2]} - kResponseLevels / 2);
    };
    const auto best = std::min_element(
        photographs.begin(), photographs.end(),
        [&](const Photograph& a, const Photograph& b) { return off_middle(a) < off_middle(b); });
    for (std::size_t c = 0; c < step; ++c) {
        int least = kResponseLevels, most = 0;
        for (std::size_t row = 0; row < 3; ++row) {
            for (std::size_t column = 0; column < 3; ++column) {
                const std::size_t near = pixel + row * width + column - width - 1;
                least = std::min<int>(least, best->values[near * step + c]);
                most = std::max<int>(most, best->values[near * step + c]);
            }
        }
        if (most - least > kSmooth)
            return false;
    }
    return true;
}

}  // namespace

ChosenPixels choose_pixels(std::span<const Photograph> photographs,
                           int channels,
                           const std::vector<char>& is_used) {
    const auto step = static_cast<std::size_t>(channels);
    const std::size_t pixels = photographs[0].values.size() / step;
    std::vector<std::pair<int, std::size_t>> usable;  // by the sum of all exposures' values
    for (std::size_t k = 0; k < pixels; ++k) {
        if ((!is_used.empty() && is_used[k] == 0) ||
            well_exposed(photographs, k * step, channels) < static_cast<int>(kLeastExposures) ||
            !is_smooth(photographs, k, channels))
            continue;
        int sum = 0;
        for (const Photograph& photograph : photographs)
            sum += photograph.values[k * step + step / 2];
        usable.emplace_back(sum, k);
    }
    constexpr std::size_t kSets = kCurves + 1;
    constexpr std::size_t kWanted = kSets * kTrainingSide * kTrainingSide;
    if (usable.size() < kWanted)
        throw Error{"cannot recover the response", "bracket",
                    fmt::format("{} smooth pixels well exposed in {} photographs", kWanted,
                                kLeastExposures),
                    fmt::format("{}", usable.size())};
    std::sort(usable.begin(), usable.end());
    ChosenPixels chosen;
    for (std::size_t k = 0; k < kWanted; ++k) {
        const std::size_t pixel = usable[k * (usable.size() - 1) / (kWanted - 1)].second;
        const std::size_t set = k % kSets;
        (set < kCurves ? chosen.training[set] : chosen.held_out).push_back(pixel);
    }
    return chosen;
}

}  // namespace nearfield::calibrate
