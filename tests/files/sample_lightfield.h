// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/luminaire.h"

#include <functional>
#include <string>

namespace nearfield::test {

/// How large and of which kind a made-up slab is.
struct SampleShape {
    glm::ivec2 grid{3, 2};
    glm::ivec2 texels{5, 4};
    int channels = 1;
    bool has_sigma = false;
};

/// A slab whose coefficients all differ, W != H, texels not square, pose not trivial.
Slab sample_slab(const SampleShape& shape);

/// Two slabs of different shapes with provenance, both weightings.
LightField sample_lightfield();

/// The light field with tables that have the right sizes and values that all differ (what they mean
/// is not tested here: model builds and verifies tables).
Luminaire sample_luminaire();

std::string read_bytes(const std::string& path);

/// What an action's Error says, "" if it succeeds.
std::string message_of(const std::function<void()>& action);

}  // namespace nearfield::test
