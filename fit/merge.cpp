// SPDX-License-Identifier: Apache-2.0
#include "fit/merge.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace nearfield::fit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Steps of the fixed point; each brings an error of the light down by its square where photons
// dominate, at once where reading does.
constexpr int kSteps = 8;
// A prediction within so many sigma of saturation would be cut off by noise.
constexpr double kSaturationSigmas = 4.0;

// y(x) between points of a rising curve, and its slope; beyond the ends along the last piece.
struct CurvePoint {
    double y = 0, slope = 1;
};

CurvePoint piece_at(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, at);
    const auto i = static_cast<std::size_t>(above - x.begin());
    const double slope = (y[i] - y[i - 1]) / (x[i] - x[i - 1]);
    return {y[i - 1] + slope * (at - x[i - 1]), slope};
}

CurvePoint linear_from_raw(const rig::Curve& curve, double dn) {
    return curve.x.size() < 2 ? CurvePoint{dn, 1.0} : piece_at(curve.x, curve.y, dn);
}

CurvePoint raw_from_linear(const rig::Curve& curve, double linear) {
    return curve.x.size() < 2 ? CurvePoint{linear, 1.0} : piece_at(curve.y, curve.x, linear);
}

// An exposure as a measurement of light * t.
struct Reading {
    double value = 0, exposure_s = 0;
    double variance = 0;
    bool is_used = true;
};

// Model of an exposure for a given light: its variance and whether noise would saturate it.
struct Prediction {
    double variance = 0;
    double raw_dn = 0, raw_sigma_dn = 0;
};

Prediction prediction(double light,
                      double exposure_s,
                      const PixelTraits& pixel,
                      const SensorNoise& noise) {
    const double collected = std::max(0.0, light + pixel.dark_dn_per_s) * exposure_s;
    const CurvePoint raw = raw_from_linear(noise.linear, pixel.black_dn + collected);
    const double photons = noise.gain_e_per_dn > 0.0 ? collected / noise.gain_e_per_dn : 0.0;
    const double read_sigma = noise.read_noise_dn / raw.slope;
    const double variance = read_sigma * read_sigma + photons;
    return {variance, raw.y, std::sqrt(variance) * raw.slope};
}

struct Estimate {
    double light = 0, information = 0;
};

// Weighted least squares of y = light * t with the variances as they stand.
Estimate weighted(const std::vector<Reading>& readings) {
    double sum = 0.0, information = 0.0;
    for (const Reading& reading : readings)
        if (reading.is_used) {
            const double weight = reading.exposure_s / reading.variance;
            sum += weight * reading.value;
            information += weight * reading.exposure_s;
        }
    return {information > 0.0 ? sum / information : 0.0, information};
}

// The fixed point of estimate and variances.
Estimate settle(std::vector<Reading>& readings,
                const PixelTraits& pixel,
                const SensorNoise& noise) {
    for (Reading& reading : readings)  // as if all were read noise: the longest count most
        reading.variance = 1.0;
    Estimate estimate = weighted(readings);
    for (int step = 0; step < kSteps; ++step) {
        for (Reading& reading : readings)
            reading.variance =
                prediction(estimate.light, reading.exposure_s, pixel, noise).variance;
        const double before = estimate.light;
        estimate = weighted(readings);
        if (std::abs(estimate.light - before) <= 1e-12 * std::abs(before))
            break;
    }
    return estimate;
}

// Leaves out what noise would saturate, if anything remains. True where something changed.
bool drop_near_saturation(std::vector<Reading>& readings,
                          double light,
                          const PixelTraits& pixel,
                          const SensorNoise& noise) {
    const auto is_near = [&](const Reading& reading) {
        const Prediction p = prediction(light, reading.exposure_s, pixel, noise);
        return p.raw_dn + kSaturationSigmas * p.raw_sigma_dn >= noise.saturation_dn;
    };
    const bool remains = std::any_of(readings.begin(), readings.end(),
                                     [&](const Reading& r) { return r.is_used && !is_near(r); });
    bool has_changed = false;
    for (Reading& reading : readings)
        if (remains && reading.is_used && is_near(reading)) {
            reading.is_used = false;
            has_changed = true;
        }
    return has_changed;
}

std::vector<Reading> readings_of(std::span<const PixelExposure> exposures,
                                 const PixelTraits& pixel,
                                 const SensorNoise& noise) {
    std::vector<Reading> readings;
    readings.reserve(exposures.size());
    for (const PixelExposure& exposure : exposures) {
        if (!std::isfinite(exposure.dn) || !(exposure.exposure_s > 0.0) ||
            std::isinf(exposure.exposure_s))
            throw Error{"bad exposure", "merge", "finite DN, exposure > 0",
                        fmt::format("{} DN, {} s", exposure.dn, exposure.exposure_s)};
        Reading reading;
        reading.exposure_s = exposure.exposure_s;
        reading.value = linear_from_raw(noise.linear, exposure.dn).y - pixel.black_dn -
                        pixel.dark_dn_per_s * exposure.exposure_s;
        reading.is_used = exposure.dn < noise.saturation_dn;
        readings.push_back(reading);
    }
    return readings;
}

}  // namespace

MergedPixel merge_pixel(std::span<const PixelExposure> exposures,
                        const PixelTraits& pixel,
                        const SensorNoise& noise) {
    std::vector<Reading> readings = readings_of(exposures, pixel, noise);
    MergedPixel merged;
    merged.variance = kInfinity;
    if (std::none_of(readings.begin(), readings.end(),
                     [](const Reading& r) { return r.is_used; })) {
        merged.is_saturated = true;
        return merged;
    }
    Estimate estimate = settle(readings, pixel, noise);
    if (drop_near_saturation(readings, estimate.light, pixel, noise))
        estimate = settle(readings, pixel, noise);
    for (const Reading& reading : readings)
        if (reading.is_used) {
            const double off = reading.value - estimate.light * reading.exposure_s;
            merged.chi_square += off * off / reading.variance;
            ++merged.used_count;
        }
    merged.light_dn_per_s = estimate.light / pixel.response;
    const double common = merged.light_dn_per_s * pixel.response_sigma_rel;
    merged.variance =
        1.0 / (estimate.information * pixel.response * pixel.response) + common * common;
    return merged;
}

namespace {

struct RowTotals {
    std::size_t saturated = 0, bad = 0;
    double chi_square = 0;
    std::int64_t degrees = 0;
};

RowTotals merge_row(std::span<const ExposedFrame> frames,
                    const SensorNoise& noise,
                    const rig::Maps& maps,
                    double dark_factor,
                    std::size_t begin,
                    MergedImage& image) {
    RowTotals totals;
    std::vector<PixelExposure> exposures(frames.size());
    const std::size_t end = begin + static_cast<std::size_t>(maps.size_px.x);
    for (std::size_t p = begin; p < end; ++p) {
        if (maps.is_bad[p] != 0.0F) {
            ++totals.bad;
            image.variance[p] = std::numeric_limits<float>::infinity();
            continue;
        }
        for (std::size_t f = 0; f < frames.size(); ++f)
            exposures[f] = {static_cast<double>(frames[f].values_dn[p]), frames[f].exposure_s};
        const PixelTraits pixel{maps.black_dn[p], rig::dark_rate_dn_per_s(maps, p, dark_factor),
                                maps.response[p], maps.response_sigma_rel[p]};
        const MergedPixel merged = merge_pixel(exposures, pixel, noise);
        image.light_dn_per_s[p] = static_cast<float>(merged.light_dn_per_s);
        image.variance[p] = static_cast<float>(merged.variance);
        totals.saturated += merged.is_saturated ? 1 : 0;
        if (merged.used_count > 1) {
            totals.chi_square += merged.chi_square;
            totals.degrees += merged.used_count - 1;
        }
    }
    return totals;
}

void check_sizes(std::span<const ExposedFrame> frames, const rig::Maps& maps) {
    const std::size_t pixels =
        static_cast<std::size_t>(maps.size_px.x) * static_cast<std::size_t>(maps.size_px.y);
    if (frames.empty())
        throw Error{"nothing to merge", "frames", "at least one", "none"};
    for (const auto* map : {&maps.black_dn, &maps.dark_dn_per_s, &maps.room_dn_per_s,
                            &maps.response, &maps.response_sigma_rel, &maps.is_bad})
        if (map->size() != pixels)
            throw Error{"maps do not fit", "maps", fmt::format("{} pixels", pixels),
                        fmt::format("{}", map->size())};
    for (const ExposedFrame& frame : frames)
        if (frame.values_dn.size() != pixels)
            throw Error{"frame does not fit the maps", "frames", fmt::format("{} pixels", pixels),
                        fmt::format("{}", frame.values_dn.size())};
}

}  // namespace

MergedImage merge_frames(std::span<const ExposedFrame> frames,
                         const rig::Radiometry& radiometry,
                         const rig::Maps& maps,
                         double dark_factor) {
    check_sizes(frames, maps);
    const SensorNoise noise{radiometry.gain_e_per_dn, radiometry.read_noise_dn,
                            radiometry.saturation_dn, radiometry.linear};
    MergedImage image;
    image.size_px = maps.size_px;
    image.light_dn_per_s.resize(maps.black_dn.size());
    image.variance.resize(maps.black_dn.size());
    const auto width = static_cast<std::size_t>(maps.size_px.x);
    std::vector<RowTotals> rows(static_cast<std::size_t>(maps.size_px.y));
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t row) {
        rows[row] = merge_row(frames, noise, maps, dark_factor, row * width, image);
    });
    RowTotals all;
    for (const RowTotals& row : rows) {
        all.saturated += row.saturated;
        all.bad += row.bad;
        all.chi_square += row.chi_square;
        all.degrees += row.degrees;
    }
    image.saturated_count = all.saturated;
    image.bad_count = all.bad;
    image.chi_square_mean =
        all.degrees > 0 ? all.chi_square / static_cast<double>(all.degrees) : 0.0;
    return image;
}

}  // namespace nearfield::fit
