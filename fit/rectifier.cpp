// SPDX-License-Identifier: Apache-2.0
#include "fit/rectifier.h"

#include "fit/texel_plan.h"
#include "formats/rig/curve.h"

#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

constexpr float kMissing = std::numeric_limits<float>::infinity();

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

}  // namespace

int raw_colors(const rig::Radiometry& radiometry) {
    return radiometry.mosaic == "mono" ? 1 : 3;
}

Rectifier::Rectifier(const Measurement& measurement, const Slab& planes, int channels)
    : radiometry_(*measurement.rig.radiometry),
      channels_(channels),
      lux_factors_(lux_factors(measurement.rig, planes)) {
    const TexelGrid grid{planes.texels, planes.s_min_m, planes.s_max_m};
    for (int color = 0; color < raw_colors(radiometry_); ++color)
        maps_.push_back(make_rectify_map(
            grid, measurement.rig.lens->size_px, radiometry_.mosaic, color,
            [&rig = measurement.rig](glm::dvec2 s_m) { return seen_px(rig, s_m); }));
}

std::vector<RectifiedImage> Rectifier::rectified(const MergedImage& image) const {
    std::vector<RectifiedImage> raw, channels;
    raw.reserve(maps_.size());
    for (const RectifyMap& map : maps_)
        raw.push_back(rectify(map, image.light_dn_per_s, image.variance));
    for (int channel = 0; channel < channels_; ++channel)
        channels.push_back(mixed(raw, channel));
    return channels;
}

// A channel's light in lux through a filter of peak 1: raw colors by the camera's matrix.
RectifiedImage Rectifier::mixed(const std::vector<RectifiedImage>& raw, int channel) const {
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

}  // namespace nearfield::fit
