// SPDX-License-Identifier: Apache-2.0
#include "fit/blocked_light.h"

#include "formats/files/error.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <cmath>
#include <numeric>

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

}  // namespace

BlockedLight smooth_light(const RectifiedImage& image, glm::ivec2 texels) {
    Eigen::Matrix<double, kTerms, kTerms> normal = Eigen::Matrix<double, kTerms, kTerms>::Zero();
    Terms right = Terms::Zero();
    int known = 0;
    for (std::size_t t = 0; t < image.value.size(); ++t) {
        if (std::isinf(image.variance[t]))
            continue;
        const Terms terms = terms_at(texels, t);
        const double weight = 1.0 / double(image.variance[t]);
        normal += weight * terms * terms.transpose();
        right += weight * double(image.value[t]) * terms;
        ++known;
    }
    const Eigen::LDLT<Eigen::Matrix<double, kTerms, kTerms>> factor(normal);
    if (known < kTerms || factor.info() != Eigen::Success || !factor.isPositive())
        throw Error{"light beside the filter cannot be found", "frames with the filter blocked",
                    "texels that are not saturated", fmt::format("{}", known)};
    const Terms parabola = factor.solve(right);
    BlockedLight light;
    Terms mean_terms = Terms::Zero();
    for (std::size_t t = 0; t < image.value.size(); ++t) {
        const Terms terms = terms_at(texels, t);
        const double value = parabola.dot(terms);
        mean_terms += terms / static_cast<double>(image.value.size());
        light.lux.push_back(static_cast<float>(value));
        const double off = double(image.value[t]) - value;
        if (std::isfinite(image.variance[t]))
            light.chi_square += off * off / double(image.variance[t]);
    }
    light.chi_square /= std::max(1, known - kTerms);
    light.mean_lx = parabola.dot(mean_terms);
    // Where a parabola does not hold it all, sigma is that of what is left.
    light.sigma_lx =
        std::sqrt(std::max(1.0, light.chi_square) * mean_terms.dot(factor.solve(mean_terms)));
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
