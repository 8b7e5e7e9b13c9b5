// SPDX-License-Identifier: Apache-2.0
#include "app/fit_light.h"

#include "formats/model/luminaire.h"
#include "formats/model/profile.h"

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

// Luminance weights of a slab's channels.
std::vector<double> channel_weights(const Slab& slab) {
    if (slab.channels == 1)
        return {1.0};
    return {kLuminanceRgb.begin(), kLuminanceRgb.end()};
}

// Adds an image's share of the light on S, and of its variance.
void add_on_s(const Slab& image, double area_m2, FitLight& light, std::vector<double>& variance) {
    const std::vector<double> weights = channel_weights(image);
    for (std::size_t t = 0; t < image.texel_count(); ++t) {
        double sigma = 0;
        for (int c = 0; c < image.channels; ++c) {
            const std::size_t at = image.image_offset(c, 0) + t;
            const double weight = weights[static_cast<std::size_t>(c)] * area_m2;
            light.on_s_lx[t] += weight * double(image.coeffs[at]);
            if (!image.sigma.empty())
                sigma += weight * double(image.sigma[at]);
        }
        variance[t] += sigma * sigma;
    }
}

double flux_lm(const Slab& image) {
    return model::luminance(model::flux(image));
}

// Flux, light on S and the sigmas of both.
FitLight summed(const Slab& planes, const std::function<Slab(int m)>& image_at) {
    // A basis function's integral over U turns coefficients into lux.
    const double integral = model::integral(planes.profile);
    const double area_m2 = integral * integral * planes.pitch_m.x * planes.pitch_m.y;
    FitLight light;
    light.on_s_lx.assign(planes.texel_count(), 0.0);
    std::vector<double> variance(planes.texel_count()), replicate_lm;
    double noise_lm2 = 0;
    for (int m = 0; m < planes.image_count(); ++m) {
        Slab image = image_at(m);
        add_on_s(image, area_m2, light, variance);
        light.flux_lm += flux_lm(image);
        replicate_lm.resize(image.replicates.size());
        for (std::size_t r = 0; r < replicate_lm.size(); ++r) {
            std::swap(image.coeffs, image.replicates[r]);
            replicate_lm[r] += flux_lm(image);
        }
        image.replicates.clear();
        LightField alone;
        alone.slabs = {std::move(image)};
        noise_lm2 += std::pow(model::flux_sigma_y(alone), 2.0);
    }
    for (const double sum : variance)
        light.on_s_sigma_lx.push_back(std::sqrt(sum));
    double spread_lm2 = 0;
    for (const double lm : replicate_lm)
        spread_lm2 += std::pow(lm - light.flux_lm, 2.0) / static_cast<double>(replicate_lm.size());
    light.flux_sigma_lm = std::sqrt(replicate_lm.empty() ? noise_lm2 : spread_lm2);
    return light;
}

// From the brightest direction, from both sides of it and from below.
std::vector<LensView> empty_views(const Slab& planes, const FitLight& light) {
    const auto brightest =
        std::max_element(light.on_s_lx.begin(), light.on_s_lx.end()) - light.on_s_lx.begin();
    const auto column = static_cast<int>(brightest) % planes.texels.x;
    const auto row = static_cast<int>(brightest) / planes.texels.x;
    const glm::dvec2 hot_m = planes.s_min_m + (glm::dvec2(column, row) + 0.5) * planes.texel_m();
    const glm::dvec2 hot = (hot_m - planes.u_center_m) / planes.delta_m;
    const double aside = 0.35 * (planes.s_max_m.x - planes.s_min_m.x) / planes.delta_m;
    const glm::dvec2 half_m = 0.5 * (glm::dvec2(planes.grid) + 1.0) * planes.pitch_m;
    constexpr int kColumns_px = 96;
    std::vector<LensView> views;
    for (const glm::dvec2 offset : {glm::dvec2(0.0), glm::dvec2(-aside, 0.0),
                                    glm::dvec2(aside, 0.0), glm::dvec2(0.0, -0.4 * aside)}) {
        LensView view;
        view.tangent = hot + offset;
        view.lower_m = planes.u_center_m - half_m;
        view.upper_m = planes.u_center_m + half_m;
        view.size_px = {kColumns_px, static_cast<int>(kColumns_px * half_m.y / half_m.x)};
        view.cd_per_m2.resize(static_cast<std::size_t>(view.size_px.x * view.size_px.y));
        views.push_back(std::move(view));
    }
    return views;
}

void add_to_view(const Slab& image, LensView& view) {
    const glm::dvec2 step_m = (view.upper_m - view.lower_m) / glm::dvec2(view.size_px);
    std::size_t at = 0;
    for (int row = 0; row < view.size_px.y; ++row)
        for (int column = 0; column < view.size_px.x; ++column) {
            const glm::dvec2 u_m = view.lower_m + (glm::dvec2(column, row) + 0.5) * step_m;
            view.cd_per_m2[at++] +=
                model::luminance(model::radiance(image, u_m, u_m + image.delta_m * view.tangent));
        }
}

// `planes`: the slab without its arrays.
Slab image_of(const Slab& planes, const Slab& slab, int m) {
    Slab image = planes;
    image.grid = {1, 1};
    image.u_center_m = slab.basis_center_m(m % slab.grid.x, m / slab.grid.x);
    const auto take = [&](const std::vector<float>& from, std::vector<float>& to) {
        to.clear();
        for (int channel = 0; channel < slab.channels && !from.empty(); ++channel) {
            const auto begin =
                from.begin() + static_cast<std::ptrdiff_t>(slab.image_offset(channel, m));
            to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(slab.texel_count()));
        }
    };
    take(slab.coeffs, image.coeffs);
    take(slab.sigma, image.sigma);
    for (std::size_t r = 0; r < slab.replicates.size(); ++r)
        take(slab.replicates[r], image.replicates[r]);
    return image;
}

}  // namespace

FitLight light_of(const Slab& planes, const std::function<Slab(int m)>& image) {
    FitLight light = summed(planes, image);
    light.views = empty_views(planes, light);
    for (int m = 0; m < planes.image_count(); ++m) {
        const Slab alone = image(m);
        for (LensView& view : light.views)
            add_to_view(alone, view);
    }
    return light;
}

FitLight light_of(const Slab& slab) {
    Slab planes = slab;
    planes.coeffs.clear();
    planes.sigma.clear();
    for (std::vector<float>& replicate : planes.replicates)
        replicate.clear();
    return light_of(planes, [&](int m) { return image_of(planes, slab, m); });
}

}  // namespace nearfield::app
