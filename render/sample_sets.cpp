// SPDX-License-Identifier: Apache-2.0
#include "render/sample_sets.h"

#include "formats/shared/rng.glsl.h"

#include <algorithm>

namespace nearfield::render {
namespace {

double luminance_y(glm::dvec3 rgb) {
    return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

SetSums total_of(std::span<const SetSums> sets) {
    SetSums total;
    for (const SetSums& set : sets) {
        total.count += set.count;
        total.visible += set.visible;
        total.lit += set.lit;
        total.all += set.all;
        total.reflected += set.reflected;
        total.all_reflected += set.all_reflected;
    }
    return total;
}

/// Of a mean of independent sets' values, from each set's deviation, already over the whole.
template <typename Deviation>
double variance_y(std::span<const SetSums> sets, const Deviation& deviation) {
    if (sets.size() < 2)
        return 0.0;
    double squares = 0.0;
    for (const SetSums& set : sets) {
        const double y = luminance_y(deviation(set));
        squares += y * y;
    }
    const auto count = static_cast<double>(sets.size());
    return count / (count - 1.0) * squares;
}

/// A ratio of sums, channel by channel.
struct Ratio {
    glm::dvec3 value{0.0}, per_bottom{0.0};

    /// To first order, of the part that one set has in it.
    glm::dvec3 deviation(glm::dvec3 top, glm::dvec3 bottom) const {
        return (top - value * bottom) * per_bottom;
    }
};

Ratio ratio(glm::dvec3 top, glm::dvec3 bottom, const SetSums& total) {
    // A channel in which no sample carries light: take the samples as they fell.
    Ratio result;
    result.value = glm::dvec3(total.visible / total.count);
    for (int c = 0; c < 3; ++c)
        if (bottom[c] > 0.0) {
            result.value[c] = top[c] / bottom[c];
            result.per_bottom[c] = 1.0 / bottom[c];
        }
    return result;
}

}  // namespace

SampleSets make_sets(int samples, int camera_samples_per_pixel) {
    return {samples, std::min(samples, camera_samples_per_pixel == 1 ? kMostSets : 2)};
}

SampleSets sets_of(const RenderOptions& options, int samples) {
    // 8 each keep the ratio's bias small.
    const int each =
        std::max(samples / options.samples_per_pixel, std::min(samples, kFewestSamples));
    return make_sets(each, options.samples_per_pixel);
}

Estimated combine_means(std::span<const SetSums> sets, glm::dvec3 diffuse) {
    const SetSums total = total_of(sets);
    Estimated result;
    result.irradiance = total.lit / total.count;
    result.radiance = diffuse * result.irradiance + total.reflected / total.count;
    result.variance_y = variance_y(sets, [&](const SetSums& set) {
        return (diffuse * set.lit + set.reflected - result.radiance * set.count) / total.count;
    });
    return result;
}

Estimated combine_ratio(std::span<const SetSums> sets, glm::dvec3 diffuse, glm::dvec3 unshadowed) {
    const SetSums total = total_of(sets);
    const Ratio visibility = ratio(total.lit, total.all, total);
    const glm::dvec3 lobe = total.reflected / total.count;
    Estimated result;
    result.irradiance = unshadowed * visibility.value;
    result.radiance = diffuse * result.irradiance + lobe;
    result.variance_y = variance_y(sets, [&](const SetSums& set) {
        return diffuse * unshadowed * visibility.deviation(set.lit, set.all) +
               (set.reflected - lobe * set.count) / total.count;
    });
    return result;
}

Estimated combine_reflected(std::span<const SetSums> sets,
                            glm::dvec3 unshadowed_irradiance,
                            glm::dvec3 unshadowed_radiance) {
    const SetSums total = total_of(sets);
    const Ratio reflected = ratio(total.reflected, total.all_reflected, total);
    Estimated result;
    result.irradiance = unshadowed_irradiance * ratio(total.lit, total.all, total).value;
    result.radiance = unshadowed_radiance * reflected.value;
    result.variance_y = variance_y(sets, [&](const SetSums& set) {
        return unshadowed_radiance * reflected.deviation(set.reflected, set.all_reflected);
    });
    return result;
}

double unbiased_root(double degrees) {
    // 1 / c4 = 1 + 1 / (4 degrees) to 2 % at 1 and better beyond.
    return 1.0 + 0.25 / degrees;
}

glm::vec2 shift_of_set(model::Shift shift,
                       glm::uvec2 pixel,
                       std::uint32_t set,
                       std::uint32_t seed) {
    if (shift == model::Shift::Constant)
        return shared::r2_point(set, {0U, 0U});
    return model::shift_of(shift, pixel, set, seed);
}

}  // namespace nearfield::render
