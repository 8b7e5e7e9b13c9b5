// SPDX-License-Identifier: Apache-2.0
/// From fast to exact: the positions of the viewer's dial, and what is drawn while one waits.
#pragma once

#include "render/options.h"

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace nearfield::viewer {

struct Quality {
    int divisor = 1;  // of the picture's sides
    int q = 0;        // RenderOptions::q
    render::ShadowMapOptions shadow_maps;
    bool has_gloss = true;
    bool has_bias_bound = true;  // drafts do without

    bool operator==(const Quality&) const = default;
};

/// What kDials[k] is called, and how it renders at full size. The default is what
/// `nearfield render --device gl` does.
struct Dial {
    const char* name;
    Quality quality;
};
const std::vector<Dial>& dials();
constexpr int kDefaultDial = 3;

/// A picture's sizes on the way to the dial's: a draft, at `draft_divisor`; one of a quarter of the
/// pixels; the picture itself. Those that would be no cheaper than the next are left out.
std::vector<Quality> stages_of(int dial, int draft_divisor);

/// The divisor of the next draft after one of `time_s`, so that drafts take about `wanted_s`:
/// coarser at once, finer a step at a time, within 1 ... 16.
int next_draft_divisor(int divisor, double time_s, double wanted_s);

/// What a picture of these is asked for, for a window of that size.
render::RenderOptions options_of(const Quality& quality, glm::ivec2 size_px);

}  // namespace nearfield::viewer
