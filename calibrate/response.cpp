// SPDX-License-Identifier: Apache-2.0
#include "calibrate/response.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <opencv2/photo.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::calibrate {
namespace {

constexpr int kLevels = 256;
constexpr int kDark = 10, kBright = 245;  // well exposed lies between
constexpr std::size_t kLeastExposures = 3;
constexpr int kSide = 18;  // training pixels: kSide^2, enough that 255 unknowns are outnumbered
constexpr float kSmoothness = 10.0F;  // Debevec and Malik's lambda

// Pixels that are well exposed in three photographs or more in all channels, spread over how
// bright they are; every second one is for training.
struct ChosenPixels {
    std::vector<std::size_t> training, held_out;
};

int well_exposed(std::span<const Photograph> photographs, std::size_t first, int channels) {
    int count = 0;
    for (const Photograph& photograph : photographs) {
        bool is_well = true;
        for (int c = 0; c < channels; ++c) {
            const int value = photograph.values[first + static_cast<std::size_t>(c)];
            is_well = is_well && value >= kDark && value <= kBright;
        }
        count += is_well ? 1 : 0;
    }
    return count;
}

ChosenPixels choose_pixels(std::span<const Photograph> photographs,
                           int channels,
                           const std::vector<char>& is_used) {
    const auto step = static_cast<std::size_t>(channels);
    const std::size_t pixels = photographs[0].values.size() / step;
    std::vector<std::pair<int, std::size_t>> usable;  // by the sum of all exposures' values
    for (std::size_t k = 0; k < pixels; ++k) {
        if ((!is_used.empty() && is_used[k] == 0) ||
            well_exposed(photographs, k * step, channels) < static_cast<int>(kLeastExposures))
            continue;
        int sum = 0;
        for (const Photograph& photograph : photographs)
            sum += photograph.values[k * step + step / 2];
        usable.emplace_back(sum, k);
    }
    constexpr std::size_t kWanted = 2 * kSide * kSide;
    if (usable.size() < kWanted)
        throw Error{
            "cannot recover the response", "bracket",
            fmt::format("{} pixels well exposed in {} photographs", kWanted, kLeastExposures),
            fmt::format("{}", usable.size())};
    std::sort(usable.begin(), usable.end());
    ChosenPixels chosen;
    for (std::size_t k = 0; k < kWanted; ++k) {
        const std::size_t pixel = usable[k * (usable.size() - 1) / (kWanted - 1)].second;
        (k % 2 == 0 ? chosen.training : chosen.held_out).push_back(pixel);
    }
    return chosen;
}

// Light per value of one channel as OpenCV finds it from the training pixels: one small picture.
std::vector<std::vector<double>> debevec(std::span<const Photograph> photographs,
                                         int channels,
                                         const std::vector<std::size_t>& training) {
    std::vector<cv::Mat> pictures;
    std::vector<float> times;
    for (const Photograph& photograph : photographs) {
        cv::Mat picture(kSide, kSide, CV_8UC(channels));
        for (std::size_t k = 0; k < training.size(); ++k) {
            for (int c = 0; c < channels; ++c)
                picture.data[k * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] =
                    photograph.values[training[k] * static_cast<std::size_t>(channels) +
                                      static_cast<std::size_t>(c)];
        }
        pictures.push_back(picture);
        times.push_back(static_cast<float>(photograph.exposure_s));
    }
    cv::Mat response;
    cv::createCalibrateDebevec(kSide * kSide, kSmoothness, false)
        ->process(pictures, response, times);
    std::vector<std::vector<double>> light(static_cast<std::size_t>(channels));
    for (int c = 0; c < channels; ++c) {
        for (int value = 0; value < kLevels; ++value)
            light[static_cast<std::size_t>(c)].push_back(response.ptr<float>(value)[c]);
    }
    return light;
}

// Pools neighbors that go down (Ayer et al. 1955), on the logarithm.
void make_monotone(std::vector<double>& light) {
    struct Pool {
        double sum = 0;
        std::size_t count = 0;
        double mean() const { return sum / static_cast<double>(count); }
    };
    std::vector<Pool> pools;
    for (const double value : light) {
        pools.push_back({std::log(std::max(value, 1e-12)), 1});
        while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
            const Pool last = pools.back();
            pools.pop_back();
            pools.back().sum += last.sum;
            pools.back().count += last.count;
        }
    }
    std::size_t at = 0;
    for (const Pool& pool : pools) {
        for (std::size_t k = 0; k < pool.count; ++k)
            light[at++] = std::exp(pool.mean());
    }
}

rig::Curve curve_of(const std::vector<double>& light) {
    constexpr std::size_t kEqualAt = 128;
    rig::Curve curve;
    for (std::size_t value = 0; value < light.size(); ++value) {
        curve.x.push_back(static_cast<double>(value));
        curve.y.push_back(light[value] / light[kEqualAt] * double(kEqualAt));
    }
    return curve;
}

// Scatter of two neighboring exposures' light of the same pixel, by the lower one's value.
std::array<double, 256> held_out_sigma(std::span<const Photograph> photographs,
                                       int channels,
                                       int channel,
                                       const rig::Curve& curve,
                                       const std::vector<std::size_t>& pixels) {
    std::array<double, kLevels> squares{}, counts{};
    for (const std::size_t pixel : pixels) {
        const std::size_t k =
            pixel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
        for (std::size_t e = 0; e + 1 < photographs.size(); ++e) {
            const std::size_t a = photographs[e].values[k], b = photographs[e + 1].values[k];
            if (a < kDark || b < kDark || a > kBright || b > kBright)
                continue;
            const double off = std::log(curve.y[b] / photographs[e + 1].exposure_s) -
                               std::log(curve.y[a] / photographs[e].exposure_s);
            for (const std::size_t value : {a, b}) {
                squares[value] += 0.5 * off * off;  // both err alike
                counts[value] += 1.0;
            }
        }
    }
    // Over nine values: single ones are seen too rarely.
    std::array<double, kLevels> sigma{};
    constexpr int kReach = 4;
    for (int value = 0; value < kLevels; ++value) {
        double sum = 0, count = 0;
        for (int k = std::max(0, value - kReach); k <= std::min(kLevels - 1, value + kReach); ++k) {
            sum += squares[static_cast<std::size_t>(k)];
            count += counts[static_cast<std::size_t>(k)];
        }
        sigma[static_cast<std::size_t>(value)] = count > 0.0 ? std::sqrt(sum / count) : 0.0;
    }
    return sigma;
}

void require_bracket(std::span<const Photograph> photographs) {
    if (photographs.size() < kLeastExposures)
        throw Error{"cannot recover the response", "bracket", "3 photographs or more",
                    fmt::format("{}", photographs.size())};
    for (const Photograph& photograph : photographs) {
        if (photograph.values.size() != photographs[0].values.size())
            throw Error{"cannot recover the response", "bracket", "photographs of one size", ""};
        if (!(photograph.exposure_s > 0.0))
            throw Error{"cannot recover the response", "bracket", "exposure times",
                        fmt::format("{} s", photograph.exposure_s)};
    }
}

}  // namespace

ResponseCurve recover_response(std::span<const Photograph> photographs,
                               int channels,
                               const std::vector<char>& is_used) {
    require_bracket(photographs);
    const ChosenPixels chosen = choose_pixels(photographs, channels, is_used);
    ResponseCurve response;
    response.pixels = static_cast<int>(chosen.training.size());
    response.held_out = static_cast<int>(chosen.held_out.size());
    for (std::vector<double>& light : debevec(photographs, channels, chosen.training)) {
        make_monotone(light);
        response.linear.push_back(curve_of(light));
        response.sigma_rel.push_back(held_out_sigma(photographs, channels,
                                                    static_cast<int>(response.linear.size()) - 1,
                                                    response.linear.back(), chosen.held_out));
    }
    return response;
}

std::vector<float> merged(std::span<const Photograph> photographs,
                          int channels,
                          const ResponseCurve& response) {
    std::vector<float> light(photographs[0].values.size());
    for (std::size_t k = 0; k < light.size(); ++k) {
        const rig::Curve& curve = response.linear[k % static_cast<std::size_t>(channels)];
        double sum = 0, weights = 0;
        for (const Photograph& photograph : photographs) {
            const int value = photograph.values[k];
            if (value < kDark || value > kBright)
                continue;
            const double weight = std::min(value, kLevels - 1 - value) * photograph.exposure_s;
            sum += weight * curve.y[static_cast<std::size_t>(value)] / photograph.exposure_s;
            weights += weight;
        }
        light[k] = weights > 0.0 ? static_cast<float>(sum / weights) : 0.0F;
    }
    return light;
}

}  // namespace nearfield::calibrate
