// SPDX-License-Identifier: Apache-2.0
#include "fit/rectify_capture.h"

#include "fit/lit_region.h"
#include "fit/replicates.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "formats/model/overlap.h"
#include "formats/model/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

Slab planes_of(const rig::Rig& rig,
               const CaptureFitOptions& options,
               const Extent& extent,
               int channels) {
    Slab slab;
    slab.delta_m = rig.planes->delta_m;
    slab.grid = rig.planes->grid;
    slab.pitch_m = rig.planes->pitch_m;
    slab.s_min_m = extent.min_m;
    slab.s_max_m = extent.max_m;
    constexpr int kMostTexels = 512;
    slab.texels = options.texels ? *options.texels : matching_texels(rig, extent, kMostTexels);
    slab.profile = model::make_profile(options.basis);
    slab.weighting = options.weighting;
    slab.channels = channels;
    return slab;
}

Optics optics_of(const rig::Rig& rig, const std::vector<PositionFrames>& positions) {
    Optics optics;
    for (const PositionFrames& position : positions)
        optics.position_m.push_back(rig.planes->position_m[static_cast<std::size_t>(
            position.position.y * rig.planes->grid.x + position.position.x)]);
    optics.filter_x = optics.filter_y = rig.radiometry->filter_profile;
    optics.filter_pitch_m = rig.radiometry->filter_pitch_m;
    optics.filter_slope = {-std::tan(rig.planes->u_tilt_rad.y), std::tan(rig.planes->u_tilt_rad.x)};
    return optics;
}

// Merges and rectifies position by position.
void put_positions(const Measurement& measurement,
                   const std::vector<PositionFrames>& positions,
                   const LampDrift& drift,
                   const Rectifier& rectifier,
                   const CaptureFitOptions& options,
                   MeasuredTexels& texels,
                   CaptureFit& fit) {
    std::size_t saturated = 0, pixels = 0;
    double chi_square = 0;
    const auto count = static_cast<double>(positions.size());
    for (std::size_t k = 0; k < positions.size(); ++k) {
        const MergedImage image = position_light(measurement, positions[k], drift);
        saturated += image.saturated_count;
        pixels += image.light_dn_per_s.size();
        chi_square += image.chi_square_mean / count;
        texels.put(static_cast<int>(k), rectifier.rectified(image));
        if (options.progress)
            options.progress(kMergeShare * static_cast<double>(k + 1) / count,
                             fmt::format("position {} of {}", k + 1, positions.size()));
    }
    fit.saturated_share = static_cast<double>(saturated) / static_cast<double>(pixels);
    fit.exposure_chi_square = chi_square;
}

// From the first frame to the last.
double duration_s(const capture::Capture& capture) {
    double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;
    for (const auto& [number, frame] : capture.frames) {
        first_s = std::min(first_s, time_s(frame));
        last_s = std::max(last_s, time_s(frame));
    }
    return last_s > first_s ? last_s - first_s : 0.0;
}

void check_positions(const Measurement& measurement, const std::vector<PositionFrames>& positions) {
    constexpr std::size_t kLeast = 4;
    if (positions.size() < kLeast)
        throw Error{"too few positions", measurement.folder, fmt::format("at least {}", kLeast),
                    fmt::format("{}", positions.size())};
    if (measurement.rig.radiometry->filter_profile.cells.empty())
        throw Error{"the filter's profile is not known", "rig",
                    "radiometry.filter_profile: calibrate with views of the filter", "none"};
}

MeasuredTexels measured_texels(const Measurement& measurement,
                               const CaptureFitOptions& options,
                               const Slab& planes,
                               int positions,
                               std::vector<BlockedLight> blocked) {
    const rig::Radiometry& radiometry = *measurement.rig.radiometry;
    const double overlap = model::overlap(radiometry.filter_profile);
    const int only = raw_colors(radiometry) == 1 ? 0 : 1;  // luminance: green, nearly
    std::vector<double> peak;
    for (int channel = 0; channel < planes.channels; ++channel)
        peak.push_back(radiometry.filter_peak[planes.channels == 3 ? channel : only]);
    return {options.spool_folder, planes.texels,     positions,
            std::move(blocked),   overlap * overlap, std::move(peak)};
}

}  // namespace

RectifiedCapture rectify_capture(const Measurement& measurement, const CaptureFitOptions& options) {
    check_rig(measurement);
    const rig::Rig& rig = measurement.rig;
    const std::vector<PositionFrames> positions = positions_of(measurement.capture);
    check_positions(measurement, positions);
    CaptureFit seen;
    seen.positions = static_cast<int>(positions.size());
    seen.missing_positions = rig.planes->grid.x * rig.planes->grid.y - seen.positions;

    seen.capture_s = duration_s(measurement.capture);

    const double start_s = now_s();
    const LampDrift drift(measurement);
    seen.drift_rel = drift.largest_rel();
    const LitRegion lit =
        lit_region(measurement, positions, drift, options.extent, options.dark_share);
    seen.outside_share = lit.outside_share;
    const int channels = options.wants_color && raw_colors(*rig.radiometry) == 3 ? 3 : 1;
    Slab planes = planes_of(rig, options, lit.extent, channels);
    const Rectifier rectifier(measurement, planes, channels);
    seen.texel_cells_least = rectifier.texel_cells_least();
    seen.resolution_m =
        std::max(planes.texel_m().x, planes.texel_m().y) / std::min(1.0, seen.texel_cells_least);
    std::vector<BlockedLight> blocked = blocked_light(measurement, drift, rectifier, planes.texels);
    for (const BlockedLight& channel : blocked)
        seen.beside_filter.push_back({channel.mean_lx, channel.sigma_lx, channel.chi_square});
    const Optics optics = optics_of(rig, positions);
    RectifiedCapture rectified{
        planes,
        optics,
        measured_texels(measurement, options, planes, seen.positions, std::move(blocked)),
        {},
        std::hypot(rig.radiometry->scale_sigma_rel, rig.radiometry->scale_systematic_rel),
        {}};
    for (int r = 0; r < options.replicates; ++r)
        rectified.drawn_optics.push_back(
            drawn_optics(optics, rig, {options.seed, static_cast<std::uint32_t>(r)}));
    put_positions(measurement, positions, drift, rectifier, options, rectified.texels, seen);
    seen.merge_s = now_s() - start_s;
    rectified.seen = std::move(seen);
    return rectified;
}

}  // namespace nearfield::fit
