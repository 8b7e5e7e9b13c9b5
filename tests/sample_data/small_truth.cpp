// SPDX-License-Identifier: Apache-2.0
#include "tests/sample_data/small_truth.h"

#include "sample_data/random.h"
#include "tests/support/oracle.h"

#include <cmath>

namespace nearfield::support {
namespace {

nlohmann::ordered_json array(glm::dvec3 v) {
    return {v.x, v.y, v.z};
}

// Points in the beam 0.2 ... 20 m ahead of S and three beside it, facing the lamp within 60
// degrees.
std::vector<model::Receiver> small_receivers(const Slab& slab) {
    constexpr int kCount = 50;
    sample_data::SplitMix random{50};
    std::vector<model::Receiver> receivers;
    for (int k = 0; k < kCount; ++k) {
        const double z_m = 0.2 * std::pow(100.0, random.next());
        const double spread = k % 16 == 15 ? 1.5 : 0.9;
        const double tangent_x = spread * sample_data::kBeamMax.x * (2.0 * random.next() - 1.0);
        const double tangent_y =
            sample_data::kBeamMin.y +
            random.next() * (0.9 * sample_data::kBeamMax.y - sample_data::kBeamMin.y);
        const double distance_m = z_m + slab.delta_m;
        const double cosine = 0.5 + 0.5 * random.next(),
                     angle_rad = 6.283185307179586 * random.next();
        const double sine = std::sqrt(1.0 - cosine * cosine);
        receivers.push_back({{distance_m * tangent_x, distance_m * tangent_y, z_m},
                             {sine * std::cos(angle_rad), sine * std::sin(angle_rad), -cosine}});
    }
    return receivers;
}

}  // namespace

sample_data::SimulateOptions small_options() {
    sample_data::SimulateOptions options;
    options.grid = {5, 4};
    options.texels = {48, 32};
    return options;
}

nlohmann::ordered_json small_truth(const sample_data::Headlight& headlight,
                                   const LightField& lightfield) {
    const Slab& slab = lightfield.slabs.front();
    nlohmann::ordered_json truth;
    truth["frame"] =
        "luminaire: metres, z = 0 on S, +z where light goes, +y up; colors linear Rec.709";
    truth["flux_lm"] = {{"formula", array(sample_data::flux(headlight))},
                        {"lightfield", array(oracle_flux(slab))}};
    for (const model::Receiver& receiver : small_receivers(slab)) {
        model::Receiver receiver_lens = receiver;
        receiver_lens.position_m.z += slab.delta_m;
        truth["irradiance_lx"].push_back(
            {{"position_m", array(receiver.position_m)},
             {"normal", array(receiver.normal)},
             {"formula", array(sample_data::irradiance(headlight, receiver_lens))},
             {"lightfield", array(oracle_irradiance(slab, receiver))}});
    }
    for (const double tangent_x : {-0.3, -0.1, 0.05, 0.3}) {
        for (const double tangent_y : {-0.12, -0.03, 0.01}) {
            const glm::dvec3 direction(tangent_x, tangent_y, 1.0);
            truth["intensity_cd"].push_back(
                {{"direction", array(direction)},
                 {"formula", array(sample_data::intensity(headlight, direction))},
                 {"lightfield", array(oracle_intensity(slab, direction))}});
        }
    }
    return truth;
}

}  // namespace nearfield::support
