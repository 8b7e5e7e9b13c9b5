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

/// RGBA32F each: 16 bytes a pixel, times four and one a lamp.
struct Film {
    glm::ivec2 size_px{0};
    Texture lamp_light;       // of one lamp, slab after slab: radiance, variance of its luminance
    Texture lamp_irradiance;  // of one lamp
    Texture radiance, irradiance;  // sums over lamps and passes, times the passes' weights
    std::vector<Texture> of_lamp;  // [lamp] radiance, the same
    Program accumulate, tonemap;
    float weight = 0.0F, weight_squares = 0.0F;  // of all passes so far
};

Film make_film(Device& device, glm::ivec2 size_px, std::size_t lamps);

/// All sums to 0.
void clear(Film& film);

/// Readies lamp_light and lamp_irradiance for one lamp's passes: black, bound as image units 0
/// and 1.
void begin_lamp(const Film& film);
/// Adds them to the sums.
void end_lamp(Film& film, std::size_t lamp, float weight);
/// After all lamps of a pass.
void end_pass(Film& film, float weight);

/// Means over passes into the picture's layers: radiance, irradiance, the lamps', sigma (the
/// square root of the mean's variance, times `root`: sample_sets.h, unbiased_root).
void read_film(const Film& film, float root, Picture& picture);

/// 8-bit sRGB of the means, an RGBA8 texture. exposure_ev: as Display says it.
Texture tone_map(Device& device, const Film& film, ToneMap operation, double exposure_ev);

}  // namespace nearfield::render::gpu
