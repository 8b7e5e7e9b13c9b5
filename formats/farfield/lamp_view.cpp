// SPDX-License-Identifier: Apache-2.0
#include "formats/farfield/lamp_view.h"

#include "formats/model/emission.h"
#include "formats/model/intensity_sigma.h"
#include "formats/model/luminaire.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/to_lightfield.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nearfield::farfield {
namespace {

glm::dvec2 rectangle_on_s_m(const Slab& slab) {
    return slab.s_max_m - slab.s_min_m;
}

glm::dvec2 rectangle_on_u_m(const Slab& slab) {
    return slab.pitch_m * glm::dvec2(slab.grid);
}

bool is_smaller_on_s(const Slab& slab) {
    const glm::dvec2 s_m = rectangle_on_s_m(slab), u_m = rectangle_on_u_m(slab);
    return s_m.x * s_m.y < u_m.x * u_m.y;
}

// Nearly even over the sphere, on a spiral of golden angles.
std::vector<glm::dvec3> even_directions(int count) {
    std::vector<glm::dvec3> directions;
    for (int k = 0; k < count; ++k) {
        const double z = 1 - (2 * k + 1.0) / count, r = std::sqrt(1 - z * z);
        const double around = k * std::numbers::pi * (3 - std::sqrt(5.0));
        directions.emplace_back(r * std::cos(around), r * std::sin(around), z);
    }
    return directions;
}

}  // namespace

LampView view_of(const LightField& lightfield) {
    LampView view;
    view.flux = model::luminance(model::flux(lightfield));
    view.flux_sigma =
        std::hypot(model::flux_sigma_y(lightfield), view.flux * lightfield.scale_sigma_rel);
    view.intensity = [&lightfield](const glm::dvec3& d) {
        return model::luminance(model::intensity(lightfield, d));
    };
    view.intensity_sigma = [&lightfield](const glm::dvec3& d) {
        return model::intensity_sigma_y(lightfield, d);
    };
    view.lightfield = &lightfield;
    return view;
}

LampView view_of(const photometry::Photometry& photometry) {
    LampView view;
    view.flux = photometry::flux_lm(photometry);
    const glm::dmat3 turn =
        glm::transpose(photometry::luminaire_from_photometry(photometry.coordinates));
    view.intensity = [&photometry, turn](const glm::dvec3& d) {
        return photometry::intensity_cd(photometry, turn * d);
    };
    view.intensity_sigma = [](const glm::dvec3&) { return 0.0; };
    return view;
}

std::vector<WeightedDirection> lit_directions(const LampView& lamp, int count, std::uint32_t seed) {
    std::vector<WeightedDirection> directions;
    if (lamp.lightfield == nullptr) {
        for (const glm::dvec3& d : even_directions(count))
            if (const double intensity = lamp.intensity(d); intensity > 0)
                directions.push_back({d, intensity});
        return directions;
    }
    const model::Emission emission(*lamp.lightfield);
    for (int k = 0; k < count; ++k) {
        const model::EmittedRay ray = emission.ray(static_cast<std::uint64_t>(k), seed);
        const Slab& slab = lamp.lightfield->slabs[ray.slab];
        directions.push_back({slab.luminaire_from_slab.rotation *
                                  glm::normalize(glm::dvec3(ray.s_m - ray.u_m, slab.delta_m)),
                              1.0});
    }
    return directions;
}

glm::dvec3 light_center_m(const LightField& lightfield) {
    const model::Emission emission(lightfield);
    constexpr int kRays = 4096;
    glm::dvec3 sum(0.0);
    for (int k = 0; k < kRays; ++k) {
        const model::EmittedRay ray = emission.ray(static_cast<std::uint64_t>(k), 0);
        const Slab& slab = lightfield.slabs[ray.slab];
        const Rigid& pose = slab.luminaire_from_slab;
        sum += pose.translation_m + pose.rotation * (is_smaller_on_s(slab)
                                                         ? glm::dvec3(ray.s_m, 0)
                                                         : glm::dvec3(ray.u_m, -slab.delta_m));
    }
    return sum / static_cast<double>(kRays);
}

double lamp_size_m(const LightField& lightfield) {
    const Slab& slab = lightfield.slabs.front();
    return glm::length(is_smaller_on_s(slab) ? rectangle_on_s_m(slab) : rectangle_on_u_m(slab));
}

double weighted_quantile(std::vector<std::pair<double, double>> value_weight, double part) {
    if (value_weight.empty())
        return 0;
    std::sort(value_weight.begin(), value_weight.end());
    double whole = 0, below = 0;
    for (const auto& [value, weight] : value_weight)
        whole += weight;
    for (const auto& [value, weight] : value_weight)
        if ((below += weight) >= part * whole)
            return value;
    return value_weight.back().first;
}

}  // namespace nearfield::farfield
