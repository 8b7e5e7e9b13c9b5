// SPDX-License-Identifier: Apache-2.0
#include "tests/model/hard_cases_errors.h"

#include "formats/model/luminaire.h"
#include "tests/support/oracle.h"

#include <algorithm>
#include <cmath>

namespace nearfield::test {

using support::as_double;
using support::as_float;
using support::hard_receivers;
using support::HardReceiver;
using support::LampShape;
using support::oracle_irradiance;
using support::random_lamp;
using support::ReceiverKind;

std::string with(Weighting weighting) {
    return weighting == Weighting::Irradiance ? ", irradiance weighting" : ", radiance weighting";
}

double relative_error(double got, double expected) {
    if (got == expected)
        return 0.0;
    const double error = std::abs(got - expected) / std::abs(expected);
    return std::isnan(error) ? INFINITY : error;
}

void SumErrors::add(const Slab& slab,
                    const model::PreparedSlab& prepared,
                    const model::ReceiverF& receiver) {
    const double expected = oracle_irradiance(slab, as_double(receiver)).x;
    const double got_float = irradiance(prepared, receiver).x;
    const double got_double = irradiance(slab, as_double(receiver)).x;
    in_float = std::max(in_float, relative_error(got_float, expected));
    in_double = std::max(in_double, relative_error(got_double, expected));
    for (const double got : {got_float, got_double})
        negative += got >= 0.0 && std::isfinite(got) ? 0.0 : 1.0;
}

SumErrors errors_at(Weighting weighting,
                    const std::vector<double>& heights_per_delta,
                    const std::vector<ReceiverKind>& kinds,
                    const LampShape& shape) {
    SumErrors errors;
    std::uint64_t seed = 7000;
    for (const Profile& profile : support::all_profiles()) {
        const Slab slab = random_lamp(profile, weighting, ++seed, shape);
        const model::PreparedSlab prepared = model::prepare(slab);
        for (const double height : heights_per_delta)
            for (const HardReceiver& hard : hard_receivers(slab, height, ++seed))
                if (std::ranges::find(kinds, hard.kind) != kinds.end())
                    errors.add(slab, prepared, as_float(hard.receiver));
    }
    return errors;
}

std::vector<ReceiverKind> every_kind() {
    return {ReceiverKind::Facing, ReceiverKind::Tilted,  ReceiverKind::Cut,
            ReceiverKind::Back,   ReceiverKind::Partial, ReceiverKind::Beside};
}

std::vector<double> every_height() {
    return {std::begin(support::kHardHeights), std::end(support::kHardHeights)};
}

}  // namespace nearfield::test
