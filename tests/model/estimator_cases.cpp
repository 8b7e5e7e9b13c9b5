// SPDX-License-Identifier: Apache-2.0
#include "tests/model/estimator_cases.h"

#include "formats/model/profile.h"
#include "tests/support/oracle.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::model {
namespace {

using support::LampShape;
using support::random_lamp;

LightField lamp_of(Slab slab) {
    LightField lightfield;
    lightfield.slabs.push_back(std::move(slab));
    return lightfield;
}

Slab one_lit_texel() {
    Slab slab = random_lamp(make_profile("bspline"), Weighting::Irradiance, 31);
    std::fill(slab.coeffs.begin(), slab.coeffs.end(), 0.0F);
    const std::size_t middle = static_cast<std::size_t>(9 * slab.texels.x + 11);
    slab.coeffs[slab.image_offset(0, 7) + middle] = 50.0F;
    return slab;
}

LightField two_slabs() {
    LightField lightfield;
    for (std::uint64_t k = 0; k < 2; ++k) {
        LampShape shape;
        shape.delta_m = k == 0 ? 0.2 : 0.05;
        lightfield.slabs.push_back(random_lamp(make_profile("bspline"),
                                               k == 0 ? Weighting::Irradiance : Weighting::Radiance,
                                               32 + k, shape));
    }
    lightfield.slabs[1].luminaire_from_slab = {support::rotation_about({0.0, 1.0, 0.0}, 0.5),
                                               {0.1, 0.02, -0.03}};
    return lightfield;
}

}  // namespace

std::vector<EstimatorCase> estimator_cases() {
    const auto facing = [](double x, double y, double z) {
        return Receiver{{x, y, z}, glm::normalize(glm::dvec3(0.3, -0.2, -1.0))};
    };
    std::vector<EstimatorCase> cases;
    cases.push_back(
        {"reference lamp, glare", lamp_of(support::reference_lamp()), facing(-0.4, 0.25, 5.0)});
    cases.push_back(
        {"reference lamp, beam", lamp_of(support::reference_lamp()), facing(0.1, -0.3, 1.5)});
    cases.push_back({"one lit texel", lamp_of(one_lit_texel()), facing(0.01, 0.02, 0.3)});
    LampShape wide;
    wide.decades = 10;
    wide.dark_fraction = 0.0;
    cases.push_back(
        {"range 1e10",
         lamp_of(random_lamp(make_profile("bilinear"), Weighting::Irradiance, 33, wide)),
         facing(0.02, 0.01, 0.15)});
    LampShape color;
    color.channels = 3;
    color.grid = {7, 2};
    cases.push_back(
        {"W != H, color",
         lamp_of(random_lamp(support::measured_profile(), Weighting::Radiance, 34, color)),
         facing(0.03, -0.02, -0.08)});
    cases.push_back({"two slabs", two_slabs(), facing(0.05, 0.0, 0.35)});
    return cases;
}

ReadyCase make_ready(const EstimatorCase& from) {
    ReadyCase ready;
    for (const Slab& slab : from.lightfield.slabs) {
        const Receiver in_slab = to_slab(slab, from.receiver);
        ready.receivers.push_back({glm::vec3(in_slab.position_m), glm::vec3(in_slab.normal)});
        const Receiver rounded{glm::dvec3(ready.receivers.back().position_m),
                               glm::dvec3(ready.receivers.back().normal)};
        ready.truth_y += luminance(support::oracle_irradiance(slab, rounded));
        ready.slabs.push_back(prepare_sampling(slab));
    }
    return ready;
}

Runs run(const ReadyCase& ready,
         const SamplerOptions& options,
         int count,
         const std::function<glm::vec2(std::uint32_t run)>& shift) {
    std::vector<double> estimate(static_cast<std::size_t>(count));
    constexpr int kBlock = 256;
    tbb::parallel_for(0, (count + kBlock - 1) / kBlock, [&](int block) {
        std::vector<SamplingView> views(ready.slabs.size());
        std::vector<LightSample> samples;
        for (std::size_t k = 0; k < ready.slabs.size(); ++k)
            look(ready.slabs[k], ready.receivers[k], options, views[k]);
        for (int r = block * kBlock; r < std::min(count, (block + 1) * kBlock); ++r) {
            draw(ready.slabs, views, options, shift(static_cast<std::uint32_t>(r)), samples);
            glm::dvec3 sum(0.0);
            for (const LightSample& sample : samples)
                sum += glm::dvec3(sample.light);
            estimate[static_cast<std::size_t>(r)] = luminance(sum);
        }
    });
    Runs runs;
    for (const double e : estimate)
        runs.mean += e / count;
    double variance = 0.0;
    for (const double e : estimate)
        variance += (e - runs.mean) * (e - runs.mean) / (count - 1);
    runs.deviation = std::sqrt(variance);
    runs.standard_error = runs.deviation / std::sqrt(count);
    return runs;
}

std::function<glm::vec2(std::uint32_t)> random_shift(std::uint32_t seed) {
    return [seed](std::uint32_t r) { return shift_of(Shift::Random, {r, 0U}, 0U, seed); };
}

double z_score(const Runs& runs, double truth) {
    return (runs.mean - truth) / std::hypot(runs.standard_error, 1e-5 * truth);
}

}  // namespace nearfield::model
