// SPDX-License-Identifier: Apache-2.0
#include "calibrate/response.h"

#include "calibrate/response_pixels.h"
#include "formats/files/error.h"

#include <fmt/format.h>
#include <opencv2/photo.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::calibrate {
namespace {

constexpr float kSmoothness = 10.0F;  // Debevec and Malik's lambda

// Light per value of one channel as OpenCV finds it from the training pixels: one small picture.
std::vector<std::vector<double>> debevec(std::span<const Photograph> photographs,
                                         int channels,
                                         const std::vector<std::size_t>& training) {
    std::vector<cv::Mat> pictures;
    std::vector<float> times;
    for (const Photograph& photograph : photographs) {
        cv::Mat picture(kTrainingSide, kTrainingSide, CV_8UC(channels));
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
    cv::createCalibrateDebevec(kTrainingSide * kTrainingSide, kSmoothness, false)
        ->process(pictures, response, times);
    std::vector<std::vector<double>> light(static_cast<std::size_t>(channels));
    for (int c = 0; c < channels; ++c) {
        for (int value = 0; value < kResponseLevels; ++value)
            light[static_cast<std::size_t>(c)].push_back(response.ptr<float>(value)[c]);
    }
    return light;
}

// The curves' mean: their logarithms', as that is what noise is even in.
std::vector<std::vector<double>> mean_curve(std::span<const Photograph> photographs,
                                            int channels,
                                            const ChosenPixels& chosen) {
    std::vector<std::vector<double>> mean(static_cast<std::size_t>(channels),
                                          std::vector<double>(kResponseLevels));
    for (const std::vector<std::size_t>& training : chosen.training) {
        const auto curves = debevec(photographs, channels, training);
        for (std::size_t c = 0; c < mean.size(); ++c) {
            for (std::size_t value = 0; value < mean[c].size(); ++value)
                mean[c][value] +=
                    std::log(std::max(curves[c][value], 1e-12)) / static_cast<double>(kCurves);
        }
    }
    return mean;
}

// Pools neighbors that go down (Ayer et al. 1955).
void make_monotone(std::vector<double>& logarithms) {
    struct Pool {
        double sum = 0;
        std::size_t count = 0;
        double mean() const { return sum / static_cast<double>(count); }
    };
    std::vector<Pool> pools;
    for (const double value : logarithms) {
        pools.push_back({value, 1});
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
            logarithms[at++] = pool.mean();
    }
}

rig::Curve curve_of(const std::vector<double>& logarithms) {
    constexpr std::size_t kEqualAt = 128;
    rig::Curve curve;
    for (std::size_t value = 0; value < logarithms.size(); ++value) {
        curve.x.push_back(static_cast<double>(value));
        curve.y.push_back(std::exp(logarithms[value] - logarithms[kEqualAt]) * double(kEqualAt));
    }
    return curve;
}

// Scatter of two neighboring exposures' light of the same pixel, by the lower one's value.
std::array<double, 256> held_out_sigma(std::span<const Photograph> photographs,
                                       int channels,
                                       int channel,
                                       const rig::Curve& curve,
                                       const std::vector<std::size_t>& pixels) {
    std::array<double, kResponseLevels> squares{}, counts{};
    for (const std::size_t pixel : pixels) {
        const std::size_t k =
            pixel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
        for (std::size_t e = 0; e + 1 < photographs.size(); ++e) {
            const std::size_t a = photographs[e].values[k], b = photographs[e + 1].values[k];
            if (a < kWellDark || b < kWellDark || a > kWellBright || b > kWellBright)
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
    std::array<double, kResponseLevels> sigma{};
    constexpr int kReach = 4;
    for (int value = 0; value < kResponseLevels; ++value) {
        double sum = 0, count = 0;
        for (int k = std::max(0, value - kReach);
             k <= std::min(kResponseLevels - 1, value + kReach); ++k) {
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
    response.pixels = static_cast<int>(kCurves * chosen.training[0].size());
    response.held_out = static_cast<int>(chosen.held_out.size());
    for (std::vector<double>& logarithms : mean_curve(photographs, channels, chosen)) {
        make_monotone(logarithms);
        response.linear.push_back(curve_of(logarithms));
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
            if (value <= kWellDark || value >= kWellBright)
                continue;
            const double weight = std::min(value - kWellDark, kWellBright - value);
            sum +=
                weight * std::log(curve.y[static_cast<std::size_t>(value)] / photograph.exposure_s);
            weights += weight;
        }
        light[k] = weights > 0.0 ? static_cast<float>(std::exp(sum / weights)) : 0.0F;
    }
    return light;
}

}  // namespace nearfield::calibrate
