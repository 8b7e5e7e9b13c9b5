// SPDX-License-Identifier: Apache-2.0
/// The light of one lamp at one camera hit, with visibility.
#pragma once

#include "formats/shared/brdf.glsl.h"
#include "formats/shared/frame.glsl.h"
#include "render/cpu/light_sums.h"
#include "render/cpu/tracer.h"
#include "render/sample_sets.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::render {

struct ShadeQuery {
    const Hit& hit;
    glm::dvec3 to_viewer_world{0.0};  // unit length
    const shared::Brdf& brdf;
    shared::SurfaceFrame frame;  // of the shading normal
    SampleSets sets;
    // What the samples' random numbers are for.
    glm::uvec2 pixel{0};
    std::uint32_t first_set = 0;  // of this camera sample and lamp
    std::uint32_t seed = 0;
    model::Shift shift = model::Shift::Random;
    bool has_shadows = true;  // false: light passes through everything, and no ray is traced
};

/// One slab's part in one hit's light, from which shadow samples are drawn.
struct SlabEnergy {
    model::ReceiverF receiver;
    std::span<const float> image_y;  // [image]
    float y = 0.0F;                  // the sum of image_y in order
};

/// A point on a lamp's U planes, and what it carries if it is visible.
struct LampPoint {
    glm::dvec3 position_world_m{0.0};
    glm::dvec3 weight{0.0};     // share of the unshadowed irradiance
    glm::dvec3 reflected{0.0};  // of glossy surfaces: times f_r
};

/// Buffers that are reused from hit to hit, and what is counted.
struct Scratch {
    std::vector<SetSums> sets;
    std::vector<LampPoint> points;            // of all sets, one after the other
    std::vector<char> is_visible;             // [point], or [sample] of a set
    std::vector<SlabEnergy> energies;         // [slab]
    std::vector<std::vector<float>> image_y;  // [slab][image]
    std::vector<model::SamplingView> views;   // [slab]
    std::vector<model::LightSample> samples;
    std::uint64_t shadow_rays = 0, sky_samples = 0;  // the environment's, filtered
    double shadow_rays_s = 0, gloss_s = 0;           // spent; the lobe's own rays are gloss
};

struct LampLight {
    glm::vec3 irradiance{0.0F};
    glm::vec3 radiance{0.0F};       // towards the viewer
    float variance_y = 0.0F;        // of radiance's luminance, by sampling
    float sigma_measured_y = 0.0F;  // of the diffuse part, carried from the light field's file
};

/// Windowed sum times traced visibility, for Lambert's surfaces; index: the hit's in sums.
LampLight shade_diffuse(const Lamp& lamp,
                        const Tracer& tracer,
                        const ShadeQuery& query,
                        const LightSums& sums,
                        std::size_t index,
                        Scratch& scratch);

/// Whether all slabs' texels resolve the lobe, so that shade_reflected is right.
bool resolves_lobe(const Lamp& lamp, const ShadeQuery& query);

/// The same for glossy surfaces: the windowed sum with f_r for every texel (glossy_sum.h).
LampLight shade_reflected(const Lamp& lamp,
                          const Tracer& tracer,
                          const ShadeQuery& query,
                          Scratch& scratch);

/// By samples of `sampler` (its own number of samples is ignored: the query says how many). The
/// diffuse part is the windowed sum times visibility where `sums` is given, else the plain mean;
/// the lobe's is multiple importance sampling of the lamp and of the lobe (gloss.h). The lamp's
/// file must be loaded with tables.
LampLight shade_sampled(const Lamp& lamp,
                        const Tracer& tracer,
                        const ShadeQuery& query,
                        const model::SamplerOptions& sampler,
                        const LightSums* sums,
                        std::size_t index,
                        Scratch& scratch);

// What the three share.

/// Whether the lamp's light reaches the hit from a point in the world; counts the shadow ray, where
/// the query has shadows.
bool is_visible(const Lamp& lamp,
                const Tracer& tracer,
                const ShadeQuery& query,
                glm::dvec3 from_world_m,
                Scratch& scratch);

/// Whether any of the lamp lies before the hit's triangle: what decides without shadows.
bool faces(const Lamp& lamp, const Hit& hit);

glm::vec2 shift_of_set(const ShadeQuery& query, int set, std::uint32_t seed);

glm::vec3 to_viewer_local(const ShadeQuery& query);

/// What turns irradiance into diffuse radiance: albedo / pi.
glm::vec3 diffuse_of(const ShadeQuery& query);

/// With the lamp's dim, and what its file says of its errors.
LampLight light_of(const Lamp& lamp,
                   const ShadeQuery& query,
                   const Estimated& estimate,
                   glm::vec3 unshadowed);

}  // namespace nearfield::render
