// SPDX-License-Identifier: Apache-2.0
/// A lamp's shadow maps on what a camera sees, beside traced visibility.
#pragma once

#include "render/cpu/tracer.h"
#include "render/gpu/shadow_maps.h"

#include <glm/glm.hpp>

#include <memory>
#include <vector>

namespace nearfield::render::gpu {

/// A scene on the device, seen by its first camera.
struct ShadowRun {
    const Scene* scene = nullptr;
    Lamps lamps;
    SceneBuffers buffers;
    SurfacePass surfaces;
    ShadowPass pass;
    ShadowMaps maps;
    std::vector<float> position, normal;  // of the surfaces, four floats a pixel
};

ShadowRun make_run(Device& device, const Scene& scene, glm::ivec2 size_px);

/// [pixel][cell] of the first lamp's slab, by maps; these are updated.
std::vector<float> mapped(Device& device,
                          ShadowRun& run,
                          const ShadowMapOptions& options,
                          std::size_t slab = 0);

/// Pixels that some cell's map does not show, of the maps as they are.
int count_unmapped(Device& device, const ShadowRun& run, std::size_t slab = 0);

/// Light that reaches each pixel from each cell by `side` x `side` points of it: irradiance of any
/// unit, all of it and what is not hidden by rays. Single-sided in the cosine, as light is.
struct TracedCells {
    std::size_t cells = 0;
    std::vector<double> all, lit;  // [pixel][cell]
};
TracedCells trace_cells(const ShadowRun& run, int side, std::size_t slab = 0);

/// How far maps are from rays.
struct ShadowError {
    double light = 0;   // sum over pixels of |light by maps - by rays|, over all unshadowed light
    double pairs = 0;   // share of pairs of pixel and cell with light whose visibilities are more
                        // than 0.5 apart
    double hidden = 0;  // share of light that rays find hidden
    std::size_t outside = 0;  // pairs that a map should show and does not
};
ShadowError compare(const TracedCells& traced, const std::vector<float>& visibilities);

}  // namespace nearfield::render::gpu
