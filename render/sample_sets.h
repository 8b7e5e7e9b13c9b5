// SPDX-License-Identifier: Apache-2.0
/// A pixel's samples of a lamp, drawn as a few independent sets, and what their spread says of the
/// error: samples within a set are stratified against each other and must not count as independent.
#pragma once

#include "formats/model/sampler.h"
#include "render/options.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>

namespace nearfield::render {

/// Sets of equal size, or one apart. More sets: sigma itself is less noisy, and strata are coarser.
struct SampleSets {
    int samples = 64;
    int sets = 4;

    int size_of(int set) const { return samples / sets + (set < samples % sets ? 1 : 0); }
};

constexpr int kMostSets = 4;

/// The sets of one camera sample: 4, or 2 where several camera samples share a pixel, since theirs
/// add to the pixel's sigma; a sample each at least.
SampleSets make_sets(int samples, int camera_samples_per_pixel);

/// The sets of one camera sample in a pass that draws `samples` of a pixel and lamp: camera samples
/// of one pixel share them.
SampleSets sets_of(const RenderOptions& options, int samples);

/// What one set of samples found at one hit: sums over its samples, which over `count` are
/// estimates.
struct SetSums {
    double count = 0, visible = 0;  // samples
    glm::dvec3 lit{0.0}, all{0.0};  // irradiance, shadowed and unshadowed
    /// Radiance towards the viewer, shadowed and unshadowed: of the glossy lobe alone (the first of
    /// them, for combine_means and combine_ratio) or of all (both, for combine_reflected).
    glm::dvec3 reflected{0.0}, all_reflected{0.0};
};

/// Estimates from all sets together. variance_y: of radiance's luminance, from the sets' spread.
struct Estimated {
    glm::dvec3 irradiance{0.0}, radiance{0.0};
    double variance_y = 0;
};

/// Plain means. diffuse: what turns irradiance into diffuse radiance, albedo / pi.
Estimated combine_means(std::span<const SetSums> sets, glm::dvec3 diffuse);

/// The diffuse part as `unshadowed` times the ratio of lit and all, whose noise is in penumbrae
/// alone; bias O(1 / samples). The variance is that of the linearized ratio.
Estimated combine_ratio(std::span<const SetSums> sets, glm::dvec3 diffuse, glm::dvec3 unshadowed);

/// Both as the unshadowed values times ratios.
Estimated combine_reflected(std::span<const SetSums> sets,
                            glm::dvec3 unshadowed_irradiance,
                            glm::dvec3 unshadowed_radiance);

/// What multiplies the root of a mean of `degrees` squared normal deviations so that it is right on
/// average: a root of few is low.
double unbiased_root(double degrees);

/// The shift of a set of samples; sets are numbered through all of a pixel's. Constant shifts are
/// those of no pixel, but differ from set to set, or there would be no spread.
glm::vec2 shift_of_set(model::Shift shift, glm::uvec2 pixel, std::uint32_t set, std::uint32_t seed);

}  // namespace nearfield::render
