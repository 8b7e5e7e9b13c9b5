// SPDX-License-Identifier: Apache-2.0
#include "app/bench/cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace nearfield::bench {
namespace {

using model::Sampler;
using model::SamplerOptions;

constexpr std::array kSamplers = {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                  Sampler::Systematic, Sampler::Cells};
// From here on two passes are enough: each receiver's error is small, and receivers are many.
constexpr int kManySamples = 100000, kFewPasses = 2;
constexpr int kKnobSamples = 1000, kLampSamples = 200;

bool uses(const SweepOptions& options, Sampler sampler) {
    return is_chosen(options.samplers, model::name_of(sampler));
}

Method sampling(Sampler sampler, int samples) {
    Method method;
    SamplerOptions& options = method.sampling.emplace();
    options.sampler = sampler;
    options.samples = samples;
    options.sequence = model::default_sequence(sampler);
    return method;
}

int passes_of(const SweepOptions& options, int samples) {
    return samples > kManySamples ? std::min(options.repeats, kFewPasses) : options.repeats;
}

std::string text_of_steps(int steps) {
    return steps == 0 ? "to the end" : fmt::format("{} step{}", steps, steps == 1 ? "" : "s");
}

void add_search(const SweepOptions& options, std::vector<Case>& cases) {
    if (!uses(options, Sampler::Pdis))
        return;
    for (const model::Search search : {model::Search::Bisection, model::Search::Secant})
        for (const int steps : {1, 2, 3, 4, 6, 8, 12, 0}) {
            Method method = sampling(Sampler::Pdis, kKnobSamples);
            method.sampling->search = search;
            method.sampling->search_steps = steps;
            cases.push_back({"search", search == model::Search::Secant ? "secant" : "bisection",
                             text_of_steps(steps), method, options.repeats});
        }
}

void add_k_max(const SweepOptions& options, std::vector<Case>& cases) {
    if (!uses(options, Sampler::Pdis))
        return;
    for (const int k_max : {8, 16, 32, 64, 128, 0}) {
        Method method = sampling(Sampler::Pdis, kKnobSamples);
        method.sampling->k_max = k_max;
        cases.push_back({"k-max", "pdis", k_max == 0 ? "no limit" : fmt::format("K_max {}", k_max),
                         method, options.repeats});
    }
}

void add_sequences(const SweepOptions& options, std::vector<Case>& cases) {
    for (const Sampler sampler :
         {Sampler::Uniform, Sampler::Pdis, Sampler::Systematic, Sampler::Cells}) {
        if (!uses(options, sampler))
            continue;
        for (const int samples : {63, 1000})
            for (const model::Sequence sequence :
                 {model::Sequence::Halton, model::Sequence::R2, model::Sequence::Fibonacci,
                  model::Sequence::Sobol}) {
                Method method = sampling(sampler, samples);
                method.sampling->sequence = sequence;
                cases.push_back({"sequence", fmt::format("{} at K = {}", method.name(), samples),
                                 model::name_of(sequence), method, options.repeats});
            }
    }
}

void add_shifts(const SweepOptions& options, std::vector<Case>& cases) {
    if (!uses(options, Sampler::Systematic))
        return;
    for (const int samples : {4, 16, 63})
        for (const model::Shift shift : {model::Shift::Constant, model::Shift::Random,
                                         model::Shift::BlueNoise, model::Shift::Interleaved}) {
            Method method = sampling(Sampler::Systematic, samples);
            method.shift = shift;
            cases.push_back({"shift", fmt::format("systematic at K = {}", samples),
                             model::name_of(shift), method, 1});
        }
}

void add_precisions(const SweepOptions& options, std::vector<Case>& cases) {
    for (const Sampler sampler : {Sampler::Pdis, Sampler::Systematic, Sampler::Cells}) {
        if (!uses(options, sampler))
            continue;
        for (const auto precision : {model::TablePrecision::Float, model::TablePrecision::Pair}) {
            Method method = sampling(sampler, kKnobSamples);
            method.sampling->precision = precision;
            const bool is_float = precision == model::TablePrecision::Float;
            cases.push_back({"precision", method.name(), is_float ? "one float" : "two floats",
                             method, options.repeats});
        }
    }
}

}  // namespace

SweepText text_of(const std::string& sweep) {
    if (sweep == "search")
        return {"Depth of the search",
                fmt::format("pdis inverts its tables by bisection or by the secant rule that its "
                            "paper prints. Cut "
                            "short, either returns the wrong texel, which is error that more "
                            "samples do not remove. "
                            "K = {}.",
                            kKnobSamples),
                "depth", "search"};
    if (sweep == "k-max")
        return {
            "Most samples of one image",
            fmt::format("pdis may limit how many samples one image gets. K = {}.", kKnobSamples),
            "limit"};
    if (sweep == "sequence")
        return {"Sequence",
                "Which points the samplers take, shifted at random from receiver to receiver.",
                "sequence"};
    if (sweep == "shift")
        return {"Shift from pixel to pixel",
                "On the wall of the pictures. The last column is what remains when a viewer's eye "
                "averages 4 "
                "x 4 pixels: "
                "blue noise and interleaved shifts spread the error so that neighbors cancel; a "
                "constant shift "
                "leaves a pattern that nothing averages out.",
                "shift"};
    if (sweep == "precision")
        return {"Precision of the tables",
                fmt::format("Summed-area tables in one float, and as a sum of two. K = {}. One "
                            "float is worst in "
                            "dark places of large images; see the hard cases in the documentation.",
                            kKnobSamples),
                "tables"};
    if (sweep == "basis")
        return {"Basis",
                fmt::format(
                    "The lamp's images under another basis: a wider one needs more of each image. "
                    "Samplers with K = {}.",
                    kLampSamples),
                "basis"};
    if (sweep == "texels")
        return {"Resolution of the images",
                fmt::format("The lamp's images averaged down, against the exact light of the full "
                            "resolution: what "
                            "coarser images save, and what they miss. Samplers with K = {}.",
                            kLampSamples),
                "texels"};
    return {"Samplers", "", "K or Q"};
}

bool is_chosen(const std::vector<std::string>& chosen, const std::string& name) {
    return chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
}

std::vector<std::string> sampler_names() {
    std::vector<std::string> names = {"sum"};
    for (const Sampler sampler : kSamplers)
        names.push_back(model::name_of(sampler));
    return names;
}

std::vector<std::string> sweep_names() {
    return {"samplers", "search", "k-max",  "sequence", "precision",
            "shift",    "basis",  "texels", "pictures"};
}

std::vector<Method> chosen_samplers(const SweepOptions& options) {
    std::vector<Method> methods;
    for (const Sampler sampler : kSamplers)
        if (uses(options, sampler))
            methods.push_back(sampling(sampler, kLampSamples));
    return methods;
}

std::vector<Case> sampler_cases(const SweepOptions& options) {
    std::vector<Case> cases;
    if (is_chosen(options.samplers, "sum")) {
        std::vector<int> q = options.q;
        q.push_back(0);
        for (const int size : q) {
            Method method;
            method.q = size;
            cases.push_back({"samplers", "sum", size == 0 ? "exact" : fmt::format("Q = {}", size),
                             method, 1});  // no noise: every pass is the same
        }
    }
    for (const Sampler sampler : kSamplers)
        if (uses(options, sampler))
            for (const int samples : options.k)
                cases.push_back({"samplers", model::name_of(sampler),
                                 fmt::format("K = {}", samples), sampling(sampler, samples),
                                 passes_of(options, samples)});
    return cases;
}

std::vector<Case> knob_cases(const SweepOptions& options, const std::string& sweep) {
    std::vector<Case> cases;
    if (sweep == "search")
        add_search(options, cases);
    if (sweep == "k-max")
        add_k_max(options, cases);
    if (sweep == "sequence")
        add_sequences(options, cases);
    if (sweep == "precision")
        add_precisions(options, cases);
    if (sweep == "shift")
        add_shifts(options, cases);
    return cases;
}

std::vector<Case> lamp_cases(const SweepOptions& options,
                             const std::string& sweep,
                             const std::string& setting) {
    std::vector<Case> cases;
    if (is_chosen(options.samplers, "sum"))
        cases.push_back({sweep, "sum", setting, Method{}, 1});
    for (const Sampler sampler : {Sampler::Pdis, Sampler::Systematic, Sampler::Cells})
        if (uses(options, sampler))
            cases.push_back({sweep, model::name_of(sampler), setting,
                             sampling(sampler, kLampSamples), options.repeats});
    return cases;
}

double weight(const Case& a_case) {
    constexpr double kLookOrSum = 500.0;  // in samples
    const double samples =
        a_case.method.sampling ? static_cast<double>(a_case.method.sampling->samples) : 0.0;
    return a_case.passes * (kLookOrSum + samples);
}

}  // namespace nearfield::bench
