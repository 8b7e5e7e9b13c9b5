// SPDX-License-Identifier: Apache-2.0
/// A lamp's shadow maps: what render/shaders/shadows.glsl reads.
///
/// A map holds 1 / depth along the slab's axis, from the view's eye: linear in tangents, so that
/// planes are planes in it too, and in float as precise far away as near by. A receiver is compared
/// with the plane through it (its normal's), which has no acne however it is tilted. Less than a
/// bias before that plane nothing casts a shadow: the width of a map's texel at the receiver's
/// depth, depth * (tangent_max - tangent_min) / map_px.
///
/// What maps do not show is lit: receivers between the planes S and U outside a map's pyramid
/// (beyond S every one that has light is inside; count_unmapped() tells how many), those nearer to
/// U's plane than 1e-4 of delta. Cells without light have no map. Excluded instances are not drawn.
/// Triangles have two sides.
#pragma once

#include "render/gpu/device.h"
#include "render/gpu/objects.h"
#include "render/gpu/scene_buffers.h"
#include "render/gpu/shader.h"
#include "render/gpu/shadow_views.h"
#include "render/gpu/slab_textures.h"
#include "render/gpu/surfaces.h"
#include "render/lamps.h"

#include <memory>
#include <vector>

namespace nearfield::render::gpu {

/// What a lamp's maps were rendered for.
struct ShadowKey {
    std::shared_ptr<const LoadedLightField> file;
    std::vector<glm::dmat4> world_from_slab;
    std::vector<bool> is_caster;  // [instance]
    std::size_t geometry_hash = 0;
    ShadowMapOptions options;

    bool operator==(const ShadowKey&) const = default;
};

struct ShadowMaps {
    ShadowViews views;
    Texture depth;              // DEPTH_COMPONENT32F array [view], map_px a side: nearest / depth
    std::vector<Buffer> cells;  // [slab] ShadowCells of shadows.glsl
    ShadowKey key;
    int renders = 0;            // how often they were rendered
    std::size_t triangles = 0;  // drawn the last time, all maps
};

/// What draws them; the same for all lamps.
struct ShadowPass {
    Program draw;
    Framebuffer framebuffer;
};
ShadowPass make_shadow_pass();

/// Renders the maps of a lamp unless they are already of this lamp at this place, this scene and
/// these options. Throws Error where options are out of range. Changes the bound framebuffer,
/// program and viewport.
/// Cost: pixels of all maps, and triangles of instances in view of each; 42 maps of 192 a side and
/// 99,000 triangles in all: 0.1 to 0.2 s by llvmpipe on 2 busy cores.
void update_shadow_maps(Device& device,
                        const ShadowPass& pass,
                        const SceneBuffers& scene,
                        const Lamps& lamps,
                        std::size_t lamp,
                        const ShadowMapOptions& options,
                        ShadowMaps& maps);

/// What shaders that include shadows.glsl are compiled with.
Defines shadow_defines(const ShadowMapOptions& options);

/// Binds a slab's maps where shadows.glsl expects them; beside bind_slab().
void bind_shadows(const ShadowMaps& maps, std::size_t slab);

/// A slab's maps and the surfaces that they are looked up at.
struct MeasuredShadows {
    Device& device;
    const Surfaces& surfaces;
    const Buffer& materials;
    const SlabTextures& slab_textures;
    const ShadowMaps& maps;
    std::size_t slab = 0;
};

/// Pixels between the planes S and U, in the space that the slab may light, that some cell's map
/// does not show: its light reaches them unshadowed. Beyond S there are none. unmapped: of the
/// maps' options.
Program link_unmapped(const ShadowMapOptions& options);
int count_unmapped(const MeasuredShadows& of, const Program& unmapped);

/// What shadows.glsl says of every pixel and cell of a slab: visibility 0 ... 1, -1 where the cell
/// has a map that does not show the pixel (it counts as lit), 1 where nothing is seen.
/// [pixel][row of cells][column of cells]. 4 bytes a pixel and cell.
std::vector<float> cell_visibilities(const MeasuredShadows& of);

}  // namespace nearfield::render::gpu
