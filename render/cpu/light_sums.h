// SPDX-License-Identifier: Apache-2.0
/// Unshadowed light by the windowed sum, for neighboring hits together.
#pragma once

#include "render/cpu/tracer.h"
#include "render/lamps.h"

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::render {

/// Light of one lamp at several hits, slab by slab.
struct LightSums {
    struct OfSlab {
        std::vector<model::ReceiverF> receivers;  // [hit]
        std::vector<float> image_y;               // [hit][image]
        std::vector<float> y;                     // [hit], the sum of its image_y in order
    };
    std::vector<OfSlab> slabs;
    std::vector<glm::vec3> irradiance;  // [hit], without dim
    std::vector<float> total_y;         // [hit], sum of the slabs' y
    /// What bounds the error of E_q, from |E_q - E_2q| (mip_sum.h), over E_q of the brightest hit;
    /// 0 where the sum is exact. One receiver stands for its neighbors: a sum at 2q costs four at
    /// q.
    float bias_bound_rel = 0.0F;
    std::uint64_t multiply_adds = 0;  // of this call

    // Kept from call to call for its memory.
    std::vector<glm::vec3> of_one_slab;
};

/// The hit as one slab's receiver, with its shading normal.
model::ReceiverF receiver_in_slab(const PlacedSlab& slab, const Hit& hit);

/// Windowed sums of one lamp for all hits together: neighbors cost less that way. q: windows span
/// so many texels at most; 0: exact; else the lamps' mips must have been loaded.
void sum_light(const Lamp& lamp, int q, std::span<const Hit> hits, LightSums& sums);

}  // namespace nearfield::render
