// SPDX-License-Identifier: Apache-2.0
#include "app/probe.h"

#include "formats/model/luminaire.h"
#include "formats/model/mip_sum.h"
#include "formats/model/monte_carlo.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

std::vector<std::string> result_names(Quantity quantity, bool has_bias) {
    const std::string unit = quantity == Quantity::Photometric ? "_lx" : "_w_m2";
    std::vector<std::string> names = {
        "e_r", "e_g", "e_b", "e_y", "sigma_sampling_y", "sigma_measured_y"};
    if (has_bias)
        names.emplace_back("bias_bound_y");
    for (std::string& name : names)
        name += unit;
    return names;
}

std::vector<double> result_values(const Probed& result, bool has_bias) {
    std::vector<double> values = {result.rgb.r,
                                  result.rgb.g,
                                  result.rgb.b,
                                  model::luminance(result.rgb),
                                  result.sigma_sampling_y,
                                  result.sigma_measured_y};
    if (has_bias)
        values.push_back(result.bias_bound_y);
    return values;
}

model::ReceiverF in_slab(const Slab& slab, const model::Receiver& receiver) {
    const model::Receiver local = model::to_slab(slab, receiver);
    return {glm::vec3(local.position_m), glm::vec3(local.normal)};
}

/// What the method reads, made once for all points.
struct Prepared {
    std::vector<model::SamplingSlab> sampling;
    std::vector<model::PreparedMips> mips;
};

Prepared prepare(const LightField& lightfield, const ProbeOptions& options) {
    Prepared prepared;
    for (const Slab& slab : lightfield.slabs) {
        if (options.sampler.method == ProbeMethod::Sampler)
            prepared.sampling.push_back(model::prepare_sampling(slab));
        if (options.sampler.method == ProbeMethod::Sum && options.q > 0)
            prepared.mips.push_back(model::prepare_mips(slab));
    }
    return prepared;
}

void probe_coarsely(const Prepared& prepared,
                    const model::Receiver& receiver,
                    int q,
                    Probed& result) {
    glm::vec3 coarse(0.0F), finer(0.0F), of_slab(0.0F);
    for (const model::PreparedMips& mips : prepared.mips) {
        const model::ReceiverF local = in_slab(mips.levels.front().slab, receiver);
        model::irradiance(mips, q, {&local, 1}, {&of_slab, 1});
        coarse += of_slab;
        model::irradiance(mips, 2 * q, {&local, 1}, {&of_slab, 1});
        finer += of_slab;
    }
    result.rgb = coarse;
    result.bias_bound_y = static_cast<double>(model::kBiasPerDifference) *
                          std::abs(model::luminance(coarse) - model::luminance(finer));
}

void probe_by_sampler(const Prepared& prepared,
                      const model::Receiver& receiver,
                      std::uint32_t point,
                      const ProbeOptions& options,
                      Probed& result) {
    std::vector<model::ReceiverF> receivers;
    for (const model::SamplingSlab& slab : prepared.sampling)
        receivers.push_back(in_slab(slab.prepared.slab, receiver));
    model::SamplerOptions drawn;
    drawn.sampler = options.sampler.sampler;
    drawn.sequence = model::default_sequence(drawn.sampler);
    drawn.samples = static_cast<int>(std::max(options.samples / kProbeSets, 1U));
    std::vector<model::SamplingView> views(prepared.sampling.size());
    std::vector<model::LightSample> samples;
    double sum = 0.0, squares = 0.0;
    for (std::uint32_t set = 0; set < kProbeSets; ++set) {
        const glm::vec2 shift =
            model::shift_of(model::Shift::Random, {point, 0U}, set, options.seed);
        const glm::dvec3 estimate(model::irradiance_by_sampler(prepared.sampling, receivers, drawn,
                                                               shift, views, samples));
        result.rgb += estimate / static_cast<double>(kProbeSets);
        const double y = model::luminance(estimate);
        sum += y;
        squares += y * y;
    }
    constexpr double kSets = kProbeSets;
    const double variance = std::max(squares / kSets - (sum / kSets) * (sum / kSets), 0.0);
    result.sigma_sampling_y = std::sqrt(variance / (kSets - 1.0));
}

}  // namespace

std::vector<Probed> probe(const LightField& lightfield,
                          const PointList& points,
                          const ProbeOptions& options) {
    const Prepared prepared = prepare(lightfield, options);
    std::vector<Probed> results(points.positions_m.size());
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t k) {
        const model::Receiver receiver{points.positions_m[k], points.normals[k]};
        Probed& result = results[k];
        const auto point = static_cast<std::uint32_t>(k);
        if (options.sampler.method == ProbeMethod::Aperture) {
            const model::Estimate estimate = model::irradiance_by_sampling(
                lightfield, receiver, options.samples, options.seed, point);
            result.rgb = estimate.value;
            result.sigma_sampling_y = estimate.sigma_y;
        } else if (options.sampler.method == ProbeMethod::Sampler) {
            probe_by_sampler(prepared, receiver, point, options, result);
        } else if (options.q > 0) {
            probe_coarsely(prepared, receiver, options.q, result);
        } else {
            result.rgb = model::irradiance(lightfield, receiver);
        }
        result.sigma_measured_y = model::irradiance_sigma_y(lightfield, receiver);
    });
    return results;
}

std::string as_csv(Quantity quantity,
                   bool has_bias,
                   const PointList& points,
                   const std::vector<Probed>& results) {
    std::string text = kPointColumns;
    for (const std::string& name : result_names(quantity, has_bias))
        text += "," + name;
    text += "\n";
    for (std::size_t k = 0; k < results.size(); ++k) {
        text += points.lines_text[k];
        for (const double value : result_values(results[k], has_bias))
            text += fmt::format(",{:.12g}", value);
        text += "\n";
    }
    return text;
}

std::string as_json(Quantity quantity,
                    bool has_bias,
                    const PointList& points,
                    const std::vector<Probed>& results) {
    const auto names = result_names(quantity, has_bias);
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < results.size(); ++k) {
        const glm::dvec3 p = points.positions_m[k], n = points.normals[k];
        nlohmann::ordered_json point = {{"x_m", p.x}, {"y_m", p.y}, {"z_m", p.z},
                                        {"nx", n.x},  {"ny", n.y},  {"nz", n.z}};
        const auto values = result_values(results[k], has_bias);
        for (std::size_t c = 0; c < names.size(); ++c)
            point[names[c]] = values[c];
        list.push_back(std::move(point));
    }
    return nlohmann::ordered_json{{"points", std::move(list)}}.dump(1) + "\n";
}

}  // namespace nearfield::app
