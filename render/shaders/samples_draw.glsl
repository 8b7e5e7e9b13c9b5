// SPDX-License-Identifier: Apache-2.0
// Draws one set of samples of one slab: every sampler as one loop over its samples, which walks the
// energies. As formats/model/sampler_draw.cpp and sampler_baselines.cpp; samples.comp says what
// becomes of a sample (add_sample).

// The walk along the running sum of energies, across all of the lamp's.
struct Walk {
    int index;
    Entry entry;
    double before, after;  // the running sum before and after the entry
    float energy;
};

Walk walk_from(double before) {
    Walk walk;
    walk.index = -1;
    walk.entry = first_cell_of(0, ivec2(0));
    walk.before = before;
    walk.after = before;
    walk.energy = 0.0;
    return walk;
}

// On to the entry in which the sum passes the target, which the slab holds.
void walk_to(double target, inout Walk walk) {
    while (!(target < walk.after) && walk.index + 1 < entry_count()) {
        if (walk.index >= 0)
            walk.entry = next_entry(walk.entry);
        walk.index += 1;
        walk.energy = energy_of(walk.index);
        walk.before = walk.after;
        walk.after += double(abs(walk.energy));
    }
}

// The first sample whose target is not before a sum.
int first_sample(double sum, float start, int count, double total) {
    int q = max(int(ceil(sum / total * double(count) - double(start))) - 1, 0);
    while (q < count && stratum_target(uint(q), start, uint(count), total) < sum)
        ++q;
    return q;
}

// Cells go on with what the stratified coordinate leaves of an energy; so do Fibonacci's points.
const bool kByRest = SAMPLER == CELLS || SEQUENCE == kSequenceFibonacci;

// Sample q of Systematic and Cells, in the entry that the walk has reached.
void add_stratified(Receiver receiver,
                    Walk walk,
                    double target,
                    int q,
                    int count,
                    vec2 shift,
                    float share,
                    bool by_texels,
                    inout Sums sums) {
    Entry entry = walk.entry;
    AxisBox x = entry_box_x(receiver.view, entry), y = entry_box_y(receiver.view, entry);
    float rest = float((target - walk.before) / double(abs(walk.energy)));
    vec2 coordinates =
        kByRest ? vec2(min(rest, kBelowOne), second_coordinate(uint(SEQUENCE), uint(q), shift))
                : plane_point(uint(SEQUENCE), uint(q), uint(count), shift);
    BoxPick pick;
    if (by_texels) {
        float energy = abs(walk.energy) / (energy_scale() * mean_basis(entry));
        pick = pick_by_texels(entry.image, x, y, energy, coordinates);
    } else {
        AreaTable table = area_table(entry.image);
        BoxCorners corners = box_corners(table, x, y);
        pick = pick_in_box(table, corners, box_blocks(corners, x, y), x, y, coordinates);
    }
    if (min(pick.texel.x, pick.texel.y) >= 0)
        add_sample(receiver, entry, pick.texel, aperture_point(receiver.view, x, y, pick),
                   share / mean_basis(entry), sums);
}

Sums draw_stratified(Receiver receiver, int count, vec2 shift) {
    Sums sums = no_light();
    double before = running_total(part.z), after = running_total(part.z + 1);
    double total = running_total(part.w);
    float start = kByRest ? shift.x : third_shift(shift);
    float share = float(total / double(count));
    int first = total > 0.0 ? first_sample(before, start, count, total) : count;
    Walk walk = walk_from(before);
    // Boxes by texels are rare, and have a loop of their own: a SIMD machine takes every branch.
    bool has_dark = false;
    for (int q = first; q < count; ++q) {
        double target = stratum_target(uint(q), start, uint(count), total);
        if (!(target < after))
            break;
        walk_to(target, walk);
        has_dark = has_dark || walk.energy < 0.0;
        if (walk.energy > 0.0)
            add_stratified(receiver, walk, target, q, count, shift, share, false, sums);
    }
    walk = walk_from(before);
    for (int q = first; q < count && has_dark; ++q) {
        double target = stratum_target(uint(q), start, uint(count), total);
        if (!(target < after))
            break;
        walk_to(target, walk);
        if (walk.energy < 0.0)
            add_stratified(receiver, walk, target, q, count, shift, share, true, sums);
    }
    return sums;
}

Sums draw_precomputed(Receiver receiver, int count, vec2 shift) {
    Sums sums = no_light();
    double before = running_total(part.z), after = running_total(part.z + 1);
    double total = running_total(part.w);
    float start = third_shift(shift);
    vec2 t_per_s = abs(vec2(receiver.view.x.s_keep + receiver.view.x.s_slope,
                            receiver.view.y.s_keep + receiver.view.y.s_slope)) *
                   vec2(receiver.view.x.t_scale, receiver.view.y.t_scale);
    double share = total / double(count) * double(t_per_s.x) * double(t_per_s.y);
    Walk walk = walk_from(before);
    for (int q = total > 0.0 ? first_sample(before, start, count, total) : count; q < count; ++q) {
        double target = stratum_target(uint(q), start, uint(count), total);
        if (!(target < after))
            break;
        walk_to(target, walk);
        vec2 xi = plane_point(uint(SEQUENCE), uint(q), uint(count), shift);
        StoredCdf columns = stored_cdf(walk.index, -1);
        TexelPick column = invert_cdf(
            columns, restrict_cdf(columns, whole_axis(slab.grid_texels.z)), xi.x, false, 0);
        StoredCdf rows = stored_cdf(walk.index, max(column.texel, 0));
        TexelPick row =
            invert_cdf(rows, restrict_cdf(rows, whole_axis(slab.grid_texels.w)), xi.y, false, 0);
        if (min(column.texel, row.texel) < 0)
            continue;
        vec2 s = slab.s_min_texel_m.xy + (vec2(column.texel, row.texel) +
                                          vec2(column.fraction, row.fraction)) *
                                             slab.s_min_texel_m.zw;
        add_sample(receiver, walk.entry, ivec2(column.texel, row.texel),
                   aperture_at(receiver.view.x, receiver.view.y,
                               vec2(e_of_s(receiver.view.x, s.x), e_of_s(receiver.view.y, s.y))),
                   share, sums);
    }
    return sums;
}

// How many samples Uniform and Pdis draw of one of the lamp's images.
int samples_of(float energy, int count) {
    if (!(abs(energy) > 0.0))
        return 0;
#if SAMPLER == UNIFORM
    return max(1, count / int(running_total(part.w)));
#else
    return pdis_count(count, drawing.z, running_total(part.w), abs(energy));
#endif
}

int texel_at(AxisTexels s, float u, float p, AxisBox box) {
    return clamp(texel_of_s(s, s_of_u(u, p, s.delta, s.height), 0.0), box.first, box.last);
}

void add_uniform(Receiver receiver, int image, int samples, vec2 xi, inout Sums sums) {
    SlabView view = receiver.view;
    Entry entry = first_cell_of_image(image);
    AxisBox x = entry_box_x(view, entry), y = entry_box_y(view, entry);
    vec2 e_lo = vec2(x.e_lo, y.e_lo), e_size = vec2(x.e_hi - x.e_lo, y.e_hi - y.e_lo);
    float area = e_size.x * view.x.t_scale * e_size.y * view.y.t_scale;
    AperturePoint at = aperture_at(view.x, view.y, e_lo + e_size * xi);
    ivec2 texel = ivec2(texel_at(view.x_texels, at.u_m.x, view.x.p, x),
                        texel_at(view.y_texels, at.u_m.y, view.y.p, y));
    float luminance = texel_luminance(image, texel.x, texel.y);
    add_sample(receiver, entry, texel, at,
               double(luminance) * double(delta2_or_1() * area / float(samples)), sums);
}

void add_pdis(Receiver receiver, int image, int samples, vec2 xi, inout Sums sums) {
    Entry entry = first_cell_of_image(image);
    AxisBox x = entry_box_x(receiver.view, entry), y = entry_box_y(receiver.view, entry);
    StoredCdf columns = stored_cdf(image, -1);
    TexelPick column = invert_cdf(columns, restrict_cdf(columns, x), xi.x, false, 0);
    StoredCdf rows = stored_cdf(image, max(column.texel, 0));
    TexelPick row = invert_cdf(rows, restrict_cdf(rows, y), xi.y, false, 0);
    if (min(column.texel, row.texel) < 0)
        return;
    BoxPick pick;
    pick.texel = ivec2(column.texel, row.texel);
    pick.fraction = vec2(column.fraction, row.fraction);
    pick.steps = 0;
    add_sample(receiver, entry, pick.texel, aperture_point(receiver.view, x, y, pick),
               double(abs(energy_of(image))) / double(samples), sums);
}

// Uniform and Pdis: so many samples of each image.
Sums draw_by_images(Receiver receiver, int count, vec2 shift) {
    Sums sums = no_light();
    int image = -1, samples = 0, q = 0;
    while (true) {
        while (q == samples && image < image_count()) {
            image += 1;
            samples = image < image_count() ? samples_of(energy_of(image), count) : 0;
            q = 0;
        }
        if (image == image_count())
            break;
        vec2 xi = plane_point(uint(SEQUENCE), uint(q), uint(samples), shift);
#if SAMPLER == UNIFORM
        add_uniform(receiver, image, samples, xi, sums);
#else
        add_pdis(receiver, image, samples, xi, sums);
#endif
        q += 1;
    }
    return sums;
}

Sums draw_set(Receiver receiver, int count, vec2 shift) {
#if SAMPLER == UNIFORM || SAMPLER == PDIS
    return draw_by_images(receiver, count, shift);
#elif SAMPLER == PRECOMPUTED
    return draw_precomputed(receiver, count, shift);
#else
    return draw_stratified(receiver, count, shift);
#endif
}
