// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/ray_lamp.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "sample_data/headlight.h"

#include <array>
#include <cmath>
#include <memory>
#include <string>

namespace nearfield::sample_data {
namespace {

RayLamp headlight_lamp(std::uint64_t seed) {
    RayLamp lamp;
    lamp.aperture = headlight_aperture();
    // The cut-off's width in red, and the steps of the beam's parts beside it.
    lamp.feature_tangent = {0.04, 0.0044};
    lamp.radiance_row = [headlight = make_headlight(seed)](glm::dvec2 a_m, double tangent_y,
                                                           std::span<const double> tangent_x,
                                                           std::span<double> rgb) {
        radiance_row(headlight, a_m, tangent_y, tangent_x, rgb);
    };
    return lamp;
}

RayLamp slab_lamp(const std::string& path) {
    LightField lightfield = read_lightfield(path);
    if (lightfield.slabs.size() != 1)
        throw Error("cannot put this lamp on the bench", path, "a light field of one slab",
                    std::to_string(lightfield.slabs.size()) + " slabs");
    if (lightfield.quantity != Quantity::Photometric)
        throw Error("cannot put this lamp on the bench", path, "photometric light", "radiometric");
    const auto slab = std::make_shared<const Slab>(std::move(lightfield.slabs.front()));
    RayLamp lamp;
    lamp.lamp_from_emitter = slab->luminaire_from_slab;
    lamp.lamp_from_emitter.translation_m -=
        slab->luminaire_from_slab.rotation * glm::dvec3(-slab->u_center_m, slab->delta_m);
    const glm::dvec2 cells =
        glm::dvec2(slab->grid - 1) + static_cast<double>(slab->profile.cells.size());
    lamp.aperture.half_m = 0.5 * cells * slab->pitch_m;
    for (long k = 1; k < std::lround(cells.x); ++k)
        lamp.aperture.breaks_x_m.push_back(static_cast<double>(k) * slab->pitch_m.x -
                                           lamp.aperture.half_m.x);
    for (long k = 1; k < std::lround(cells.y); ++k)
        lamp.aperture.breaks_y_m.push_back(static_cast<double>(k) * slab->pitch_m.y -
                                           lamp.aperture.half_m.y);
    lamp.feature_tangent = slab->texel_m() / slab->delta_m;
    lamp.radiance_row = [slab](glm::dvec2 a_m, double tangent_y, std::span<const double> tangent_x,
                               std::span<double> rgb) {
        const glm::dvec2 u_m = a_m + slab->u_center_m;
        const std::size_t count = tangent_x.size();
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec2 s_m = u_m + slab->delta_m * glm::dvec2(tangent_x[i], tangent_y);
            const glm::dvec3 value = model::radiance(*slab, u_m, s_m);
            for (int channel = 0; channel < 3; ++channel)
                rgb[static_cast<std::size_t>(channel) * count + i] = value[channel];
        }
    };
    return lamp;
}

}  // namespace

RayLamp make_ray_lamp(const BenchLamp& lamp) {
    return lamp.file.empty() ? headlight_lamp(lamp.headlight_seed) : slab_lamp(lamp.file);
}

glm::dvec3 radiance(const RayLamp& lamp, glm::dvec2 a_m, glm::dvec2 tangent) {
    std::array<double, 3> rgb{};
    lamp.radiance_row(a_m, tangent.y, std::span(&tangent.x, 1), rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

}  // namespace nearfield::sample_data
