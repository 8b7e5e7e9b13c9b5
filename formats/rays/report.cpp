// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/report.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <cmath>

namespace nearfield::rays {
namespace {

const char* unit(const RaySet& set) {
    return set.quantity == Quantity::Photometric ? "lm" : "W";
}

// "(0 ... 12.3 deg from +z)", or nothing where nothing was dropped.
std::string angles(const AngleRange& range) {
    return range.least_deg > range.most_deg
               ? ""
               : fmt::format(" ({:.1f} ... {:.1f} deg from +z)", range.least_deg, range.most_deg);
}

std::string size(glm::ivec2 s) {
    return fmt::format("{}x{}", s.x, s.y);
}

template <typename T>
std::string or_automatic(const std::optional<T>& value) {
    if (!value)
        return "automatic";
    if constexpr (std::is_same_v<T, glm::ivec2>)
        return size(*value);
    else
        return fmt::format("{}", *value);
}

}  // namespace

void scale_to(RaySet& set, double total) {
    if (!(std::isfinite(total) && total > 0))
        throw Error{"bad flux", "--flux-lm", "> 0", fmt::format("{}", total)};
    const double scale = total / flux(set);
    for (Ray& ray : set.rays)
        ray.flux = static_cast<float>(ray.flux * scale);
    set.notes.push_back(fmt::format("scaled to {:.6g} {} as asked", total, unit(set)));
}

std::string summary(const RaySet& set, const ConvertReport& report) {
    const char* u = unit(set);
    std::string text = fmt::format(
        "{}: {} rays, {:.6g} {}; kept {:.6g} +- {:.2g} {}; dropped {:.4g} {} ({:.3f} %, {:.0f} "
        "rays): "
        "{:.4g} by direction{}, {:.4g} beside S{}, {:.4g} beside U{}\n",
        set.format, report.rays_in, report.flux_in, u, report.flux_out, report.sigma_flux, u,
        report.dropped(), u, 100.0 * report.dropped() / report.flux_in, report.rays_dropped,
        report.dropped_direction, angles(report.direction_angles), report.dropped_s,
        angles(report.s_angles), report.dropped_u, angles(report.u_angles));
    for (const SlabReport& slab : report.slabs)
        text += fmt::format(
            "slab {}: {} rays, {:.5g} {}; U at {:.3f} mm, S at {:.3f} mm; grid {} (a pitch is "
            "{:.1f} deg), texels {} of {:.3g} mm, kernel {:.2g} texels, {} blocks of directions: "
            "best held-out likelihood ({:.4f} + {:.4f} nats a ray); a texel's flux +- {:.1f} %\n",
            slab.axis, slab.rays, slab.flux, u, slab.u_plane_mm, slab.s_plane_mm,
            size(slab.directions.grid), slab.pitch_deg, size(slab.texels.texels), slab.texel_mm,
            slab.texels.kernel_texels, size(slab.directions.levels.back().blocks),
            slab.texels.held_out_nats, slab.directions.held_out_nats, 100.0 * slab.sigma_texel_rel);
    if (set.desaturated > 0)
        text += fmt::format("{} of {} colors lay outside Rec.709 and were moved towards white\n",
                            set.desaturated, set.colors.size());
    return text;
}

Provenance describe(const RaySet& set,
                    const ReadOptions& read,
                    const ConvertOptions& options,
                    std::optional<double> flux,
                    const ConvertReport& report) {
    Provenance p;
    p.program = program_version();
    p.command = "convert";
    p.options = {{"u_plane_mm", or_automatic(options.u_plane_mm)},
                 {"s_plane_mm", or_automatic(options.s_plane_mm)},
                 {"grid", or_automatic(options.grid)},
                 {"texels", or_automatic(options.texels)},
                 {"slabs", or_automatic(options.slabs)},
                 {"basis", options.basis},
                 {"color", options.color ? "true" : "false"},
                 {"seed", std::to_string(options.seed)},
                 {"flux", or_automatic(flux)},
                 {"keep_ray_flux", read.keep_ray_flux ? "true" : "false"},
                 {"keep_radiometric", read.keep_radiometric ? "true" : "false"}};
    const std::string u = set.quantity == Quantity::Photometric ? "_lm" : "_w";
    p.figures = {{"rays", static_cast<double>(report.rays_in)},
                 {"rays_dropped", report.rays_dropped},
                 {"flux_of_rays_in_file" + u, set.flux_of_rays},
                 {"flux_in" + u, report.flux_in},
                 {"flux_out" + u, report.flux_out},
                 {"flux_out_sigma" + u, report.sigma_flux},
                 {"flux_dropped" + u, report.dropped()},
                 {"flux_dropped_by_direction" + u, report.dropped_direction},
                 {"flux_dropped_beside_s" + u, report.dropped_s},
                 {"flux_dropped_beside_u" + u, report.dropped_u},
                 {"colors_desaturated", static_cast<double>(set.desaturated)},
                 // Subtract it from the ray file's z to get the luminaire's.
                 {"z_file_of_luminaire_origin_mm", report.slabs.front().s_plane_mm}};
    for (const SlabReport& slab : report.slabs) {
        const std::string name = "slab_" + slab.axis;
        p.figures.insert(
            p.figures.end(),
            {{name + "_u_plane_mm", slab.u_plane_mm},
             {name + "_s_plane_mm", slab.s_plane_mm},
             {name + "_flux" + u, slab.flux},
             {name + "_kernel_texels", slab.texels.kernel_texels},
             {name + "_held_out_nats", slab.texels.held_out_nats + slab.directions.held_out_nats},
             {name + "_texel_flux_sigma_rel", slab.sigma_texel_rel}});
    }
    return p;
}

}  // namespace nearfield::rays
