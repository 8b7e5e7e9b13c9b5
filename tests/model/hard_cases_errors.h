// SPDX-License-Identifier: Apache-2.0
/// Errors of both sums against the oracle, for the hard cases.
#pragma once

#include "formats/model/prepared.h"
#include "tests/support/lamps.h"
#include "tests/support/receivers.h"

#include <string>
#include <vector>

namespace nearfield::test {

constexpr Weighting kWeightings[] = {Weighting::Irradiance, Weighting::Radiance};

/// ", irradiance weighting".
std::string with(Weighting weighting);

/// Infinite where only the truth is 0, or got is not a number.
double relative_error(double got, double expected);

/// The worst of all that was added.
struct SumErrors {
    double in_float = 0, in_double = 0;
    double negative = 0;  // results below 0, or not finite

    void add(const Slab& slab,
             const model::PreparedSlab& prepared,
             const model::ReceiverF& receiver);
};

/// Worst errors over lamps of all profiles, at receivers of the given kinds and heights.
SumErrors errors_at(Weighting weighting,
                    const std::vector<double>& heights_per_delta,
                    const std::vector<support::ReceiverKind>& kinds,
                    const support::LampShape& shape = {});

std::vector<support::ReceiverKind> every_kind();
std::vector<double> every_height();

}  // namespace nearfield::test
