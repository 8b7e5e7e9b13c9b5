// SPDX-License-Identifier: Apache-2.0
/// A scene's environment on the graphics card: what render/shaders/sky.glsl reads.
///
/// Precision: all in 32-bit float, since suns pass what half floats hold; maps are interpolated in
/// the shader, as on the CPU. 16 bytes a texel of the picture, and of both maps with their mips (a
/// picture of 1024 x 512: 8 MB and 45 MB).
#pragma once

#include "render/gpu/device.h"
#include "render/gpu/objects.h"
#include "render/options.h"
#include "render/sky.h"

#include <cstdint>
#include <memory>

namespace nearfield::render::gpu {

struct SkyOnCard {
    std::shared_ptr<const environment::Environment> environment;  // that textures hold
    Texture picture;                                              // RGBA32F
    Texture maps;            // RGBA32F array [side] with mips; only for filtered samples
    Texture maps_with_suns;  // the same; only beside suns
    Buffer suns;             // SkyDirection [N]
    Buffer directions;       // SkyDirection [N]
    Buffer fit;              // floats [16][N]
    Buffer block;            // SkyBlock
    std::uint64_t bytes = 0;
};

/// Uploads the environment unless it is there, and where it is turned to. Throws Error where it
/// passes the device's limits.
void upload_sky(Device& device, const Sky& sky, const RenderOptions& options, SkyOnCard& on_card);

/// Binds what sky.glsl and the shaders that include it read, but shadows.
void bind_sky(const SkyOnCard& on_card);

}  // namespace nearfield::render::gpu
