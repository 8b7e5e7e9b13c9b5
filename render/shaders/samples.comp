// SPDX-License-Identifier: Apache-2.0
// Adds the light of one slab by samples, drawn by the energies of samples_energy.comp in the same
// independent sets with the same random numbers as render/cpu/shade_samples.cpp. Visibility is that
// of U's cells (shadows.glsl).
//
// HAS_GLOSS: glossy lobes too, by lamp and lobe samples. GLOSS_ONLY: those alone.
#include "render/shaders/samples_view.glsl"
#include "render/shaders/shadows.glsl"
#include "render/shaders/surface.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform restrict image2D lamp_light;
layout(binding = 1, rgba32f) uniform restrict image2D lamp_irradiance;
layout(binding = 14) uniform sampler2D blue_noise;
// Radiance's luminance by each set, over the slabs so far.
layout(std430, binding = 7) restrict buffer SetLuminances { float set_luminances[]; };  // [set][pixel]

layout(location = 0) uniform float dim;
layout(location = 3) uniform ivec4 drawing;  // samples, sets, k_max
layout(location = 4) uniform uvec2 random;   // first set, seed

const int kMostSets = 4;
const float kInversePiF = 0.31830988618;

// A shaded point with what its samples need.
struct Receiver {
    SlabView view;
    vec3 position_m, normal;  // world
    SurfaceFrame frame;
    vec3 to_viewer;           // local
    Brdf brdf;
    bool is_glossy;
    float lamp_total;
    int set_samples;          // asked for in this set
    float samples_drawn;      // Uniform and Pdis: of the lamp, in this set
};

struct Sums {
    vec3 lit;        // irradiance
    vec3 reflected;  // radiance by the glossy lobe
};
Sums no_light() {
    Sums sums;
    sums.lit = vec3(0.0);
    sums.reflected = vec3(0.0);
    return sums;
}

float visibility_of(Receiver receiver, vec2 u_m) {
    vec2 first = vec2(cell_edge_m(0, 0), cell_edge_m(1, 0));
    ivec2 cells = slab.grid_texels.xy + cell_count() - 1;
    ivec2 cell = clamp(ivec2(floor((u_m - first) / slab.pitch_delta_m.xy)), ivec2(0), cells - 1);
    return cell_visibility(cell, receiver.position_m, receiver.normal);
}

#ifdef HAS_GLOSS
#include "render/shaders/samples_gloss.glsl"
#endif

// share: of the lamp's energy that the sample stands for, times what its density leaves over.
void add_sample(Receiver receiver,
                Entry entry,
                ivec2 texel,
                AperturePoint at,
                double share,
                inout Sums sums) {
    float cosine = max(kernel_cosine(receiver.view.normal, at.t), 0.0);
    float kernel = light_kernel(basis_at(entry.basis, at.u_m), cosine, at.t, has_radiance_weighting());
    if (!(kernel > 0.0))
        return;
    float weight = float(min(share * double(kernel), double(3.402823e38)));
    vec3 light = color_of_texel(entry.image, texel) * weight * visibility_of(receiver, at.u_m);
    sums.lit += light;
#ifdef HAS_GLOSS
    if (receiver.is_glossy)
        sums.reflected += light * weighted_lobe(receiver, at.u_m);
#endif
}

#include "render/shaders/samples_draw.glsl"

vec2 shift_of_set(uint set, uint seed) {
    if (SHIFT == kShiftConstant)
        return r2_point(set, uvec2(0u));
    ivec2 pixel = band_pixel();
    vec2 noise = SHIFT == kShiftBlueNoise ? texelFetch(blue_noise, pixel % 64, 0).rg : vec2(0.0);
    return pixel_shift(uint(SHIFT), uvec2(pixel), set, seed, noise);
}

int size_of_set(int set) { return drawing.x / drawing.y + (set < drawing.x % drawing.y ? 1 : 0); }

float luminance_of(vec3 rgb) { return dot(rgb, vec3(0.2126, 0.7152, 0.0722)); }

// Of the mean of all sets, from their spread.
float variance_of_sets(float luminance[kMostSets]) {
    float mean = 0.0, squares = 0.0, samples = float(drawing.x), sets = float(drawing.y);
    for (int set = 0; set < drawing.y; ++set)
        mean += luminance[set] * (float(size_of_set(set)) / samples);
    for (int set = 0; set < drawing.y; ++set) {
        float deviation = (luminance[set] - mean) * (float(size_of_set(set)) / samples);
        squares += deviation * deviation;
    }
    return drawing.y > 1 ? squares * sets / (sets - 1.0) : 0.0;
}

Receiver receiver_at(Surface surface) {
    Receiver receiver;
    receiver.view = slab_view(surface.position_m, surface.normal);
    receiver.position_m = surface.position_m;
    receiver.normal = surface.normal;
    receiver.frame = frame_of(surface);
    receiver.to_viewer = local_from_world(receiver.frame, surface.to_viewer);
    receiver.brdf = brdf_of(surface);
    receiver.is_glossy = brdf_is_glossy(receiver.brdf);
    receiver.lamp_total = float(running_total(part.w));
    receiver.set_samples = 0;
    receiver.samples_drawn = 0.0;
    return receiver;
}

Sums light_of_set(Receiver receiver, int set) {
    int count = size_of_set(set);
    uint number = random.x + uint(set);
#ifdef HAS_GLOSS
    receiver.set_samples = count;
    receiver.samples_drawn = samples_of_lamp(count);
#endif
    Sums sums = draw_set(receiver, count, shift_of_set(number, random.y));
#ifdef HAS_GLOSS
    sums.reflected += lobe_samples(receiver, count, shift_of_set(number, random.y ^ kLobeSeed));
#endif
    return sums;
}

void main() {
    if (!is_in_band())
        return;
    ivec2 pixel = band_pixel();
    int at = index_in_band();
    Surface surface = surface_at(pixel);
    if (surface.material < 0)
        return;
    Receiver receiver = receiver_at(surface);
    vec3 diffuse = brdf_diffuse(receiver.brdf, receiver.to_viewer) * kInversePiF;
    bool is_drawn = running_total(part.w) > 0.0;
#ifdef GLOSS_ONLY
    diffuse = vec3(0.0);
    is_drawn = is_drawn && receiver.is_glossy;
#endif
    Sums mean = no_light();
    float luminance[kMostSets];
    for (int set = 0; set < kMostSets; ++set)
        luminance[set] = 0.0;
    for (int set = 0; set < drawing.y && is_drawn; ++set) {
        Sums sums = light_of_set(receiver, set);
        float share = float(size_of_set(set)) / float(drawing.x);
        mean.lit += sums.lit * share;
        mean.reflected += sums.reflected * share;
        luminance[set] = dim * luminance_of(diffuse * sums.lit + sums.reflected);
    }
    if (part.w > 1)
        for (int set = 0; set < drawing.y; ++set) {
            if (part.z > 0)
                luminance[set] += set_luminances[set * band.w + at];
            set_luminances[set * band.w + at] = luminance[set];
        }
    vec4 light = vec4(dim * (diffuse * mean.lit + mean.reflected), 0.0);
    light.a = part.z + 1 == part.w ? variance_of_sets(luminance) : 0.0;
    imageStore(lamp_light, pixel, imageLoad(lamp_light, pixel) + light);
#ifndef GLOSS_ONLY
    imageStore(lamp_irradiance, pixel,
               imageLoad(lamp_irradiance, pixel) + vec4(dim * mean.lit, 0.0));
#endif
}
