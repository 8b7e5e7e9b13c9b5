// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/model/mip_sum.h"
#include "formats/model/sampler.h"
#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nearfield::render {

/// What a picture needs of its lamps' files beyond their coefficients.
struct LampNeeds {
    bool tables = false;    // samplers read them; built where a file is packed lean
    bool mips = false;      // sums on coarser images
    bool measured = false;  // a copy of each file's coefficients with their sigmas
};

/// A light field, read once however many lamps name it. Of the three only what was asked for:
/// every slab is in one of them at least.
struct LoadedLightField {
    std::vector<model::PreparedSlab> prepared;
    std::vector<model::PreparedMips> mips;
    std::vector<model::SamplingSlab> sampling;
    std::optional<LightField> measured;  // where asked for and the file knows its errors
    Quantity quantity = Quantity::Photometric;
};

/// A slab of a lamp in the scene. The scene's scale is in the matrices: in the slab's frame lengths
/// are the lamp's own.
struct PlacedSlab {
    const model::PreparedSlab* prepared = nullptr;
    const model::PreparedMips* mips = nullptr;  // null unless asked for
    glm::dmat4 slab_from_world{1.0}, world_from_slab{1.0};
    glm::dmat3 slab_from_world_rotation{1.0};  // orthonormal; mirrors where the lamp is mirrored
};

/// A lamp that is on.
struct Lamp {
    std::string name;  // unique within the scene, fit for a layer's name
    float dim = 1.0F;
    std::uint32_t mask = 0;  // of shadow rays
    std::shared_ptr<const LoadedLightField> file;
    std::vector<PlacedSlab> slabs;
    glm::dmat4 luminaire_from_world{1.0};
    glm::dmat3 luminaire_from_world_rotation{1.0};
};

struct Lamps {
    std::vector<Lamp> lamps;
    std::vector<std::uint32_t> instance_masks;  // for Tracer: what stops which lamp's rays
    Quantity quantity = Quantity::Photometric;
};

/// Opens the light fields of the lamps that are on with dim > 0; one that several lamps name is
/// read once. Throws Error if one cannot be read or if photometric and radiometric ones are mixed.
Lamps load_lamps(const Scene& scene, const LampNeeds& needs = {});

}  // namespace nearfield::render
