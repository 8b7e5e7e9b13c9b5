// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"

#include <string>
#include <vector>

namespace nearfield::model {

/// The basis profiles that have a name: "box", "bilinear", "quadratic", "bspline".
/// "quadratic" (1 - x^2 on |x| <= 1) does not sum to one: ripple 1 ... 1.5 in one dimension.
std::vector<std::string> profile_names();

/// Throws Error on an unknown name.
Profile make_profile(const std::string& name);

/// phi(x), x in pitches from the center; 0 outside the support. A cell owns its lower edge.
double eval(const Profile& profile, double x);

/// Integral of phi over its support, in pitches, and over its cell c.
double integral(const Profile& profile);
double integral(const Profile& profile, std::size_t c);

}  // namespace nearfield::model
