// SPDX-License-Identifier: Apache-2.0
// What every pixel of a band sees of one slab: the energies that samples.comp draws from, and the
// lamp's running sum. As formats/model/sampler_look.cpp.
#include "render/shaders/samples_view.glsl"
#include "render/shaders/surface.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Negative: summed by texels.
float window_energy(int image, AxisBox x, AxisBox y) {
    if (!is_lit(image, x, y))
        return 0.0;
    float found = box_energy(area_table(image), x, y);
    return is_resolved(found, slab_totals[image], x, y) ? found : -energy_by_texels(image, x, y);
}

float entry_energy(SlabView view, Entry entry) {
#if SAMPLER == PRECOMPUTED
    return slab_totals[entry.image] * energy_scale() * texel_area_m2();
#else
    float energy = energy_scale() * mean_basis(entry) *
                   window_energy(entry.image, entry_box_x(view, entry), entry_box_y(view, entry));
#if SAMPLER == UNIFORM
    return energy != 0.0 ? 1.0 : 0.0;
#else
    return energy;
#endif
#endif
}

void main() {
    if (!is_in_band())
        return;
    Surface surface = surface_at(band_pixel());
    SlabView view = slab_view(surface.position_m, surface.normal);
    bool is_seen = surface.material >= 0 && sees_light(view);
    int at = index_in_band();
    double running = part.z == 0 ? double(0.0) : running_total(part.z);
    Entry entry = first_cell_of(0, ivec2(0));
    for (int k = 0; k < entry_count(); ++k) {
        float energy = is_seen ? entry_energy(view, entry) : 0.0;
        entry = next_entry(entry);
        energies[(part.x + k) * band.w + at] = energy;
        running += double(abs(energy));
    }
    if (part.z == 0)
        running_totals[at] = double(0.0);
    running_totals[(part.z + 1) * band.w + at] = running;
}
