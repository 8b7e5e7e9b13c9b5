// SPDX-License-Identifier: Apache-2.0
// Samplers on the reference lamp (11 x 9 x 256^2, 300 receivers): relative RMS error against the
// oracle.
#include "formats/model/sampler.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace nearfield::model {
namespace {

/// The lamp, its receivers that see light (above 1e-3 of the largest irradiance), and the truth.
struct Reference {
    std::vector<SamplingSlab> slabs;
    std::vector<ReceiverF> receivers;
    std::vector<double> truth;
};

const Reference& reference() {
    static const Reference made = [] {
        Reference r;
        const Slab lamp = support::reference_lamp();
        std::vector<Receiver> receivers = support::reference_receivers();
        for (Receiver& receiver : receivers)
            receiver = {glm::dvec3(glm::vec3(receiver.position_m)),
                        glm::dvec3(glm::vec3(receiver.normal))};
        support::OracleOptions options;
        options.order = 4;  // converged: pieces are small beside their distance
        const std::vector<glm::dvec3> truth = support::oracle_irradiance(lamp, receivers, options);
        double largest = 0.0;
        for (const glm::dvec3& e : truth)
            largest = std::max(largest, e.x);
        for (std::size_t k = 0; k < receivers.size(); ++k)
            if (truth[k].x > 1e-3 * largest) {
                r.receivers.push_back(
                    {glm::vec3(receivers[k].position_m), glm::vec3(receivers[k].normal)});
                r.truth.push_back(truth[k].x);
            }
        r.slabs.push_back(prepare_sampling(lamp));
        return r;
    }();
    return made;
}

/// Relative RMS error and mean relative error over receivers and independent sets of samples.
struct Errors {
    double rms = 0.0, mean = 0.0, reads = 0.0;
};

Errors errors(const SamplerOptions& options, std::uint32_t sets) {
    const Reference& r = reference();
    std::vector<Errors> of_receiver(r.receivers.size());
    tbb::parallel_for(std::size_t{0}, r.receivers.size(), [&](std::size_t k) {
        std::vector<SamplingView> views(1);
        std::vector<LightSample> samples;
        for (std::uint32_t set = 0; set < sets; ++set) {
            const glm::vec2 xi = shift_of(Shift::Random, {static_cast<unsigned>(k), 0U}, set, 5U);
            const glm::vec3 e =
                irradiance_by_sampler(r.slabs, {&r.receivers[k], 1}, options, xi, views, samples);
            const double error = static_cast<double>(e.x) / r.truth[k] - 1.0;
            of_receiver[k].rms += error * error / sets;
            of_receiver[k].mean += error / sets;
        }
        of_receiver[k].reads = static_cast<double>(views[0].reads) / sets;
    });
    Errors sum;
    for (const Errors& e : of_receiver) {
        sum.rms += e.rms;
        sum.mean += e.mean;
        sum.reads += e.reads;
    }
    const auto n = static_cast<double>(of_receiver.size());
    return {std::sqrt(sum.rms / n), sum.mean / n, sum.reads / n};
}

SamplerOptions options_of(Sampler sampler, int samples) {
    SamplerOptions options;
    options.sampler = sampler;
    options.samples = samples;
    options.sequence = default_sequence(sampler);
    return options;
}

/// What the table of the design says: K, and the relative RMS of Uniform and Pdis, each the noisy
/// result of 8 sets.
struct Published {
    int samples;
    double uniform, pdis;
};
constexpr Published kPublished[] = {
    {16, 1.84, 0.94}, {63, 1.74, 0.87}, {200, 1.08, 0.53}, {1000, 0.27, 0.148}};

/// Few samples: many sets, so that a figure is known to 3 %; the sum of squares has a long tail.
std::uint32_t sets_for(int samples) {
    return samples <= 63 ? 32 : 8;
}

class EstimatorsOnReferenceLamp : public ::testing::Test {
  protected:
    /// Measures, records and returns.
    Errors measure(Sampler sampler, int samples) {
        const Errors found = errors(options_of(sampler, samples), sets_for(samples));
        const std::string name = name_of(sampler) + "_" + std::to_string(samples);
        RecordProperty(name + "_rms_1e-4", static_cast<int>(std::lround(1e4 * found.rms)));
        RecordProperty(name + "_mean_1e-4", static_cast<int>(std::lround(1e4 * found.mean)));
        RecordProperty(name + "_reads", static_cast<int>(std::lround(found.reads)));
        return found;
    }
};

// The baselines are the paper's: within 10 % of what an independent program gave. Proves nothing
// about their speed.
TEST_F(EstimatorsOnReferenceLamp, BaselinesAreThePapers) {
    EXPECT_EQ(reference().receivers.size(), 255U);
    for (const Published& row : kPublished) {
        EXPECT_NEAR(measure(Sampler::Uniform, row.samples).rms, row.uniform, 0.1 * row.uniform)
            << row.samples;
        EXPECT_NEAR(measure(Sampler::Pdis, row.samples).rms, row.pdis, 0.1 * row.pdis)
            << row.samples;
    }
}

// Pdis' rounding drops images: on average 88 % of the light at K = 16, 13 to 15 % at 63.
TEST_F(EstimatorsOnReferenceLamp, PdisLosesLight) {
    EXPECT_NEAR(errors(options_of(Sampler::Pdis, 16), 16).mean, -0.88, 0.03);
    EXPECT_NEAR(errors(options_of(Sampler::Pdis, 63), 16).mean, -0.14, 0.03);
}

// Limits: 0.13 at 63 and 0.016 at 1000 are demanded of Systematic, 0.10 at 63 of Cells; the rest is
// what they reached plus a tenth.
TEST_F(EstimatorsOnReferenceLamp, SystematicAndCellsReachTheirLimits) {
    EXPECT_LE(measure(Sampler::Systematic, 16).rms, 0.25);
    EXPECT_LE(measure(Sampler::Systematic, 63).rms, 0.12);
    EXPECT_LE(measure(Sampler::Systematic, 200).rms, 0.05);
    EXPECT_LE(measure(Sampler::Systematic, 1000).rms, 0.016);
    EXPECT_LE(measure(Sampler::Cells, 16).rms, 0.22);
    EXPECT_LE(measure(Sampler::Cells, 63).rms, 0.10);
    EXPECT_LE(measure(Sampler::Cells, 200).rms, 0.058);
    EXPECT_LE(measure(Sampler::Cells, 1000).rms, 0.0215);
}

}  // namespace
}  // namespace nearfield::model
