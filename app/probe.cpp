// SPDX-License-Identifier: Apache-2.0
#include "app/probe.h"

#include "formats/model/luminaire.h"
#include "formats/model/monte_carlo.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include <array>

namespace nearfield::app {
namespace {

std::array<std::string, 6> result_names(Quantity quantity) {
    const std::string unit = quantity == Quantity::Photometric ? "_lx" : "_w_m2";
    return {"e_r" + unit,
            "e_g" + unit,
            "e_b" + unit,
            "e_y" + unit,
            "sigma_sampling_y" + unit,
            "sigma_measured_y" + unit};
}

std::array<double, 6> result_values(const Probed& result) {
    return {result.rgb.r,
            result.rgb.g,
            result.rgb.b,
            model::luminance(result.rgb),
            result.sigma_sampling_y,
            result.sigma_measured_y};
}

}  // namespace

std::vector<Probed> probe(const LightField& lightfield,
                          const PointList& points,
                          const ProbeOptions& options) {
    std::vector<Probed> results(points.positions_m.size());
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t k) {
        const model::Receiver receiver{points.positions_m[k], points.normals[k]};
        Probed& result = results[k];
        if (options.sampler == Sampler::Sum) {
            result.rgb = model::irradiance(lightfield, receiver);
        } else {
            const model::Estimate estimate = model::irradiance_by_sampling(
                lightfield, receiver, options.samples, options.seed, static_cast<std::uint32_t>(k));
            result.rgb = estimate.value;
            result.sigma_sampling_y = estimate.sigma_y;
        }
        result.sigma_measured_y = model::irradiance_sigma_y(lightfield, receiver);
    });
    return results;
}

std::string as_csv(Quantity quantity, const PointList& points, const std::vector<Probed>& results) {
    std::string text = kPointColumns;
    for (const std::string& name : result_names(quantity))
        text += "," + name;
    text += "\n";
    for (std::size_t k = 0; k < results.size(); ++k) {
        text += points.lines_text[k];
        for (const double value : result_values(results[k]))
            text += fmt::format(",{:.12g}", value);
        text += "\n";
    }
    return text;
}

std::string as_json(Quantity quantity,
                    const PointList& points,
                    const std::vector<Probed>& results) {
    const auto names = result_names(quantity);
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < results.size(); ++k) {
        const glm::dvec3 p = points.positions_m[k], n = points.normals[k];
        nlohmann::ordered_json point = {{"x_m", p.x}, {"y_m", p.y}, {"z_m", p.z},
                                        {"nx", n.x},  {"ny", n.y},  {"nz", n.z}};
        const auto values = result_values(results[k]);
        for (std::size_t c = 0; c < names.size(); ++c)
            point[names[c]] = values[c];
        list.push_back(std::move(point));
    }
    return nlohmann::ordered_json{{"points", std::move(list)}}.dump(1) + "\n";
}

}  // namespace nearfield::app
