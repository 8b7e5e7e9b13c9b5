// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/ray_file.h"

#include "formats/files/error.h"
#include "formats/rays/lighttools.h"
#include "formats/rays/speos.h"
#include "formats/rays/tm25.h"
#include "formats/rays/zemax.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::rays {
namespace {

struct Format {
    bool (*is_it)(ByteReader&);
    RayLayout (*read_header)(ByteReader&);
};

// Those with an identifier first; Speos' has none and is recognized by what its numbers can be.
constexpr std::array<Format, 6> kFormats = {{
    {is_tm25, read_tm25_header},
    {is_zemax_binary, read_zemax_header},
    {is_lighttools_binary, read_lighttools_header},
    {is_lighttools_text, read_lighttools_text_header},
    {is_zemax_text, read_zemax_text_header},
    {is_speos, read_speos_header},
}};

RayLayout read_header(ByteReader& file) {
    if (file.size() == 0)
        throw Error{"ray file is truncated", file.at(0), "a ray file", "no bytes"};
    for (const Format& format : kFormats)
        if (format.is_it(file)) {
            RayLayout layout = format.read_header(file);
            // A shift that is no number, or beyond any lamp, would make rays of the same kind.
            constexpr double kFarthest_m = 1e6;
            if (!(glm::length(layout.origin_m) < kFarthest_m))
                throw Error{"bad origin in ray file", file.at(0), "within 1e6 m",
                            fmt::format("{:g} m", glm::length(layout.origin_m))};
            file.seek(layout.data_byte);
            return layout;
        }
    throw Error{"not a ray file", file.at(0),
                "IES TM-25 ('TM25'), Zemax, LightTools ('LTRF' or text) or Speos", "none of them"};
}

// Scales the rays to the total that the header states, if it does.
void scale_to_header(const RayLayout& layout,
                     const RayDecoder& decoder,
                     double stored_flux,
                     const ReadOptions& options,
                     RaySet& set) {
    const bool luminous = set.quantity == Quantity::Photometric;
    const auto is_stated = [](double value) { return std::isfinite(value) && value > 0; };
    double stated = luminous ? layout.luminous_flux_lm : layout.radiant_flux_w;
    if (decoder.to_luminous()) {
        set.notes.emplace_back("radiant flux was turned into luminous flux by the file's spectra");
        if (!is_stated(stated) && is_stated(layout.radiant_flux_w))
            stated = layout.radiant_flux_w * set.flux_of_rays / stored_flux;
    }
    if (!is_stated(stated))
        return;
    set.flux_stated = stated;
    // 1e-5: a sum of 100,000 floats may be off by this much without being another number.
    if (std::abs(stated - set.flux_of_rays) <= 1e-5 * stated)
        return;
    const char* unit = luminous ? "lm" : "W";
    set.notes.push_back(fmt::format(
        "rays sum to {:.6g} {}, the header states {:.6g} {}: {}", set.flux_of_rays, unit, stated,
        unit, options.keep_ray_flux ? "kept the rays' sum" : "scaled to the header"));
    if (options.keep_ray_flux)
        return;
    const double scale = stated / set.flux_of_rays;
    for (Ray& ray : set.rays)
        ray.flux = static_cast<float>(ray.flux * scale);
}

}  // namespace

RayFile::RayFile(const std::string& path, bool keep_radiometric)
    : bytes_(path),
      layout_(read_header(bytes_)),
      reader_(bytes_, layout_),
      decoder_(layout_, keep_radiometric) {}

bool RayFile::next(RayChunk& chunk) {
    reader_.next(rows_);
    decoder_.decode(rows_, reader_, chunk);
    return rows_.count > 0;
}

double RayFile::fraction() const {
    return static_cast<double>(bytes_.position()) / static_cast<double>(bytes_.size());
}

double flux(const RaySet& set) {
    double sum = 0.0;
    for (const Ray& ray : set.rays)
        sum += ray.flux;
    return sum;
}

RaySet read_rays(const std::string& path, const ReadOptions& options) {
    RayFile file(path, options.keep_radiometric);
    const RayLayout& layout = file.layout();
    RaySet set;
    set.format = layout.format;
    set.quantity = file.decoder().quantity();
    set.notes = layout.notes;
    if (!layout.is_text)  // a line of text may promise anything
        set.rays.reserve(layout.ray_count);
    for (const UnitColor& color : file.decoder().shared_color()) {
        set.colors.emplace_back(color.rgb);
        set.desaturated += color.desaturated ? 1 : 0;
    }
    double stored_flux = 0;
    for (RayChunk chunk; file.next(chunk);) {
        set.rays.insert(set.rays.end(), chunk.rays.begin(), chunk.rays.end());
        set.colors.insert(set.colors.end(), chunk.colors.begin(), chunk.colors.end());
        set.flux_of_rays += chunk.flux;
        stored_flux += chunk.stored_flux;
        set.desaturated += chunk.desaturated;
        if (options.progress)
            options.progress(file.fraction());
    }
    if (!(set.flux_of_rays > 0 && std::isfinite(set.flux_of_rays)))
        throw Error{"ray file without light", path, "a sum of flux > 0",
                    fmt::format("{}", set.flux_of_rays)};
    scale_to_header(layout, file.decoder(), stored_flux, options, set);
    for (std::size_t r = 0; r < set.rays.size(); ++r)
        if (!std::isfinite(set.rays[r].flux))
            throw Error{"flux too large", fmt::format("{}, ray {}", path, r), "a finite number"};
    return set;
}

}  // namespace nearfield::rays
