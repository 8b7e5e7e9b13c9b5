// SPDX-License-Identifier: Apache-2.0
#include "tests/render/gpu/shadow_run.h"

#include "formats/model/sampler.h"
#include "render/gpu/storage.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::render::gpu {
namespace {

glm::dvec3 vector_at(const std::vector<float>& values, std::size_t pixel) {
    return {values[4 * pixel], values[4 * pixel + 1], values[4 * pixel + 2]};
}

/// Irradiance from a point on U per area of it, times the area's common factor.
double light_from(const PlacedSlab& placed,
                  glm::dvec3 p_world_m,
                  glm::dvec3 normal,
                  glm::dvec2 u_m) {
    const Slab& slab = placed.prepared->slab;
    const glm::dvec3 p(placed.slab_from_world * glm::dvec4(p_world_m, 1.0));
    if (p.z <= -slab.delta_m)
        return 0.0;
    const glm::dvec3 to_u = glm::dvec3(u_m, -slab.delta_m) - p;
    const double distance_m = glm::length(to_u);
    const double at_p = glm::dot(placed.slab_from_world_rotation * normal, to_u) / distance_m;
    const double at_u = -to_u.z / distance_m;
    const glm::vec3 radiance =
        model::radiance_towards(*placed.prepared, glm::vec3(p), glm::vec2(u_m));
    return std::max(at_p, 0.0) * at_u * static_cast<double>(radiance.y) / (distance_m * distance_m);
}

SlabTextures textures_of(Device& device, const PlacedSlab& placed) {
    SlabNeeds needs;
    needs.coeffs = true;
    return upload_slab(
        device, placed.prepared->slab, placed.prepared->lit, nullptr, needs,
        {placed.slab_from_world, placed.world_from_slab, placed.slab_from_world_rotation});
}

}  // namespace

ShadowRun make_run(Device& device, const Scene& scene, glm::ivec2 size_px) {
    ShadowRun run;
    run.scene = &scene;
    run.lamps = load_lamps(scene);
    run.buffers = upload_scene(device, scene);
    run.surfaces = make_surface_pass(device, run.buffers, size_px);
    draw_surfaces(run.buffers, scene.cameras[0], {0.5, 0.5}, run.surfaces);
    run.pass = make_shadow_pass();
    run.position = read_back(run.surfaces.surfaces.position, size_px, 4);
    run.normal = read_back(run.surfaces.surfaces.normal, size_px, 4);
    return run;
}

std::vector<float> mapped(Device& device,
                          ShadowRun& run,
                          const ShadowMapOptions& options,
                          std::size_t slab) {
    update_shadow_maps(device, run.pass, run.buffers, run.lamps, 0, options, run.maps);
    return cell_visibilities({device, run.surfaces.surfaces, run.buffers.materials,
                              textures_of(device, run.lamps.lamps[0].slabs[slab]), run.maps, slab});
}

int count_unmapped(Device& device, const ShadowRun& run, std::size_t slab) {
    return count_unmapped({device, run.surfaces.surfaces, run.buffers.materials,
                           textures_of(device, run.lamps.lamps[0].slabs[slab]), run.maps, slab},
                          link_unmapped(run.maps.key.options));
}

TracedCells trace_cells(const ShadowRun& run, int side, std::size_t slab_index) {
    const Tracer tracer(*run.scene, run.lamps.instance_masks, 1);
    const Lamp& lamp = run.lamps.lamps[0];
    const PlacedSlab& placed = lamp.slabs[slab_index];
    const Slab& slab = placed.prepared->slab;
    const auto n = static_cast<int>(slab.profile.cells.size());
    const glm::ivec2 cells = slab.grid + n - 1;
    const glm::dvec2 first_m = slab.basis_center_m(0, 0) - 0.5 * n * slab.pitch_m;
    TracedCells traced;
    traced.cells = static_cast<std::size_t>(cells.x * cells.y);
    for (std::size_t pixel = 0; 4 * pixel < run.position.size(); ++pixel)
        for (int cell = 0; cell < cells.x * cells.y; ++cell) {
            double all = 0.0, lit = 0.0;
            const glm::dvec3 p = vector_at(run.position, pixel),
                             normal = vector_at(run.normal, pixel);
            const bool is_seen = run.position[4 * pixel + 3] > 0.0F;
            for (int k = 0; is_seen && k < side * side; ++k) {
                const glm::dvec2 in_cell =
                    (glm::dvec2(k % side, k / side) + 0.5) / static_cast<double>(side);
                const glm::dvec2 u_m =
                    first_m + (glm::dvec2(cell % cells.x, cell / cells.x) + in_cell) * slab.pitch_m;
                const double light = light_from(placed, p, normal, u_m);
                if (!(light > 0.0))
                    continue;
                all += light;
                // Above the surface by the rounding of its position in float.
                const glm::dvec3 from = p + normal * (1e-5 * glm::length(p));
                const glm::dvec3 to(placed.world_from_slab * glm::dvec4(u_m, -slab.delta_m, 1.0));
                lit += tracer.is_occluded(from, to, lamp.mask) ? 0.0 : light;
            }
            traced.all.push_back(all);
            traced.lit.push_back(lit);
        }
    return traced;
}

ShadowError compare(const TracedCells& traced, const std::vector<float>& visibilities) {
    ShadowError error;
    double all = 0.0, of_pixel = 0.0;
    std::size_t pairs = 0;
    for (std::size_t k = 0; k < traced.all.size(); ++k) {
        if (k % traced.cells == 0)
            error.light += std::abs(std::exchange(of_pixel, 0.0));
        if (!(traced.all[k] > 0.0))
            continue;
        const auto found = static_cast<double>(visibilities[k]);
        error.outside += found < 0.0 ? 1 : 0;
        const double v = found < 0.0 ? 1.0 : found;
        error.pairs += std::abs(v - traced.lit[k] / traced.all[k]) > 0.5 ? 1.0 : 0.0;
        error.hidden += traced.all[k] - traced.lit[k];
        of_pixel += v * traced.all[k] - traced.lit[k];
        all += traced.all[k];
        ++pairs;
    }
    error.light = (error.light + std::abs(of_pixel)) / all;
    error.pairs /= static_cast<double>(pairs);
    error.hidden /= all;
    return error;
}

}  // namespace nearfield::render::gpu
