// SPDX-License-Identifier: Apache-2.0
/// The cases of each sweep.
#pragma once

#include "app/bench/sweeps.h"

#include <string>
#include <vector>

namespace nearfield::bench {

struct SweepText {
    std::string title, explanation;
    std::string setting_name;            // what is varied
    std::string curve_name = "sampler";  // what its curves are
};
SweepText text_of(const std::string& sweep);

bool is_chosen(const std::vector<std::string>& chosen, const std::string& name);

/// The samplers of model::Sampler that options chose, in report order.
std::vector<Method> chosen_samplers(const SweepOptions& options);

/// All samplers against K, the sum against Q.
std::vector<Case> sampler_cases(const SweepOptions& options);
/// The knobs that need no other lamp: "search", "k-max", "sequence", "precision"; "shift", which
/// needs a grid of receivers.
std::vector<Case> knob_cases(const SweepOptions& options, const std::string& sweep);
/// The same few methods on a lamp that is varied ("basis", "texels"), whose name is the setting.
std::vector<Case> lamp_cases(const SweepOptions& options,
                             const std::string& sweep,
                             const std::string& setting);

/// What a case costs, roughly: proportional to its time.
double weight(const Case& a_case);

}  // namespace nearfield::bench
