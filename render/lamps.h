// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/model/mip_sum.h"
#include "formats/model/sampler.h"
#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::render {

/// What is read of lamps' files beyond their coefficients.
struct LampParts {
    bool tables = false;    // samplers read them; built where a file is packed lean
    bool mips = false;      // sums on coarser images
    bool measured = false;  // a copy of each file's coefficients with their sigmas
    /// 1: luminance alone; 3: three channels, equal ones where the file has one; 0: as the file
    /// has.
    int channels = 0;

    bool operator==(const LampParts&) const = default;
};

/// A light field, read once however many lamps name it. Of the three only what was asked for:
/// every slab is in one of them at least.
struct LoadedLightField {
    std::vector<model::PreparedSlab> prepared;
    std::vector<model::PreparedMips> mips;
    std::vector<model::SamplingSlab> sampling;
    std::optional<LightField> measured;  // where asked for and the file knows its errors
    Quantity quantity = Quantity::Photometric;
    int file_channels = 1;  // of the file's slabs, the most; the slabs' own are as asked for
};

/// A slab of a lamp in the scene. The scene's scale is in the matrices: in the slab's frame lengths
/// are the lamp's own.
struct PlacedSlab {
    const model::PreparedSlab* prepared = nullptr;
    const model::PreparedMips* mips = nullptr;  // null unless asked for
    glm::dmat4 slab_from_world{1.0}, world_from_slab{1.0};
    glm::dmat3 slab_from_world_rotation{1.0};  // orthonormal; mirrors where the lamp is mirrored
    std::array<glm::dvec3, 4> u_corners_world_m{};  // of the rectangle that light leaves U through
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

/// What a light field was read from, and how.
struct LampFileKey {
    std::string path;
    glm::vec3 tint{1.0F};
    std::int64_t modified_ns = 0;  // a file that has been written again is read again
    std::uintmax_t size_bytes = 0;

    bool operator==(const LampFileKey&) const = default;
};

/// Light fields that stay loaded from one picture to the next.
struct LampFiles {
    LampParts parts;  // that each of them has
    std::vector<std::pair<LampFileKey, std::shared_ptr<const LoadedLightField>>> files;
};

/// Opens the light fields of the lamps that are on with dim > 0; one that several lamps name is
/// read once. Throws Error if one cannot be read or if photometric and radiometric ones are mixed.
Lamps load_lamps(const Scene& scene, const LampParts& parts = {});
/// The same with what is in `kept` and still holds; keeps what it reads there, with the parts that
/// were ever asked for, and drops what no lamp of the scene names, on or off.
Lamps load_lamps(const Scene& scene, const LampParts& parts, LampFiles& kept);

/// Memory of the coefficients, those of mips included, and of tables. A file counts once.
double coefficient_bytes(const Lamps& lamps);
double table_bytes(const Lamps& lamps);

}  // namespace nearfield::render
