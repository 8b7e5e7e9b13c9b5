// SPDX-License-Identifier: Apache-2.0
/// The picture in the making: sums over passes, and their way out.
#pragma once

#include "formats/files/image.h"
#include "render/display.h"
#include "render/gpu/device.h"
#include "render/gpu/objects.h"

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace nearfield::render::gpu {

/// RGBA32F each: 16 bytes a pixel, times four and one a lamp and for an environment; bounds of
/// bias: 36 bytes more.
struct Film {
    glm::ivec2 size_px{0};
    Texture lamp_light;       // of one lamp, slab after slab: radiance, variance of its luminance
    Texture lamp_irradiance;  // of one lamp
    Texture radiance, irradiance;           // sums over lamps and passes, times the passes' weights
    std::vector<Texture> of_lamp;           // [lamp, then environment] radiance, the same
    Texture finer_light, finer_irradiance;  // of one lamp, by sums on finer images; only with bias
    Texture bias;                           // R32F, as the other sums; none where sums are exact
    Program accumulate, add_bias, tonemap;
    float weight = 0.0F, weight_squares = 0.0F;  // of all passes so far
};

Film make_film(Device& device, glm::ivec2 size_px, std::size_t lamps, bool has_bias);

/// All sums to 0.
void clear(Film& film);

/// Readies lamp_light and lamp_irradiance for one lamp's passes: black, bound as image units 0
/// and 1.
void begin_lamp(const Film& film);
/// Between the two, once lamp_light holds a lamp's sums on coarse images and nothing else: readies
/// images for its sums on finer ones, black, bound as image units 0 and 1; then adds what bounds
/// the coarse ones' bias (model/mip_sum.h), pixel by pixel, and binds lamp_light again.
void begin_finer(const Film& film);
void end_finer(const Film& film, float weight);
/// Adds them to the sums.
void end_lamp(Film& film, std::size_t lamp, float weight);
/// After all lamps of a pass.
void end_pass(Film& film, float weight);

/// Means over passes into the picture's layers: radiance, irradiance, the lamps', sigma (the
/// square root of the mean's variance, times `root`: sample_sets.h, unbiased_root), and the last
/// one, bias_bound, where there is bias.
void read_film(const Film& film, float root, Picture& picture);

/// 8-bit sRGB of the means, an RGBA8 texture. exposure_ev: as Display says it.
Texture tone_map(Device& device, const Film& film, ToneMap operation, double exposure_ev);

}  // namespace nearfield::render::gpu
