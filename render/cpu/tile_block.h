// SPDX-License-Identifier: Apache-2.0
/// The pixels of a tile that are shaded together, and what the steps of that share.
#pragma once

#include "render/cpu/tile.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace nearfield::render {

/// A camera ray that met something.
struct Sample {
    glm::ivec2 pixel{0};
    std::size_t index = 0;  // of the pixel in the picture
    glm::dvec3 direction{0.0};
    const shared::Brdf* brdf = nullptr;
    shared::SurfaceFrame frame;
};

/// What a block's steps hand each other; kept from block to block for its memory.
struct Block {
    std::vector<Sample> samples;
    std::vector<Hit> hits;  // [sample]
    LightSums sums;
    Scratch scratch;
};

void add_rgb(Layer& layer, std::size_t pixel, glm::vec3 value);

ShadeQuery query_of(const Frame& frame,
                    const Pass& pass,
                    const Block& block,
                    std::size_t k,
                    std::uint32_t first_set);

/// What arrives along a camera ray that meets nothing, times share, in the picture and in the
/// environment's own layer.
void add_sky_past(const Frame& frame, std::size_t pixel, glm::dvec3 direction, float share);

/// Adds the environment's light to the layers.
void shade_sky_block(const Frame& frame, const Pass& pass, int stratum, Block& block);

}  // namespace nearfield::render
