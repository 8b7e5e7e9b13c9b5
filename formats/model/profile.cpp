// SPDX-License-Identifier: Apache-2.0
#include "formats/model/profile.h"

#include "formats/files/error.h"

#define SHARED_NAMESPACE shared::f64
#include "formats/shared/basis.glsl.h"

namespace nearfield::model {
namespace {

const std::vector<Profile>& named_profiles() {
    static const std::vector<Profile> profiles = {
        {"box", {{1.0, 0.0, 0.0}}},
        {"bilinear", {{1.0, 1.0, 0.0}, {1.0, -1.0, 0.0}}},
        {"quadratic", {{1.0, 0.0, -1.0}, {1.0, 0.0, -1.0}}},
        // 3/4 - x^2 in the middle, (3/2 - |x|)^2 / 2 beside it.
        {"bspline", {{1.125, 1.5, 0.5}, {0.75, 0.0, -1.0}, {1.125, -1.5, 0.5}}},
    };
    return profiles;
}

}  // namespace

std::vector<std::string> profile_names() {
    std::vector<std::string> names;
    for (const Profile& profile : named_profiles())
        names.push_back(profile.name);
    return names;
}

Profile make_profile(const std::string& name) {
    std::string known;
    for (const Profile& profile : named_profiles()) {
        if (profile.name == name)
            return profile;
        known += (known.empty() ? "" : ", ") + profile.name;
    }
    throw Error{"unknown basis", "", known, "'" + name + "'"};
}

double eval(const Profile& profile, double x) {
    const auto n = static_cast<double>(profile.cells.size());
    const double cell = shared::f64::profile_cell(x, n);
    if (!(cell >= 0.0 && cell < n))
        return 0.0;
    const auto& [a0, a1, a2] = profile.cells[static_cast<std::size_t>(cell)];
    return shared::f64::profile_value(x, a0, a1, a2);
}

double integral(const Profile& profile, std::size_t c) {
    const auto n = static_cast<double>(profile.cells.size());
    const double middle = static_cast<double>(c) + 0.5 * (1.0 - n);
    const auto& [a0, a1, a2] = profile.cells[c];
    return shared::f64::profile_value(middle, a0, a1, a2) +
           a2 / 12.0;  // midpoint rule and its exact correction
}

double integral(const Profile& profile) {
    double sum = 0.0;
    for (std::size_t c = 0; c < profile.cells.size(); ++c)
        sum += integral(profile, c);
    return sum;
}

}  // namespace nearfield::model
