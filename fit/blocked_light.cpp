// SPDX-License-Identifier: Apache-2.0
#include "fit/blocked_light.h"

#include "formats/files/error.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

constexpr int kTerms = 6;
using Terms = Eigen::Matrix<double, kTerms, 1>;

// 1, x, y, x^2, xy, y^2 on -1 ... 1.
Terms terms_at(glm::ivec2 texels, std::size_t t) {
    const auto width = static_cast<std::size_t>(texels.x);
    const std::size_t column = t % width, row = t / width;
    const double x = (2.0 * static_cast<double>(column) + 1.0) / texels.x - 1.0;
    const double y = (2.0 * static_cast<double>(row) + 1.0) / texels.y - 1.0;
    return Terms{1.0, x, y, x * x, x * y, y * y};
}

struct Parabola {
    Terms at = Terms::Zero();
    Eigen::LDLT<Eigen::Matrix<double, kTerms, kTerms>> factor;  // of its normal equations
};

Parabola fit_parabola(const RectifiedImage& image,
                      glm::ivec2 texels,
                      const std::vector<double>& trust) {
    Eigen::Matrix<double, kTerms, kTerms> normal = Eigen::Matrix<double, kTerms, kTerms>::Zero();
    Terms right = Terms::Zero();
    int known = 0;
    for (std::size_t t = 0; t < image.value.size(); ++t) {
        if (!(trust[t] > 0.0))
            continue;
        const Terms terms = terms_at(texels, t);
        const double weight = trust[t] / double(image.variance[t]);
        normal += weight * terms * terms.transpose();
        right += weight * double(image.value[t]) * terms;
        ++known;
    }
    Parabola parabola;
    parabola.factor.compute(normal);
    if (known < kTerms || parabola.factor.info() != Eigen::Success || !parabola.factor.isPositive())
        throw Error{"light beside the filter cannot be found", "frames with the filter blocked",
                    "texels that are not saturated", fmt::format("{}", known)};
    parabola.at = parabola.factor.solve(right);
    return parabola;
}

// In sigmas; infinite where nothing is known.
std::vector<double> standardized_residuals(const RectifiedImage& image,
                                           glm::ivec2 texels,
                                           const Parabola& parabola) {
    std::vector<double> residuals;
    for (std::size_t t = 0; t < image.value.size(); ++t) {
        const double off = double(image.value[t]) - parabola.at.dot(terms_at(texels, t));
        residuals.push_back(std::isinf(image.variance[t])
                                ? std::numeric_limits<double>::infinity()
                                : off / std::sqrt(double(image.variance[t])));
    }
    return residuals;
}

double median_size(const std::vector<double>& residuals) {
    std::vector<double> sizes;
    for (const double residual : residuals)
        if (std::isfinite(residual))
            sizes.push_back(std::abs(residual));
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle;
}

// Tukey's biweights (Beaton and Tukey 1974): texels beside the screen show no light at all, and
// squares would bend the parabola towards them.
std::vector<double> biweights(const std::vector<double>& residuals) {
    constexpr double kEnd = 4.685;  // 95 % as good as squares where all is gaussian
    constexpr double kSigmaOfMedian = 1.4826;
    const double scale = kEnd * std::max(1.0, kSigmaOfMedian * median_size(residuals));
    std::vector<double> weights;
    for (const double residual : residuals) {
        const double x = std::min(1.0, std::abs(residual) / scale);
        weights.push_back((1 - x * x) * (1 - x * x));
    }
    return weights;
}

}  // namespace

BlockedLight smooth_light(const RectifiedImage& image, glm::ivec2 texels) {
    std::vector<double> trust(image.value.size());
    for (std::size_t t = 0; t < trust.size(); ++t)
        trust[t] = std::isinf(image.variance[t]) ? 0.0 : 1.0;
    constexpr int kRounds = 20;
    Parabola parabola = fit_parabola(image, texels, trust);
    for (int round = 0; round < kRounds; ++round) {
        trust = biweights(standardized_residuals(image, texels, parabola));
        parabola = fit_parabola(image, texels, trust);
    }
    BlockedLight light;
    double trusted = 0;
    Terms mean_terms = Terms::Zero();
    const std::vector<double> residuals = standardized_residuals(image, texels, parabola);
    for (std::size_t t = 0; t < image.value.size(); ++t) {
        const Terms terms = terms_at(texels, t);
        mean_terms += terms / static_cast<double>(image.value.size());
        light.lux.push_back(static_cast<float>(parabola.at.dot(terms)));
        if (trust[t] > 0.0) {
            light.chi_square += trust[t] * residuals[t] * residuals[t];
            trusted += trust[t];
        }
    }
    light.chi_square /= std::max(1.0, trusted - kTerms);
    light.mean_lx = parabola.at.dot(mean_terms);
    // Where a parabola does not hold it all, sigma is that of what is left.
    light.sigma_lx = std::sqrt(std::max(1.0, light.chi_square) *
                               mean_terms.dot(parabola.factor.solve(mean_terms)));
    return light;
}

std::vector<BlockedLight> blocked_light(const Measurement& measurement,
                                        const LampDrift& drift,
                                        const Rectifier& rectifier,
                                        glm::ivec2 texels) {
    const PositionFrames frames = blocked_frames(measurement.capture);
    std::vector<BlockedLight> channels;
    if (frames.frames.empty())
        return channels;
    for (const RectifiedImage& image :
         rectifier.rectified(position_light(measurement, frames, drift)))
        channels.push_back(smooth_light(image, texels));
    return channels;
}

}  // namespace nearfield::fit
