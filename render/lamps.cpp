// SPDX-License-Identifier: Apache-2.0
#include "render/lamps.h"

#include "formats/files/error.h"
#include "formats/files/luminaire.h"
#include "formats/model/tables.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/beam.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

namespace nearfield::render {
namespace {

bool has_sigma(const LightField& lightfield) {
    return lightfield.scale_sigma_rel > 0.0 ||
           std::any_of(lightfield.slabs.begin(), lightfield.slabs.end(),
                       [](const Slab& slab) { return !slab.sigma.empty(); });
}

/// Tables are read where the file holds them and built where it does not.
Luminaire read_with_tables(const std::string& path) {
    if (read_kind(path).kind == "luminaire")
        return read_luminaire(path);
    return {read_lightfield(path), {}};
}

/// Luminance of three channels, or one channel as three equal ones.
void change_channels(Slab& slab, int channels) {
    if (slab.channels == channels)
        return;
    const std::size_t of_channel = slab.coeffs.size() / static_cast<std::size_t>(slab.channels);
    std::vector<float> y(slab.coeffs.begin(),
                         slab.coeffs.begin() + static_cast<std::ptrdiff_t>(of_channel));
    if (slab.channels == 3)
        for (std::size_t i = 0; i < of_channel; ++i)
            y[i] = shared::luminance709(
                {slab.coeffs[i], slab.coeffs[of_channel + i], slab.coeffs[2 * of_channel + i]});
    slab.coeffs = y;
    for (int c = 1; c < channels; ++c)
        slab.coeffs.insert(slab.coeffs.end(), y.begin(), y.end());
    slab.channels = channels;
}

/// Files' tables are of the channels that they hold.
void change_channels(Luminaire& luminaire, int channels) {
    for (Slab& slab : luminaire.lightfield.slabs) {
        if (slab.channels != channels)
            luminaire.tables.clear();
        change_channels(slab, channels);
    }
}

/// Multiplies the channels, of which there are three afterwards; the files' tables are of other
/// light then.
void tint(Luminaire& luminaire, glm::vec3 factors) {
    if (factors == glm::vec3(1.0F))
        return;
    luminaire.tables.clear();
    for (Slab& slab : luminaire.lightfield.slabs) {
        if (slab.channels == 1 && !slab.sigma.empty()) {
            const std::vector<float> of_y = slab.sigma;
            slab.sigma.insert(slab.sigma.end(), of_y.begin(), of_y.end());
            slab.sigma.insert(slab.sigma.end(), of_y.begin(), of_y.end());
        }
        change_channels(slab, 3);
        const std::size_t of_channel = slab.coeffs.size() / 3;
        for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
            slab.coeffs[i] *= factors[static_cast<int>(i / of_channel)];
        for (std::size_t i = 0; i < slab.sigma.size(); ++i)
            slab.sigma[i] *= factors[static_cast<int>(i / of_channel)];
    }
}

std::shared_ptr<const LoadedLightField> load(const LampFileKey& key, const LampParts& parts) {
    const std::string& path = key.path;
    Luminaire luminaire =
        parts.tables ? read_with_tables(path) : Luminaire{read_lightfield(path), {}};
    tint(luminaire, key.tint);
    auto loaded = std::make_shared<LoadedLightField>();
    if (parts.measured && has_sigma(luminaire.lightfield))
        loaded->measured = luminaire.lightfield;
    for (const Slab& slab : luminaire.lightfield.slabs)
        loaded->file_channels = std::max(loaded->file_channels, slab.channels);
    if (parts.channels > 0)
        change_channels(luminaire, parts.channels);
    if (parts.tables && luminaire.tables.empty())
        for (const Slab& slab : luminaire.lightfield.slabs)
            luminaire.tables.push_back(model::build_tables(slab));
    loaded->quantity = luminaire.lightfield.quantity;
    for (std::size_t s = 0; s < luminaire.lightfield.slabs.size(); ++s) {
        Slab& slab = luminaire.lightfield.slabs[s];
        slab.sigma.clear();
        if (parts.tables) {
            if (parts.mips)
                loaded->mips.push_back(model::prepare_mips(slab));
            loaded->sampling.push_back(
                model::prepare_sampling(std::move(slab), std::move(luminaire.tables[s])));
        } else if (parts.mips) {
            loaded->mips.push_back(model::prepare_mips(std::move(slab)));
        } else {
            loaded->prepared.push_back(model::prepare(std::move(slab)));
        }
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

PlacedSlab place(const LoadedLightField& file, std::size_t s, const LuminaireInstance& luminaire) {
    PlacedSlab placed;
    placed.mips = file.mips.empty() ? nullptr : &file.mips[s];
    placed.prepared = !file.sampling.empty()   ? &file.sampling[s].prepared
                      : placed.mips != nullptr ? &placed.mips->levels.front()
                                               : &file.prepared[s];
    const Rigid& pose = placed.prepared->slab.luminaire_from_slab;
    glm::dmat4 luminaire_from_slab(pose.rotation);
    luminaire_from_slab[3] = glm::dvec4(pose.translation_m, 1.0);
    placed.world_from_slab = luminaire.world_from_luminaire * luminaire_from_slab;
    placed.slab_from_world = glm::inverse(placed.world_from_slab);
    placed.slab_from_world_rotation = rotation_from_world(placed.world_from_slab, luminaire);
    const std::array<glm::dvec3, 4> corners = u_corners_m(beam_of(placed.prepared->slab));
    for (std::size_t c = 0; c < corners.size(); ++c)
        placed.u_corners_world_m[c] =
            glm::dvec3(placed.world_from_slab * glm::dvec4(corners[c], 1.0));
    return placed;
}

std::size_t slab_count(const LoadedLightField& file) {
    return std::max({file.prepared.size(), file.mips.size(), file.sampling.size()});
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

double bytes(const std::vector<float>& values) {
    return static_cast<double>(values.size() * sizeof(float));
}

double coefficient_bytes(const model::PreparedSlab& prepared) {
    return bytes(prepared.slab.coeffs) + bytes(prepared.tail);
}

double table_bytes(const SlabTables& tables) {
    double sum = bytes(tables.sat_hi) + bytes(tables.sat_lo) + bytes(tables.marginal_cdf) +
                 bytes(tables.conditional_cdf);
    for (const MipLevel& level : tables.mips)
        sum += bytes(level.coeffs);
    return sum;
}

std::set<const LoadedLightField*> files_of(const Lamps& lamps) {
    std::set<const LoadedLightField*> files;
    for (const Lamp& lamp : lamps.lamps)
        files.insert(lamp.file.get());
    return files;
}

LampFileKey key_of(const LuminaireInstance& luminaire) {
    LampFileKey key{luminaire.path, luminaire.tint};
    std::error_code failed;  // reading will say why
    const auto written = std::filesystem::last_write_time(luminaire.path, failed);
    key.modified_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(written.time_since_epoch()).count();
    key.size_bytes = std::filesystem::file_size(luminaire.path, failed);
    return key;
}

LampParts both(const LampParts& a, const LampParts& b) {
    return {a.tables || b.tables, a.mips || b.mips, a.measured || b.measured, b.channels};
}

void drop_unnamed(const Scene& scene, LampFiles& kept) {
    std::erase_if(kept.files, [&](const auto& file) {
        return std::none_of(
            scene.luminaires.begin(), scene.luminaires.end(),
            [&](const LuminaireInstance& luminaire) { return key_of(luminaire) == file.first; });
    });
}

std::shared_ptr<const LoadedLightField> find_or_load(const LampFileKey& key, LampFiles& kept) {
    for (const auto& [known, file] : kept.files)
        if (known == key)
            return file;
    return kept.files.emplace_back(key, load(key, kept.parts)).second;
}

}  // namespace

double coefficient_bytes(const Lamps& lamps) {
    double sum = 0.0;
    for (const LoadedLightField* file : files_of(lamps)) {
        for (const model::PreparedSlab& prepared : file->prepared)
            sum += coefficient_bytes(prepared);
        for (const model::PreparedMips& mips : file->mips)
            for (const model::PreparedSlab& level : mips.levels)
                sum += coefficient_bytes(level);
        for (const model::SamplingSlab& sampling : file->sampling)
            sum += coefficient_bytes(sampling.prepared);
    }
    return sum;
}

double table_bytes(const Lamps& lamps) {
    double sum = 0.0;
    for (const LoadedLightField* file : files_of(lamps))
        for (const model::SamplingSlab& sampling : file->sampling)
            sum += table_bytes(sampling.tables);
    return sum;
}

Lamps load_lamps(const Scene& scene, const LampParts& parts) {
    LampFiles files;
    return load_lamps(scene, parts, files);
}

Lamps load_lamps(const Scene& scene, const LampParts& parts, LampFiles& kept) {
    const LampParts all_parts = both(kept.parts, parts);
    if (!(all_parts == kept.parts))
        kept.files.clear();
    kept.parts = all_parts;
    drop_unnamed(scene, kept);
    Lamps result;
    MaskBits bits(scene);
    std::set<std::string> names;
    for (const LuminaireInstance& luminaire : scene.luminaires) {
        if (!luminaire.on || luminaire.dim == 0.0)
            continue;
        const std::shared_ptr<const LoadedLightField> file = find_or_load(key_of(luminaire), kept);
        if (!result.lamps.empty() && file->quantity != result.quantity)
            throw Error{"cannot mix light in lumens and in watts", luminaire.path,
                        "the other luminaires' quantity", "another"};
        result.quantity = file->quantity;
        Lamp lamp;
        lamp.name = layer_name(luminaire.name, names);
        lamp.dim = static_cast<float>(luminaire.dim);
        lamp.mask = bits.bit_of(luminaire);
        lamp.file = file;
        for (std::size_t s = 0; s < slab_count(*file); ++s)
            lamp.slabs.push_back(place(*file, s, luminaire));
        lamp.luminaire_from_world = glm::inverse(luminaire.world_from_luminaire);
        lamp.luminaire_from_world_rotation =
            rotation_from_world(luminaire.world_from_luminaire, luminaire);
        result.lamps.push_back(std::move(lamp));
    }
    result.instance_masks = bits.masks();
    return result;
}

}  // namespace nearfield::render
