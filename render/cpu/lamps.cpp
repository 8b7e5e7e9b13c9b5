// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/lamps.h"

#include "formats/files/error.h"
#include "formats/files/lightfield.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace nearfield::render {
namespace {

using PreparedSlabs = std::vector<std::shared_ptr<const model::PreparedSlab>>;

struct LoadedLightField {
    PreparedSlabs slabs;
    std::shared_ptr<const LightField> measured;
    Quantity quantity = Quantity::Photometric;
};

bool has_sigma(const LightField& lightfield) {
    return lightfield.scale_sigma_rel > 0.0 ||
           std::any_of(lightfield.slabs.begin(), lightfield.slabs.end(),
                       [](const Slab& slab) { return !slab.sigma.empty(); });
}

LoadedLightField load(const std::string& path, bool keep_measured) {
    LightField lightfield = read_lightfield(path);
    LoadedLightField loaded;
    if (keep_measured && has_sigma(lightfield))
        loaded.measured = std::make_shared<const LightField>(lightfield);
    loaded.quantity = lightfield.quantity;
    for (Slab& slab : lightfield.slabs) {
        slab.sigma.clear();
        loaded.slabs.push_back(
            std::make_shared<const model::PreparedSlab>(model::prepare(std::move(slab))));
    }
    return loaded;
}

// How directions of the world turn into a frame that the luminaire's matrix scales: a rotation,
// mirrored or not, times a scale, whose inverse without the scale is the transpose.
glm::dmat3 rotation_from_world(const glm::dmat4& world_from_frame,
                               const LuminaireInstance& luminaire) {
    const double scale = std::abs(uniform_scale(luminaire.world_from_luminaire, luminaire.name));
    return glm::transpose(glm::dmat3(world_from_frame)) / scale;
}

PlacedSlab place(std::shared_ptr<const model::PreparedSlab> prepared,
                 const LuminaireInstance& luminaire) {
    PlacedSlab placed;
    const Rigid& pose = prepared->slab.luminaire_from_slab;
    glm::dmat4 luminaire_from_slab(pose.rotation);
    luminaire_from_slab[3] = glm::dvec4(pose.translation_m, 1.0);
    placed.world_from_slab = luminaire.world_from_luminaire * luminaire_from_slab;
    placed.slab_from_world = glm::inverse(placed.world_from_slab);
    placed.slab_from_world_rotation = rotation_from_world(placed.world_from_slab, luminaire);
    placed.prepared = std::move(prepared);
    return placed;
}

/// A dot would nest layers.
std::string layer_name(const std::string& name, std::set<std::string>& taken) {
    std::string base = name.empty() ? "luminaire" : name;
    std::replace(base.begin(), base.end(), '.', '_');
    std::string unique = base;
    for (int i = 2; !taken.insert(unique).second; ++i)
        unique = fmt::format("{}_{}", base, i);
    return unique;
}

/// One ray mask bit for every different set of excluded instances.
class MaskBits {
  public:
    explicit MaskBits(const Scene& scene) : scene_(scene), masks_(scene.instances.size(), 0U) {}

    std::uint32_t bit_of(const LuminaireInstance& luminaire) {
        std::vector<bool> excluded;
        for (const Instance& instance : scene_.instances)
            excluded.push_back(is_excluded(scene_, luminaire, instance));
        const auto [found, is_new] = bits_.try_emplace(excluded, 0U);
        if (is_new) {
            if (bits_.size() > 31)
                throw Error{"too many different lists of excludes", luminaire.name, "at most 31",
                            "more"};
            found->second = 1U << (bits_.size() - 1);
            for (std::size_t i = 0; i < excluded.size(); ++i)
                masks_[i] |= excluded[i] ? 0U : found->second;
        }
        return found->second;
    }

    /// Every instance also has the last bit, so that camera rays meet even what no lamp's light
    /// stops at.
    std::vector<std::uint32_t> masks() const {
        std::vector<std::uint32_t> result = masks_;
        for (std::uint32_t& mask : result)
            mask |= 1U << 31U;
        return result;
    }

  private:
    const Scene& scene_;
    std::map<std::vector<bool>, std::uint32_t> bits_;
    std::vector<std::uint32_t> masks_;
};

}  // namespace

Lamps load_lamps(const Scene& scene, bool keep_measured) {
    Lamps result;
    MaskBits bits(scene);
    std::map<std::string, LoadedLightField> files;
    std::set<std::string> names;
    for (const LuminaireInstance& luminaire : scene.luminaires) {
        if (!luminaire.on || luminaire.dim == 0.0)
            continue;
        auto found = files.find(luminaire.path);
        if (found == files.end())
            found = files.emplace(luminaire.path, load(luminaire.path, keep_measured)).first;
        if (!result.lamps.empty() && found->second.quantity != result.quantity)
            throw Error{"cannot mix light in lumens and in watts", luminaire.path,
                        "the other luminaires' quantity", "another"};
        result.quantity = found->second.quantity;
        Lamp lamp;
        lamp.name = layer_name(luminaire.name, names);
        lamp.dim = static_cast<float>(luminaire.dim);
        lamp.mask = bits.bit_of(luminaire);
        for (const auto& prepared : found->second.slabs)
            lamp.slabs.push_back(place(prepared, luminaire));
        lamp.measured = found->second.measured;
        lamp.luminaire_from_world = glm::inverse(luminaire.world_from_luminaire);
        lamp.luminaire_from_world_rotation =
            rotation_from_world(luminaire.world_from_luminaire, luminaire);
        result.lamps.push_back(std::move(lamp));
    }
    result.instance_masks = bits.masks();
    return result;
}

}  // namespace nearfield::render
