// SPDX-License-Identifier: Apache-2.0
#include "app/sampler_options.h"

namespace nearfield::app {

std::vector<std::pair<std::string, std::optional<model::Sampler>>> sampler_choices() {
    using model::Sampler;
    std::vector<std::pair<std::string, std::optional<Sampler>>> choices = {{"sum", std::nullopt}};
    for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells, Sampler::Pdis,
                                  Sampler::Precomputed, Sampler::Uniform})
        choices.emplace_back(model::name_of(sampler), sampler);
    return choices;
}

std::vector<std::pair<std::string, std::optional<model::Sequence>>> sequence_choices() {
    using model::Sequence;
    std::vector<std::pair<std::string, std::optional<Sequence>>> choices = {
        {"automatic", std::nullopt}};
    for (const Sequence sequence :
         {Sequence::Halton, Sequence::R2, Sequence::Fibonacci, Sequence::Sobol})
        choices.emplace_back(model::name_of(sequence), sequence);
    return choices;
}

std::vector<std::pair<std::string, model::Shift>> shift_choices() {
    using model::Shift;
    std::vector<std::pair<std::string, Shift>> choices;
    for (const Shift shift : {Shift::Random, Shift::BlueNoise, Shift::Interleaved, Shift::Constant})
        choices.emplace_back(model::name_of(shift), shift);
    return choices;
}

}  // namespace nearfield::app
