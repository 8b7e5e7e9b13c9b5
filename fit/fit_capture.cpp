// SPDX-License-Identifier: Apache-2.0
#include "fit/fit_capture.h"

#include "fit/texel_spool.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "formats/model/profile.h"
#include "formats/rig/curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

namespace nearfield::fit {
namespace {

constexpr double kMergeShare = 0.7;  // of the progress
constexpr float kMissing = std::numeric_limits<float>::infinity();

int raw_colors(const rig::Radiometry& radiometry) {
    return radiometry.mosaic == "mono" ? 1 : 3;
}

// The positions that show where light is at all: middle, corners and middles of the edges.
std::vector<PositionFrames> looks_of(const std::vector<PositionFrames>& positions,
                                     glm::ivec2 grid) {
    std::vector<PositionFrames> looks;
    for (const PositionFrames& position : positions) {
        const auto is_look = [](int at, int count) {
            return at == 0 || at == count - 1 || at == count / 2;
        };
        if (is_look(position.position.x, grid.x) && is_look(position.position.y, grid.y))
            looks.push_back(position);
    }
    return looks.empty() ? positions : looks;
}

// Light of several positions together, pixel by pixel; NaN where one of them is not known.
std::vector<float> light_of_looks(const Measurement& measurement,
                                  const std::vector<PositionFrames>& looks,
                                  const LampDrift& drift) {
    std::vector<float> light;
    for (const PositionFrames& look : looks) {
        const MergedImage image = position_light(measurement, look, drift);
        light.resize(image.light_dn_per_s.size(), 0.0F);
        for (std::size_t k = 0; k < light.size(); ++k)
            light[k] += std::isinf(image.variance[k]) ? std::nanf("") : image.light_dn_per_s[k];
    }
    return light;
}

double share_outside(const rig::Rig& rig, const Extent& extent, const std::vector<float>& light) {
    std::vector<glm::dvec2> outline_px;
    for (const glm::dvec2 corner_m : {extent.min_m, glm::dvec2(extent.max_m.x, extent.min_m.y),
                                      extent.max_m, glm::dvec2(extent.min_m.x, extent.max_m.y)})
        if (const auto at_px = seen_px(rig, corner_m))
            outline_px.push_back(*at_px);
    if (outline_px.size() < 4)
        return 0;
    const auto is_inside = [&](glm::dvec2 at_px) {
        int side = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const glm::dvec2 along = outline_px[(k + 1) % 4] - outline_px[k],
                             to = at_px - outline_px[k];
            side += along.x * to.y - along.y * to.x > 0 ? 1 : -1;
        }
        return side == 4 || side == -4;
    };
    const auto width = static_cast<std::size_t>(rig.lens->size_px.x);
    double inside = 0, all = 0;
    for (std::size_t k = 0; k < light.size(); ++k) {
        if (!std::isfinite(light[k]))
            continue;
        all += double(light[k]);
        const std::size_t row = k / width;
        if (is_inside({static_cast<double>(k % width) + 0.5, static_cast<double>(row) + 0.5}))
            inside += double(light[k]);
    }
    return all > 0 ? std::max(0.0, 1 - inside / all) : 0;
}

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

// Light in DN/s of a texel to lux: scale over the screen's luminance factor, [j][i].
std::vector<float> lux_factors(const rig::Rig& rig, const Slab& planes) {
    const Rigid& camera_from_slab = rig.planes->camera_from_slab;
    const glm::dvec3 camera_m =
        -(glm::transpose(camera_from_slab.rotation) * camera_from_slab.translation_m);
    std::vector<float> factors;
    factors.reserve(planes.texel_count());
    for (int j = 0; j < planes.texels.y; ++j)
        for (int i = 0; i < planes.texels.x; ++i) {
            const glm::dvec2 s_m = planes.s_min_m + (glm::dvec2(i, j) + 0.5) * planes.texel_m();
            const glm::dvec3 to_camera = camera_m - glm::dvec3(s_m, 0.0);
            const double angle_rad = std::acos(std::abs(to_camera.z) / glm::length(to_camera));
            factors.push_back(
                static_cast<float>(rig.radiometry->scale_lx_s_per_dn /
                                   rig::value_at(rig.radiometry->screen, angle_rad, 1.0)));
        }
    return factors;
}

// Rectifies positions one after the other into the spool.
class Rectifier {
  public:
    Rectifier(const Measurement& measurement, const Slab& planes, int channels)
        : radiometry_(*measurement.rig.radiometry),
          channels_(channels),
          lux_factors_(lux_factors(measurement.rig, planes)) {
        const TexelGrid grid{planes.texels, planes.s_min_m, planes.s_max_m};
        for (int color = 0; color < raw_colors(radiometry_); ++color)
            maps_.push_back(make_rectify_map(
                grid, measurement.rig.lens->size_px, radiometry_.mosaic, color,
                [&rig = measurement.rig](glm::dvec2 s_m) { return seen_px(rig, s_m); }));
    }

    void put(const MergedImage& image, int position, TexelSpool& spool) const {
        std::vector<RectifiedImage> raw;
        raw.reserve(maps_.size());
        for (const RectifyMap& map : maps_)
            raw.push_back(rectify(map, image.light_dn_per_s, image.variance));
        for (int channel = 0; channel < channels_; ++channel)
            spool.put(position, channel, mixed(raw, channel));
    }

    const RectifyMap& map() const { return maps_.front(); }

  private:
    // A channel's light in lux through a filter of peak 1: raw colors by the camera's matrix.
    RectifiedImage mixed(const std::vector<RectifiedImage>& raw, int channel) const {
        std::array<double, 3> weights{};
        for (std::size_t color = 0; color < raw.size(); ++color) {
            const int c = static_cast<int>(color);
            if (raw.size() == 1)
                weights[color] = 1;
            else if (channels_ == 3)
                weights[color] = radiometry_.rgb_from_raw[c][channel];
            else
                for (int k = 0; k < 3; ++k)
                    weights[color] +=
                        kLuminanceRgb[static_cast<std::size_t>(k)] * radiometry_.rgb_from_raw[c][k];
            weights[color] /= radiometry_.filter_peak[c];
        }
        RectifiedImage image;
        const std::size_t count = raw.front().value.size();
        image.value.resize(count);
        image.variance.resize(count);
        for (std::size_t t = 0; t < count; ++t) {
            double value = 0, variance = 0;
            for (std::size_t color = 0; color < raw.size(); ++color) {
                value += weights[color] * double(raw[color].value[t]);
                variance += weights[color] * weights[color] * double(raw[color].variance[t]);
            }
            const double lux = double(lux_factors_[t]);
            const bool is_known = std::isfinite(variance);
            image.value[t] = is_known ? static_cast<float>(lux * value) : 0.0F;
            image.variance[t] = is_known ? static_cast<float>(lux * lux * variance) : kMissing;
        }
        return image;
    }

    const rig::Radiometry& radiometry_;
    int channels_;
    std::vector<float> lux_factors_;
    std::vector<RectifyMap> maps_;  // [raw color]
};

// Where nothing was seen a coefficient could be as bright as any.
void bound_sigma(Slab& slab) {
    const float brightest = *std::max_element(slab.coeffs.begin(), slab.coeffs.end());
    for (float& sigma : slab.sigma)
        if (!std::isfinite(sigma))
            sigma = brightest;
}

// Rows of texels with the model's own error in their variance.
TileInput read_tile(const TexelSpool& spool,
                    TileRange rows,
                    const Slab& planes,
                    int positions,
                    double model_error_rel) {
    TileInput tile = spool.read(rows);
    const std::size_t count =
        static_cast<std::size_t>(rows.row_count) * static_cast<std::size_t>(planes.texels.x);
    const auto measurements = static_cast<std::size_t>(positions);
    for (std::size_t channel = 0; channel < static_cast<std::size_t>(planes.channels); ++channel)
        for (std::size_t t = 0; t < count; ++t) {
            float brightest = 0.0F;
            for (std::size_t k = 0; k < measurements; ++k)
                brightest =
                    std::max(brightest, tile.value[(channel * measurements + k) * count + t]);
            const float error = static_cast<float>(model_error_rel) * brightest;
            for (std::size_t k = 0; k < measurements; ++k)
                tile.variance[(channel * measurements + k) * count + t] += error * error;
        }
    return tile;
}

// Rows about the brightest one, in which smoothness is chosen.
TileRange bright_rows(const TexelSpool& spool, const Slab& planes, int positions) {
    constexpr int kRows = 12;
    int brightest = 0;
    double most = -1;
    for (int row = 0; row < planes.texels.y; ++row) {
        const TileInput tile = spool.read({row, 1});
        const auto count = static_cast<std::ptrdiff_t>(positions) * planes.texels.x;
        const double sum = std::accumulate(tile.value.begin(), tile.value.begin() + count, 0.0);
        if (sum > most) {
            most = sum;
            brightest = row;
        }
    }
    const int rows = std::min(kRows, planes.texels.y);
    return {std::clamp(brightest - rows / 2, 0, planes.texels.y - rows), rows};
}

void store(const TileResult& tile, Slab& slab, std::vector<Slab>& replicates, CaptureFit& fit) {
    const auto width = static_cast<std::size_t>(slab.texels.x);
    const std::size_t first = static_cast<std::size_t>(tile.rows.first_row) * width;
    const std::size_t count = static_cast<std::size_t>(tile.rows.row_count) * width;
    const auto images =
        static_cast<std::size_t>(slab.channels) * static_cast<std::size_t>(slab.image_count());
    const auto copy = [&](const std::vector<float>& from, std::vector<float>& to) {
        for (std::size_t image = 0; image < images && !from.empty(); ++image)
            std::copy_n(
                from.begin() + static_cast<std::ptrdiff_t>(image * count), count,
                to.begin() + static_cast<std::ptrdiff_t>(image * slab.texel_count() + first));
    };
    copy(tile.coeffs, slab.coeffs);
    copy(tile.sigma, slab.sigma);
    for (std::size_t k = 0; k < replicates.size(); ++k)
        copy(tile.replicates[k], replicates[k].coeffs);
    for (std::size_t t = 0; t < count; ++t) {
        const int freedom = tile.valid_count[t] - tile.free_count[t];
        fit.chi_square[first + t] =
            freedom > 0 ? tile.chi_square[t] / static_cast<float>(freedom) : 0;
    }
}

void fill_spool(const Measurement& measurement,
                const std::vector<PositionFrames>& positions,
                const LampDrift& drift,
                const Rectifier& rectifier,
                const CaptureFitOptions& options,
                TexelSpool& spool,
                CaptureFit& fit) {
    std::size_t saturated = 0, pixels = 0;
    double chi_square = 0;
    for (std::size_t k = 0; k < positions.size(); ++k) {
        const MergedImage image = position_light(measurement, positions[k], drift);
        saturated += image.saturated_count;
        pixels += image.light_dn_per_s.size();
        chi_square += image.chi_square_mean / static_cast<double>(positions.size());
        rectifier.put(image, static_cast<int>(k), spool);
        if (options.progress)
            options.progress(
                kMergeShare * static_cast<double>(k + 1) / static_cast<double>(positions.size()),
                fmt::format("position {} of {}", k + 1, positions.size()));
    }
    fit.saturated_share = static_cast<double>(saturated) / static_cast<double>(pixels);
    fit.exposure_chi_square = chi_square;
}

void choose_smoothness(const Design& design,
                       const TexelSpool& spool,
                       const Slab& planes,
                       double model_error_rel,
                       FitOptions& solve,
                       CaptureFit& fit) {
    constexpr int kTexelsAsked = 50;  // of a row
    SmoothnessOptions smoothness;
    smoothness.texel_step = std::max(1, planes.texels.x / kTexelsAsked);
    smoothness.folds = std::min(smoothness.folds, fit.positions);
    const TileRange rows = bright_rows(spool, planes, fit.positions);
    fit.smoothness = cross_validate(design, solve, smoothness, rows,
                                    read_tile(spool, rows, planes, fit.positions, model_error_rel));
    solve.solve.lambda = fit.smoothness.lambda[fit.smoothness.best];
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

}  // namespace

CaptureFit fit_capture(const Measurement& measurement, const CaptureFitOptions& options) {
    check_rig(measurement);
    const rig::Rig& rig = measurement.rig;
    const std::vector<PositionFrames> positions = positions_of(measurement.capture);
    check_positions(measurement, positions);
    CaptureFit fit;
    fit.positions = static_cast<int>(positions.size());
    fit.missing_positions = rig.planes->grid.x * rig.planes->grid.y - fit.positions;

    // Merge and rectify position by position.
    const double start_s = now_s();
    const LampDrift drift(measurement);
    fit.drift_rel = drift.largest_rel();
    const std::vector<float> looks =
        light_of_looks(measurement, looks_of(positions, rig.planes->grid), drift);
    const Extent extent = options.extent
                              ? *options.extent
                              : lit_extent(rig, visible_extent(rig), looks, options.dark_share);
    fit.outside_share = share_outside(rig, extent, looks);
    const int channels = options.wants_color && raw_colors(*rig.radiometry) == 3 ? 3 : 1;
    Slab slab = planes_of(rig, options, extent, channels);
    const Rectifier rectifier(measurement, slab, channels);
    fit.texel_cells_least = rectifier.map().texel_cells_least;
    fit.resolution_m =
        std::max(slab.texel_m().x, slab.texel_m().y) / std::min(1.0, fit.texel_cells_least);
    TexelSpool spool(options.spool_folder, slab.texels, channels, fit.positions);
    fill_spool(measurement, positions, drift, rectifier, options, spool, fit);
    const double merged_s = now_s();
    fit.merge_s = merged_s - start_s;

    // Choose the smoothness where there is light, then solve tile by tile.
    const Design design = make_design(slab, optics_of(rig, positions));
    FitOptions solve;
    solve.channels = channels;
    solve.solve.wants_sigma = true;
    solve.replicates = options.replicates;
    solve.seed = options.seed;
    solve.tile_bytes = options.tile_bytes;
    if (options.lambda)
        solve.solve.lambda = *options.lambda;
    else
        choose_smoothness(design, spool, slab, options.model_error_rel, solve, fit);
    fit.lambda = solve.solve.lambda;
    const double chosen_s = now_s();
    fit.smoothness_s = chosen_s - merged_s;
    const std::size_t coefficients = static_cast<std::size_t>(channels) *
                                     static_cast<std::size_t>(slab.image_count()) *
                                     slab.texel_count();
    std::vector<Slab> replicates(static_cast<std::size_t>(options.replicates), slab);
    for (Slab& replicate : replicates)
        replicate.coeffs.resize(coefficients);
    slab.coeffs.resize(coefficients);
    slab.sigma.resize(coefficients);
    fit.chi_square.resize(slab.texel_count());
    fit.report = solve_lightfield(
        design, solve,
        [&](TileRange rows) {
            return read_tile(spool, rows, slab, fit.positions, options.model_error_rel);
        },
        [&](const TileResult& tile) { store(tile, slab, replicates, fit); },
        [&](double fraction) {
            if (options.progress)
                options.progress(kMergeShare + (1 - kMergeShare) * fraction, "solve");
        });
    fit.solve_s = now_s() - chosen_s;
    bound_sigma(slab);
    fit.lightfield.scale_sigma_rel =
        std::hypot(rig.radiometry->scale_sigma_rel, rig.radiometry->scale_systematic_rel);
    fit.lightfield.slabs = {std::move(slab)};
    for (Slab& replicate : replicates) {
        fit.replicates.push_back(fit.lightfield);
        fit.replicates.back().slabs = {std::move(replicate)};
    }
    return fit;
}

}  // namespace nearfield::fit
