// SPDX-License-Identifier: Apache-2.0
/// From a picture's radiance to pixels that a display shows (docs/scenes.md, "Tone mapping").
#pragma once

#include "formats/files/image.h"

#include <optional>
#include <vector>

namespace nearfield::render {

enum class ToneMap {
    Filmic,  // a film's curve on luminance; colors keep their hue
    Papers,  // 1 - exp(-L), channel by channel
};

struct DisplayOptions {
    ToneMap tonemap = ToneMap::Filmic;
    /// Exposure value at ISO 100: radiance 1.2 * 2^EV becomes 1 before the curve. +1 makes it
    /// darker by one stop. None: automatic.
    std::optional<double> exposure_ev;
};

struct Display {
    std::vector<unsigned char> srgb;  // [row from the top][column][r, g, b]
    double exposure_ev = 0;           // as used
};

/// Tone maps the picture's default layer. Throws Error if it has none of three channels.
Display display(const Picture& picture, const DisplayOptions& options);

/// The radiance that becomes 1 before the curve.
double white_of(double exposure_ev);

/// Filmic: 95 % of the pixels that light reaches stay below 1. Papers: the frame's mean luminance
/// becomes 1. 0 for a picture without light.
double automatic_exposure_ev(const Layer& rgb, ToneMap tonemap);

}  // namespace nearfield::render
