// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/model/prepared.h"
#include "formats/scene/scene.h"
#include "render/cpu/tracer.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace nearfield::render {

/// A slab of a lamp in the scene. The scene's scale is in the matrices: in the slab's frame lengths
/// are the lamp's own.
struct PlacedSlab {
    std::shared_ptr<const model::PreparedSlab> prepared;
    glm::dmat4 slab_from_world{1.0}, world_from_slab{1.0};
    glm::dmat3 slab_from_world_rotation{1.0};  // orthonormal; mirrors where the lamp is mirrored
};

/// A lamp that is on.
struct Lamp {
    std::string name;  // unique within the scene, fit for a layer's name
    float dim = 1.0F;
    std::uint32_t mask = 0;  // of shadow rays
    std::vector<PlacedSlab> slabs;
    /// The light field as its file has it, for model::irradiance_sigma_y; empty where the file says
    /// nothing of its errors, or nobody asked. Lamps of one file share it.
    std::shared_ptr<const LightField> measured;
    glm::dmat4 luminaire_from_world{1.0};
    glm::dmat3 luminaire_from_world_rotation{1.0};
};

struct Lamps {
    std::vector<Lamp> lamps;
    std::vector<std::uint32_t> instance_masks;  // for Tracer: what stops which lamp's rays
    Quantity quantity = Quantity::Photometric;
};

/// Opens the light fields of the lamps that are on with dim > 0; one that several lamps name is
/// read once. keep_measured: fills Lamp::measured, at the price of a copy of each file's
/// coefficients. Throws Error if one cannot be read or if photometric and radiometric ones are
/// mixed.
Lamps load_lamps(const Scene& scene, bool keep_measured = false);

/// Unshadowed light of one lamp at several hits, slab by slab.
struct LightSums {
    struct OfSlab {
        std::vector<model::ReceiverF> receivers;  // [hit]
        std::vector<float> image_y;               // [hit][image]
        std::vector<float> y;                     // [hit], the sum of its image_y in order
    };
    std::vector<OfSlab> slabs;
    std::vector<glm::vec3> irradiance;  // [hit], without dim
    std::vector<float> total_y;         // [hit], sum of the slabs' y
    std::uint64_t multiply_adds = 0;    // of this call

    // Kept from call to call for its memory.
    std::vector<glm::vec3> of_one_slab;
};

/// Windowed sums of one lamp for all hits together: neighbors cost less that way.
void sum_light(const Lamp& lamp, std::span<const Hit> hits, LightSums& sums);

/// Buffers that shade() reuses from hit to hit, and what it counts.
struct Scratch {
    std::vector<glm::vec3> weights;  // [sample]
    std::vector<float> lobes;        // [sample], 0 where hidden
    std::vector<bool> visible;       // [sample]
    std::uint64_t shadow_rays = 0;
};

/// The light of one lamp at one camera hit.
struct LampLight {
    glm::vec3 irradiance{0.0F};
    glm::vec3 radiance{0.0F};       // towards the viewer
    float sigma_y = 0.0F;           // sampling standard deviation of radiance's luminance
    float sigma_measured_y = 0.0F;  // of the diffuse part, carried from the light field's file
};

struct ShadeQuery {
    const Hit& hit;
    glm::dvec3 to_viewer_world{0.0};  // unit length
    Reflectance reflectance;
    glm::uvec2 key{0};  // seeds: pixel and sample, lamp
    std::uint32_t seed = 0;
    int samples = 64;
};

/// Windowed sum times traced visibility (docs/scenes.md, "Estimator"); index: the hit's in sums.
LampLight shade(const Lamp& lamp,
                const Tracer& tracer,
                const ShadeQuery& query,
                const LightSums& sums,
                std::size_t index,
                Scratch& scratch);

}  // namespace nearfield::render
