// SPDX-License-Identifier: Apache-2.0
#include "calibrate/scale.h"

#include "formats/rig/curve.h"
#include "formats/rig/veil.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::calibrate {
namespace {

constexpr double kScaleSecondsPerMicrosecond = 1e-6;
constexpr glm::dvec3 kLuminanceOfRgb(0.2126, 0.7152, 0.0722);  // Rec.709
constexpr int kScaleReweightings = 4;

// Where more of a picture is saturated, the veil that it sends to the rest is not known.
constexpr double kMostUnusable = 0.005;

double share_unusable(const std::vector<float>& light) {
    const auto count =
        std::count_if(light.begin(), light.end(), [](float value) { return std::isnan(value); });
    return static_cast<double>(count) / static_cast<double>(light.size());
}

double true_seconds(const rig::Radiometry& radiometry, double asked_us) {
    for (const rig::TrueExposure& exposure : radiometry.exposures) {
        if (exposure.asked_us == asked_us)
            return exposure.true_us * kScaleSecondsPerMicrosecond;
    }
    return asked_us * kScaleSecondsPerMicrosecond;
}

// What a raw color adds to luminance.
std::vector<double> luminance_weights(const PixelLayout& layout,
                                      const rig::Radiometry& radiometry) {
    if (layout.colors() == 1)
        return {1.0};
    const glm::dvec3 weights = glm::transpose(radiometry.rgb_from_raw) * kLuminanceOfRgb;
    return {weights.x, weights.y, weights.z};
}

// Light about a point, of one color: a plane through the disk's pixels, so that where they lie
// does not matter where light changes.
struct ColorSums {
    glm::dmat3 normal{0.0};
    glm::dvec3 light{0.0};
    double variance = 0, count = 0;

    void add(glm::dvec2 from_point_px, double value, double value_variance) {
        const glm::dvec3 row(1.0, from_point_px);
        normal += glm::outerProduct(row, row);
        light += value * row;
        variance += value_variance;
        count += 1.0;
    }
    double at_point() const { return (glm::inverse(normal) * light).x; }
    double variance_at_point() const { return glm::inverse(normal)[0].x * variance / count; }
};

// The luminance at the point; none where a pixel of the disk is saturated, or a color is not there.
std::optional<ScalePoint> look(const std::vector<float>& light,
                               double exposure_s,
                               const PixelLayout& layout,
                               const rig::Radiometry& radiometry,
                               const rig::Maps& maps,
                               const PhotometerPlace& place) {
    const std::vector<double> weights = luminance_weights(layout, radiometry);
    std::vector<ColorSums> sums(weights.size());
    const double read_dn2 = radiometry.read_noise_dn * radiometry.read_noise_dn;
    const glm::ivec2 reach(static_cast<int>(std::ceil(place.radius_px)));
    const glm::ivec2 middle(glm::floor(place.at_px));
    const glm::ivec2 first = glm::max(middle - reach, glm::ivec2(0));
    const glm::ivec2 last = glm::min(middle + reach, layout.size_px - 1);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            const glm::dvec2 from_point_px = glm::dvec2(x + 0.5, y + 0.5) - place.at_px;
            if (glm::length(from_point_px) > place.radius_px)
                continue;
            for (int channel = 0; channel < layout.channels; ++channel) {
                const std::size_t k = layout.value_at(x, y, channel);
                if (maps.is_bad[k] != 0.0F)
                    continue;
                if (std::isnan(light[k]))
                    return std::nullopt;
                const double per_dn = 1.0 / (exposure_s * maps.response[k]);
                const double signal_dn = std::max(0.0, light[k] / per_dn);
                sums[static_cast<std::size_t>(layout.color(k))].add(
                    from_point_px, light[k],
                    (read_dn2 + signal_dn / radiometry.gain_e_per_dn) * per_dn * per_dn);
            }
        }
    }
    ScalePoint point;
    double variance = 0;
    for (std::size_t color = 0; color < weights.size(); ++color) {
        constexpr double kLeastPixels = 4;
        if (sums[color].count < kLeastPixels || glm::determinant(sums[color].normal) < 1e-6)
            return std::nullopt;
        point.light_dn_per_s += weights[color] * sums[color].at_point();
        variance += weights[color] * weights[color] * sums[color].variance_at_point();
    }
    point.sigma = std::sqrt(variance);
    return point;
}

// Scatter of the readings without light: what relative errors leave out.
double floor_lx(const std::vector<ScalePoint>& points) {
    double sum = 0, squares = 0, count = 0;
    for (const ScalePoint& point : points) {
        if (point.exposure_us > 0.0)
            continue;
        sum += point.reading_lx;
        squares += point.reading_lx * point.reading_lx;
        count += 1.0;
    }
    return count < 2.0 ? 0.0
                       : std::sqrt(std::max(0.0, (squares - sum * sum / count) / (count - 1.0)));
}

}  // namespace

std::vector<float> light_of(const capture::Frame& frame,
                            const capture::FrameRecord& record,
                            const PixelLayout& layout,
                            const rig::Radiometry& radiometry,
                            const rig::Maps& maps) {
    const double asked_s = record.shot.exposure_us * kScaleSecondsPerMicrosecond;
    const auto true_s = static_cast<float>(true_seconds(radiometry, record.shot.exposure_us));
    const double growth = rig::dark_growth(radiometry, record.temperature_c);
    std::vector<float> light(frame.values.size());
    float before = 0.0F;
    for (std::size_t k = 0; k < light.size(); ++k) {
        const auto net_dn = static_cast<float>(rig::linear_dn(radiometry, frame.values[k]) -
                                               double(maps.black_dn[k]) -
                                               rig::dark_rate_dn_per_s(maps, k, growth) * asked_s);
        // A bad pixel's light spreads as its neighbor's does.
        light[k] = maps.is_bad[k] != 0.0F ? before : net_dn / true_s;
        before = light[k];
    }
    light = rig::remove_veil(light, layout.size_px, radiometry);
    for (std::size_t k = 0; k < light.size(); ++k) {
        const bool is_usable = maps.is_bad[k] == 0.0F && frame.values[k] < radiometry.saturation_dn;
        light[k] =
            is_usable ? light[k] / maps.response[k] : std::numeric_limits<float>::quiet_NaN();
    }
    return light;
}

std::vector<ScalePoint> scale_points_of(std::span<const Bracket> brackets,
                                        std::span<const ExposureGroup> darks,
                                        const PixelLayout& layout,
                                        const DarkResult& dark,
                                        const rig::Radiometry& radiometry,
                                        const rig::Maps& maps,
                                        const PhotometerPlace& place,
                                        const FrameReader& read) {
    std::vector<ScalePoint> points;
    for (const ExposureGroup& group : darks) {
        for (const capture::FrameRecord* record : group.frames) {
            if (!record->reading_lx)
                continue;
            ScalePoint point;
            point.reading_lx = *record->reading_lx;
            points.push_back(point);
        }
    }
    const double factor = rig::value_at(radiometry.screen, place.view_angle_rad, 1.0);
    for (const Bracket& bracket : brackets) {
        for (const capture::FrameRecord* record : bracket) {
            if (!record->reading_lx)
                continue;
            const double asked_us = record->shot.exposure_us;
            const double exposure_s = true_seconds(radiometry, asked_us);
            const std::vector<float> light =
                light_of(read(*record), *record, layout, radiometry, maps);
            if (share_unusable(light) > kMostUnusable)
                continue;
            std::optional<ScalePoint> point =
                look(light, exposure_s, layout, radiometry, maps, place);
            if (!point)
                continue;
            // The dark of these pixels errs as one in all frames of this exposure.
            const double disk_px = std::sqrt(glm::pi<double>()) * place.radius_px;
            point->sigma =
                std::hypot(point->sigma, dark.sigma_dn(exposure_s) / (exposure_s * disk_px));
            point->light_dn_per_s /= factor;
            point->sigma /= factor;
            point->position = record->shot.position;
            point->exposure_us = asked_us;
            point->reading_lx = *record->reading_lx;
            points.push_back(*point);
        }
    }
    return points;
}

std::optional<ScaleResult> fit_scale(std::vector<ScalePoint> points, double reading_sigma_rel) {
    constexpr int kLeastLit = 3;
    const auto lit = std::count_if(points.begin(), points.end(),
                                   [](const ScalePoint& p) { return p.exposure_us > 0.0; });
    if (lit < kLeastLit)
        return std::nullopt;
    const double floor = floor_lx(points);
    ScaleResult result;
    double scale = 0, offset = 0, determinant = 0, s0 = 0;
    const auto sigma_of = [&](const ScalePoint& point, bool is_first) {
        const double expected = is_first ? point.reading_lx : scale * point.light_dn_per_s + offset;
        return std::hypot(std::hypot(reading_sigma_rel * expected, floor),
                          is_first ? 0.0 : scale * point.sigma);
    };
    for (int round = 0; round < kScaleReweightings; ++round) {
        double s1 = 0, s2 = 0, y0 = 0, y1 = 0;
        s0 = 0;
        for (const ScalePoint& point : points) {
            const double sigma = std::max(sigma_of(point, round == 0), 1e-9);
            const double weight = 1.0 / (sigma * sigma);
            s0 += weight;
            s1 += weight * point.light_dn_per_s;
            s2 += weight * point.light_dn_per_s * point.light_dn_per_s;
            y0 += weight * point.reading_lx;
            y1 += weight * point.light_dn_per_s * point.reading_lx;
        }
        determinant = s0 * s2 - s1 * s1;
        if (!(determinant > 1e-12 * s0 * s2))
            return std::nullopt;
        scale = (s0 * y1 - s1 * y0) / determinant;
        offset = (s2 * y0 - s1 * y1) / determinant;
        result.offset_sigma_lx = std::sqrt(s2 / determinant);
    }
    for (ScalePoint& point : points) {
        point.residual_sigmas = (point.reading_lx - scale * point.light_dn_per_s - offset) /
                                std::max(sigma_of(point, false), 1e-9);
        result.chi2 += point.residual_sigmas * point.residual_sigmas;
    }
    result.freedom = static_cast<int>(points.size()) - 2;
    const double inflation = std::sqrt(std::max(1.0, result.chi2 / result.freedom));
    result.scale_lx_s_per_dn = scale;
    result.offset_lx = offset;
    result.offset_sigma_lx *= inflation;
    result.sigma_rel = inflation * std::sqrt(s0 / determinant) / scale;
    result.points = std::move(points);
    return result;
}

}  // namespace nearfield::calibrate
