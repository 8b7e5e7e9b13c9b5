// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/quality.h"

#include <algorithm>
#include <cmath>

namespace nearfield::viewer {
namespace {

Quality quality(int q, int maps, int map_px, int taps, bool has_gloss) {
    Quality made;
    made.q = q;
    made.shadow_maps.maps = maps;
    made.shadow_maps.map_px = map_px;
    made.shadow_maps.pcf_taps = taps;
    made.has_gloss = has_gloss;
    return made;
}

}  // namespace

const std::vector<Dial>& dials() {
    static const std::vector<Dial> all = {{"fast", quality(4, 4, 64, 4, false)},
                                          {"faster than exact", quality(8, 8, 96, 4, true)},
                                          {"near exact", quality(16, 16, 192, 4, true)},
                                          {"exact light", quality(0, 0, 192, 4, true)},
                                          {"finer shadows", quality(0, 0, 384, 4, true)},
                                          {"finest shadows", quality(0, 0, 768, 9, true)}};
    return all;
}

std::vector<Quality> stages_of(int dial, int draft_divisor) {
    const Quality wanted = dials()[static_cast<std::size_t>(dial)].quality;
    std::vector<Quality> stages;
    Quality draft = dials().front().quality;
    draft.divisor = draft_divisor;
    draft.has_bias_bound = false;
    stages.push_back(draft);
    if (draft_divisor > 2) {
        Quality half = draft;
        half.divisor = 2;
        stages.push_back(half);
    }
    if (!(stages.back() == wanted))
        stages.push_back(wanted);
    return stages;
}

int next_draft_divisor(int divisor, double time_s, double wanted_s) {
    constexpr int kCoarsest = 16;
    if (time_s > 1.3 * wanted_s)  // at once: a hand is waiting
        return std::min(static_cast<int>(std::ceil(divisor * std::sqrt(time_s / wanted_s))),
                        kCoarsest);
    // Finer by a step. The pixels of the next finer one.
    const double ratio = static_cast<double>(divisor) / std::max(divisor - 1, 1);
    return time_s * ratio * ratio < 0.9 * wanted_s ? std::max(divisor - 1, 1) : divisor;
}

render::RenderOptions options_of(const Quality& quality, glm::ivec2 size_px) {
    render::RenderOptions options;
    options.device = render::Device::Gl;
    options.size_px = (size_px + quality.divisor - 1) / quality.divisor;
    options.q = quality.q;
    options.has_bias_bound = quality.has_bias_bound;
    options.shadow_maps = quality.shadow_maps;
    options.effects.gloss = quality.has_gloss ? render::Switch::Auto : render::Switch::Off;
    options.is_displayed = true;
    options.shows_lamps = true;
    return options;
}

}  // namespace nearfield::viewer
