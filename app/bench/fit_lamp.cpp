// SPDX-License-Identifier: Apache-2.0
#include "app/bench/fit_lamp.h"

#include "formats/model/profile.h"
#include "sample_data/random.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::bench {
namespace {

// Of a texel's points, along each axis: at a quarter and three quarters.
constexpr int kPoints = 2;

// Y of f_s for one node of the lens and a line of points s, times weight.
void add_line(const sample_data::Headlight& headlight,
              double delta_m,
              glm::dvec2 u_m,
              double s_y_m,
              const std::vector<double>& s_x_m,
              std::vector<double>& rgb,
              std::vector<double>& line) {
    std::vector<double> tangent_x;
    tangent_x.reserve(s_x_m.size());
    for (const double x_m : s_x_m)
        tangent_x.push_back((x_m - u_m.x) / delta_m);
    const double tangent_y = (s_y_m - u_m.y) / delta_m;
    rgb.resize(3 * s_x_m.size());
    radiance_row(headlight, u_m, tangent_y, tangent_x, rgb);
    for (std::size_t i = 0; i < s_x_m.size(); ++i) {
        const double per_cos2 = 1 + tangent_x[i] * tangent_x[i] + tangent_y * tangent_y;
        double luminance = 0;
        for (std::size_t c = 0; c < 3; ++c)
            luminance += kLuminanceRgb[c] * rgb[c * s_x_m.size() + i];
        line[i / kPoints] += luminance / (per_cos2 * per_cos2 * delta_m * delta_m);
    }
}

struct NodeShare {
    std::size_t node = 0;
    double transmission = 0;
};

}  // namespace

LampLight lamp_light(const sample_data::Headlight& headlight,
                     double delta_m,
                     glm::ivec2 texels,
                     double node_spacing_m) {
    LampLight light;
    light.planes =
        sample_data::headlight_planes(delta_m, {1, 1}, texels, "box", Weighting::Irradiance, 1);
    std::vector<double> area_m2;
    for (const sample_data::ApertureRow& row :
         sample_data::aperture_rows(sample_data::headlight_aperture(), glm::dvec2(node_spacing_m)))
        for (const sample_data::Node& x : row.x) {
            light.node_u_m.emplace_back(x.at_m, row.y.at_m);
            area_m2.push_back(x.weight_m * row.y.weight_m);
        }
    const std::size_t nodes = area_m2.size();
    const auto width = static_cast<std::size_t>(texels.x);
    light.light_lx.resize(nodes * light.planes.texel_count());
    const glm::dvec2 step_m = light.planes.texel_m() / static_cast<double>(kPoints);
    std::vector<double> s_x_m;
    s_x_m.reserve(static_cast<std::size_t>(kPoints) * width);
    for (int p = 0; p < kPoints * texels.x; ++p)
        s_x_m.push_back(light.planes.s_min_m.x + (p + 0.5) * step_m.x);
    tbb::parallel_for(0, texels.y, [&](int j) {
        std::vector<double> rgb, line(width);
        for (std::size_t n = 0; n < nodes; ++n) {
            std::fill(line.begin(), line.end(), 0.0);
            for (int p = 0; p < kPoints; ++p) {
                const double s_y_m = light.planes.s_min_m.y + (kPoints * j + p + 0.5) * step_m.y;
                add_line(headlight, delta_m, light.node_u_m[n], s_y_m, s_x_m, rgb, line);
            }
            for (std::size_t i = 0; i < width; ++i)
                light.light_lx[(static_cast<std::size_t>(j) * width + i) * nodes + n] =
                    static_cast<float>(area_m2[n] * line[i] / (kPoints * kPoints));
        }
    });
    return light;
}

std::vector<double> measured_lx(const LampLight& light, const fit::Optics& optics) {
    const std::size_t nodes = light.node_u_m.size(), texels = light.planes.texel_count();
    std::vector<double> measured(optics.position_m.size() * texels);
    tbb::parallel_for(std::size_t{0}, optics.position_m.size(), [&](std::size_t k) {
        std::vector<NodeShare> seen;
        for (std::size_t n = 0; n < nodes; ++n) {
            const glm::dvec2 x =
                (light.node_u_m[n] - glm::dvec2(optics.position_m[k])) / optics.filter_pitch_m;
            const double transmission =
                model::eval(optics.filter_x, x.x) * model::eval(optics.filter_y, x.y);
            if (transmission > 0)
                seen.push_back({n, transmission});
        }
        for (std::size_t t = 0; t < texels; ++t) {
            double sum = 0;
            for (const NodeShare& share : seen)
                sum += share.transmission * double(light.light_lx[t * nodes + share.node]);
            measured[k * texels + t] = sum;
        }
    });
    return measured;
}

LitReceivers lit_receivers(const sample_data::Headlight& headlight, int count) {
    constexpr double kNearest_m = 1, kFarthest_m = 25, kLeastShare = 0.01;
    sample_data::SplitMix random{1};
    std::vector<model::Receiver> receivers;
    for (int k = 0; k < count; ++k) {
        const glm::dvec2 share(random.next(), random.next());
        const glm::dvec2 tangent = glm::mix(sample_data::kBeamMin, sample_data::kBeamMax, share);
        const double z_m = kNearest_m * std::pow(kFarthest_m / kNearest_m, random.next());
        const glm::dvec3 at_m(tangent * z_m, z_m);
        receivers.push_back({at_m, -glm::normalize(at_m)});
    }
    std::vector<double> lx(receivers.size());
    tbb::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t k) {
        lx[k] = model::luminance(sample_data::irradiance(headlight, receivers[k]));
    });
    const auto intensity = [&](std::size_t k) {
        return lx[k] * glm::dot(receivers[k].position_m, receivers[k].position_m);
    };
    double most = 0;
    for (std::size_t k = 0; k < lx.size(); ++k)
        most = std::max(most, intensity(k));
    LitReceivers lit;
    for (std::size_t k = 0; k < lx.size(); ++k)
        if (intensity(k) >= kLeastShare * most) {
            lit.at_lens.push_back(receivers[k]);
            lit.truth_lx.push_back(lx[k]);
        }
    return lit;
}

}  // namespace nearfield::bench
