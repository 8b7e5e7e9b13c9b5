// SPDX-License-Identifier: Apache-2.0
#include "render/plan_rows.h"

#include <algorithm>

namespace nearfield::render::rows {
namespace {

double pixels(const Context& at) {
    return static_cast<double>(at.size_px.x) * static_cast<double>(at.size_px.y);
}

double triangle_count(const Context& at) {
    double count = 0.0;
    for (const Mesh& mesh : at.scene.meshes)
        count += static_cast<double>(mesh.triangles.size());
    return count;
}

}  // namespace

double no_bytes(const Context& /*at*/) {
    return 0.0;
}

/// R, G, B or Y, as floats.
double film_bytes(const Context& at) {
    constexpr double kChannels = 14.0, kOfLamp = 3.0;
    return 4.0 * pixels(at) * (kChannels + kOfLamp * static_cast<double>(at.lamps.lamps.size()));
}

double camera_bytes(const Context& at) {
    constexpr double kOfTriangle = 200.0;  // Embree's copy and hierarchy
    return film_bytes(at) + kOfTriangle * triangle_count(at);
}

double coefficient_bytes_of(const Context& at) {
    return coefficient_bytes(at.lamps);
}

double table_bytes_of(const Context& at) {
    return table_bytes(at.lamps);
}

double sampler_bytes(const Context& at) {
    return at.options.sampler ? table_bytes(at.lamps) : 0.0;
}

double g_buffer_bytes(const Context& at) {
    constexpr double kOfPixel = 64.0;  // position, normal, tangent, material, depth
    return kOfPixel * pixels(at);
}

/// A map a cell of U and slab, or as many as are asked for.
double shadow_map_bytes(const Context& at) {
    constexpr double kOfTexel = 4.0;
    const ShadowMapOptions& options = at.options.shadow_maps;
    double maps = 0.0;
    for (std::size_t k = 0; k < at.lamps.lamps.size(); ++k) {
        double cells = 0.0;
        for (const PlacedSlab& placed : at.lamps.lamps[k].slabs) {
            const Slab& slab = placed.prepared->slab;
            const glm::dvec2 along =
                glm::dvec2(slab.grid - 1) + static_cast<double>(slab.profile.cells.size());
            cells += along.x * along.y;
        }
        if (at.plan.lamps[k].has_shadows)
            maps += options.maps > 0 ? std::min(cells, static_cast<double>(options.maps)) : cells;
    }
    return kOfTexel * options.map_px * options.map_px * maps;
}

double energy_bytes(const Context& at) {
    double images = 0.0;
    for (const Lamp& lamp : at.lamps.lamps)
        for (const PlacedSlab& placed : lamp.slabs)
            images = std::max(images, static_cast<double>(placed.prepared->slab.image_count()));
    return 4.0 * images * pixels(at);
}

/// Maps, and 16 coefficients a pixel.
double sky_map_bytes(const Context& at) {
    constexpr double kOfTexel = 4.0, kOfPixel = 64.0;
    const EnvironmentOptions& options = at.options.environment;
    return kOfTexel * options.map_px * options.map_px * options.directions + kOfPixel * pixels(at);
}

double display_bytes(const Context& at) {
    constexpr double kOfPixel = 3.0;
    return kOfPixel * pixels(at);
}

}  // namespace nearfield::render::rows
