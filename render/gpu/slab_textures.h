// SPDX-License-Identifier: Apache-2.0
/// A slab of a lamp on the graphics card: what render/shaders/slab.glsl reads.
///
/// Precision: C_m in 32-bit float for the sum. Samplers read luminance in float, chroma (C_m over
/// its luminance, R and B; G follows) in 16-bit float, relative error 5e-4 of the hue alone, and
/// summed-area tables as pairs of floats. 11 x 9 x 256^2 in color: 78 MB for the sum, 104 MB for
/// samplers.
#pragma once

#include "formats/files/luminaire.h"
#include "render/gpu/device.h"
#include "render/gpu/objects.h"

#include <glm/glm.hpp>

#include <cstdint>

namespace nearfield::render::gpu {

/// What is read of a slab; nothing else is uploaded.
struct SlabNeeds {
    bool coeffs = false;    // the sum
    bool tables = false;    // samplers: luminance, chroma, summed areas
    bool cdfs = false;      // the baselines `precomputed` and `pdis`
    bool has_color = true;  // else chroma is left out, and coeffs are luminance
};

struct SlabTextures {
    int channels = 1;     // of coeffs, and whether there is chroma (3)
    Texture coeffs;       // R32F array [channel * images + image], w x h
    Texture luminance;    // R32F array [image], w x h; coeffs serve where those have one channel
    Texture chroma;       // RG16F array [image]: R/Y, B/Y, 0 where Y is 0
    Texture area;         // RG32F array [image]: hi, lo, (w + 1) x (h + 1)
    Texture marginal;     // R32F [image][w + 1]
    Texture conditional;  // R32F array [image]: (h + 1) x w, row i is column i's CDF over y
    Buffer block;         // the uniform block SlabBlock of slab.glsl
    Buffer edges;         // floats, see slab.glsl
    Buffer lit;           // ivec4 [image]: PreparedSlab::lit
    Buffer totals;        // float [image]: SlabTables::total; only with tables
};

/// Where a slab stands in the scene, as shaders need it.
struct SlabPlacement {
    glm::dmat4 slab_from_world{1.0}, world_from_slab{1.0};
    glm::dmat3 slab_from_world_rotation{1.0};
};

/// tables: null unless needs.tables or needs.cdfs; lit: of prepare(). Throws Error where the slab
/// passes the device's limits.
SlabTextures upload_slab(Device& device,
                         const Slab& slab,
                         const std::vector<glm::ivec4>& lit,
                         const SlabTables* tables,
                         const SlabNeeds& needs,
                         const SlabPlacement& placement);

/// Moves a slab that is uploaded: one lamp after another may shine through the same textures.
void place_slab(const SlabTextures& slab, const SlabPlacement& placement);

/// Binds all of them where slab.glsl expects them.
void bind_slab(const SlabTextures& slab);

}  // namespace nearfield::render::gpu
