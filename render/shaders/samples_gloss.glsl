// SPDX-License-Identifier: Apache-2.0
// Light that a glossy lobe reflects, by multiple importance sampling of lamp and lobe with the
// balance heuristic: as render/cpu/gloss.cpp; densities as formats/model/sampler_density.cpp.

float balance(float density, float other) { return density / (density + other); }

int samples_of(float energy, int count);

// Uniform and Pdis: what a set draws of all of the lamp's images.
float samples_of_lamp(int count) {
    int sum = 0;
#if SAMPLER == UNIFORM || SAMPLER == PDIS
    for (int k = 0; k < part.y; ++k)
        sum += samples_of(energy_of_lamp(k), count);
#endif
    return float(sum);
}

// A point of U as the receiver sees it, and the texel behind it.
struct SeenPoint {
    vec2 u_m, e;
    ivec2 texel;
    bool is_on_s;
};

SeenPoint see(SlabView view, vec2 u_m) {
    SeenPoint point;
    point.u_m = u_m;
    point.e = vec2(e_of_u(view.x, u_m.x), e_of_u(view.y, u_m.y));
    float height = view.x_texels.height;
    point.texel = ivec2(
        texel_of_s(view.x_texels, s_of_u(u_m.x, view.x.p, delta_m(), height), 0.0),
        texel_of_s(view.y_texels, s_of_u(u_m.y, view.y.p, delta_m(), height), 0.0));
    point.is_on_s = all(greaterThanEqual(point.texel, ivec2(0))) &&
                    all(lessThan(point.texel, slab.grid_texels.zw));
    return point;
}

bool holds(AxisBox box, float e) {
    return box.first <= box.last && e >= box.e_lo && e < box.e_hi;
}

// The cell of Phi_m's support along an axis that holds u; -1 or n outside.
int cell_of(int axis, int k, float u_m) {
    float x = (u_m - cell_edge_m(axis, k)) / slab.pitch_delta_m[axis];
    return int(clamp(floor(x), -1.0, float(cell_count())));
}

// Density per m^2 on U of an image's own CDFs within boxes.
float stored_density(SlabView view, int image, AxisBox x, AxisBox y, ivec2 texel) {
    vec2 texel_u_m = abs(vec2(view.x.s_keep + view.x.s_slope, view.y.s_keep + view.y.s_slope)) *
                     slab.s_min_texel_m.zw * vec2(view.x.t_scale, view.y.t_scale) *
                     (delta_m() + view.position_m.z);
    ivec2 inside = clamp(texel, ivec2(x.first, y.first), ivec2(x.last, y.last));
    return cdf_density(stored_cdf(image, -1), x, inside.x, texel_u_m.x) *
           cdf_density(stored_cdf(image, inside.x), y, inside.y, texel_u_m.y);
}

float joint_density(Receiver receiver, ivec2 basis, SeenPoint point) {
    SlabView view = receiver.view;
    int image = basis.y * slab.grid_texels.x + basis.x;
#if SAMPLER == PRECOMPUTED
    return energy_of(image) / receiver.lamp_total *
           stored_density(view, image, whole_axis(slab.grid_texels.z),
                          whole_axis(slab.grid_texels.w), point.texel);
#else
    Entry entry = first_cell_of(image, basis);
#if SAMPLER == CELLS
    entry.cell = ivec2(cell_of(0, basis.x, point.u_m.x), cell_of(1, basis.y, point.u_m.y));
    if (min(entry.cell.x, entry.cell.y) < 0 || max(entry.cell.x, entry.cell.y) >= cell_count())
        return 0.0;
#endif
    AxisBox x = entry_box_x(view, entry), y = entry_box_y(view, entry);
    if (!holds(x, point.e.x) || !holds(y, point.e.y))
        return 0.0;
#if SAMPLER == UNIFORM
    return energy_of(image) / (receiver.lamp_total * (x.e_hi - x.e_lo) * view.x.u_scale *
                               (y.e_hi - y.e_lo) * view.y.u_scale);
#elif SAMPLER == PDIS
    return float(pdis_count(receiver.set_samples, drawing.z, double(receiver.lamp_total),
                            abs(energy_of(image)))) /
           receiver.samples_drawn * stored_density(view, image, x, y, point.texel);
#else
    float distance = delta_m() + view.position_m.z;
    return texel_luminance(image, point.texel.x, point.texel.y) * mean_basis(entry) *
           delta2_or_1() / (distance * distance * receiver.lamp_total);
#endif
#endif
}

// Basis functions along an axis whose support may hold u, one further on both sides: rounding may
// see u across an edge.
ivec2 covering(int axis, float u_m) {
    float x = (u_m - cell_edge_m(axis, 0)) / slab.pitch_delta_m[axis];
    int cell = int(clamp(floor(x), -2.0, float(slab.grid_texels[axis] + cell_count())));
    return ivec2(max(cell - cell_count(), 0), min(cell + 1, slab.grid_texels[axis] - 1));
}

// Of a point on U whatever its image, per solid angle from the receiver.
float density_per_omega(Receiver receiver, vec2 u_m) {
    SeenPoint point = see(receiver.view, u_m);
    if (!point.is_on_s)
        return 0.0;
#if SAMPLER == PRECOMPUTED
    ivec2 columns = ivec2(0, slab.grid_texels.x - 1), rows = ivec2(0, slab.grid_texels.y - 1);
#else
    ivec2 columns = covering(0, u_m.x), rows = covering(1, u_m.y);
#endif
    float density = 0.0;
    for (int row = rows.x; row <= rows.y; ++row)
        for (int column = columns.x; column <= columns.y; ++column)
            density += joint_density(receiver, ivec2(column, row), point);
    float distance = delta_m() + receiver.view.position_m.z;
    return density * omega_per_u((u_m - receiver.view.position_m.xy) / distance, distance);
}

// L(u -> p).
vec3 radiance_towards(SlabView view, vec2 u_m) {
    SeenPoint point = see(view, u_m);
    if (!point.is_on_s)
        return vec3(0.0);
    ivec2 columns = covering(0, u_m.x), rows = covering(1, u_m.y);
    vec3 sum = vec3(0.0);
    for (int row = rows.x; row <= rows.y; ++row)
        for (int column = columns.x; column <= columns.y; ++column) {
            int image = row * slab.grid_texels.x + column;
            float basis = max(basis_at(ivec2(column, row), u_m), 0.0);
            sum += basis * texel_luminance(image, point.texel.x, point.texel.y) *
                   color_of_texel(image, point.texel);
        }
    vec2 t = (u_m - view.position_m.xy) / (delta_m() + view.position_m.z);
    float r2 = 1.0 + dot(t, t);
    return has_radiance_weighting() ? sum : sum * (delta_m() * delta_m() * r2 * r2);
}

// f_r of the lobe towards a point of U, times the weight of lamp samples there.
vec3 weighted_lobe(Receiver receiver, vec2 u_m) {
    vec3 from_m = vec3(slab.world_from_slab * vec4(u_m, -delta_m(), 1.0));
    vec3 to_light =
        local_from_world(receiver.frame, normalize(from_m - receiver.position_m));
    float light_density = density_per_omega(receiver, u_m);
    float lobe_density = brdf_lobe_density(receiver.brdf, to_light, receiver.to_viewer);
    if (!(light_density > 0.0))
        return vec3(0.0);
    return brdf_lobe(receiver.brdf, to_light, receiver.to_viewer) *
           balance(light_density, lobe_density);
}

// Of one direction: light that the lobe reflects from this slab, weighted, over the density.
vec3 along(Receiver receiver, vec3 to_light, float lobe_density) {
    SlabView view = receiver.view;
    vec3 direction = slab_direction(world_from_local(receiver.frame, to_light));
    float height = delta_m() + view.position_m.z;
    if (!(height > 0.0 && direction.z < 0.0))
        return vec3(0.0);
    vec2 u_m = view.position_m.xy - direction.xy * (height / direction.z);
    vec3 radiance = radiance_towards(view, u_m);
    if (!(max(radiance.x, max(radiance.y, radiance.z)) > 0.0))
        return vec3(0.0);
    float weight = balance(lobe_density, density_per_omega(receiver, u_m));
    return radiance * brdf_lobe(receiver.brdf, to_light, receiver.to_viewer) *
           (weight * to_light.z / lobe_density * visibility_of(receiver, u_m));
}

// The mean over `count` directions drawn by the lobe.
vec3 lobe_samples(Receiver receiver, int count, vec2 shift) {
    vec3 sum = vec3(0.0);
    bool is_drawn = receiver.is_glossy && running_total(part.z + 1) > running_total(part.z);
    for (int k = 0; k < count && is_drawn; ++k) {
        vec2 xi = r2_point(uint(k), shift_words(shift));
        vec3 to_light = brdf_lobe_sample(receiver.brdf, receiver.to_viewer, xi);
        float density = brdf_lobe_density(receiver.brdf, to_light, receiver.to_viewer);
        if (density > 0.0)
            sum += along(receiver, to_light, density);
    }
    return sum / float(count);
}
