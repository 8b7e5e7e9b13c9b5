// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/provenance.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield {

/// A named group of channels of a picture: "" (the picture itself) R G B, "irradiance" R G B,
/// "depth" Z, ...
struct Layer {
    std::string name;                   // EXR layer; "" for the default one
    std::vector<std::string> channels;  // {"R", "G", "B"} or {"Y"} ...
    std::vector<float> values;          // [row from the top][column][channel]
};

/// A rendered picture: layers of one size.
struct Picture {
    glm::ivec2 size_px{0};
    std::vector<Layer> layers;
    Provenance provenance;
};

/// Writes a one-part EXR (float, ZIP), whole or not at all.
void write_picture(const Picture& picture,
                   const std::optional<RunRecord>& run,
                   const std::string& path);

/// Reads a picture that write_picture wrote (any EXR with float or half channels, one part).
Picture read_picture(const std::string& path);

/// Writes 8-bit sRGB-encoded pixels, [row from the top][column][r, g, b], as PNG, whole or not at
/// all.
void write_png(const std::vector<unsigned char>& rgb, glm::ivec2 size_px, const std::string& path);

}  // namespace nearfield
