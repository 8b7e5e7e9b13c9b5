// SPDX-License-Identifier: Apache-2.0
/// A rendered view, lamp by lamp, and how lamps' light is mixed without rendering: light is linear
/// in dim and tint.
#pragma once

#include "app/viewer/document.h"
#include "app/viewer/quality.h"
#include "formats/files/lightfield.h"
#include "render/report.h"

#include <glm/glm.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::viewer {

/// One lamp's light at every pixel; [row from the top][column][channel].
struct LampLight {
    int lamp = 0;                             // id
    double dim = 1.0;                         // that it was rendered with; tint: none
    std::vector<float> radiance, irradiance;  // R, G, B
    std::vector<float> sigma, bias;           // of radiance Y; bias empty where sums are exact
    std::vector<float> seen;  // radiance of the lamp itself, R, G, B, beside that; empty: none
};

/// What was rendered of a view.
struct Frame {
    /// Whether sigma and bias are all that may be wrong, shadow maps aside.
    bool knows_error() const { return quality.q == 0 || quality.has_bias_bound; }

    glm::ivec2 size_px{0};
    Camera camera;
    Quality quality;
    Quantity quantity = Quantity::Photometric;
    std::vector<std::shared_ptr<const LampLight>> lamps;
    std::vector<float> depth_m;   // 0: nothing is seen
    render::RenderReport report;  // of the last lamp; times and memory by pass of all
    double time_s = 0;            // that it took
    int serial = 0;               // rises with every frame
};

/// How much of a lamp's light is in the picture, channel by channel.
struct LampGain {
    int lamp = 0;
    glm::vec3 factor{1.0F};  // of the light as rendered; 1 where nothing was changed since
};

/// The frame's lamps as the document has them; only: of one lamp alone.
std::vector<LampGain> gains_of(const Frame& frame,
                               const Document& document,
                               std::optional<int> only = std::nullopt);

/// Lamps added up.
struct Mixed {
    glm::ivec2 size_px{0};
    std::vector<float> radiance, irradiance;  // R, G, B
    std::vector<float> sigma, bias;           // of radiance Y; variances add, and so do bounds
};

/// In the lamps' order, as the renderer adds them.
Mixed mix(const Frame& frame, const std::vector<LampGain>& gains);

/// At one pixel.
struct Reading {
    glm::vec3 radiance{0.0F}, irradiance{0.0F};
    double irradiance_y = 0, radiance_y = 0;
    double sigma_rel = 0, bias_rel = 0;  // of radiance, and as much of irradiance
    double depth_m = 0;                  // 0: nothing is seen
    glm::dvec3 position_world_m{0.0};
};
Reading reading_at(const Frame& frame, const Mixed& mixed, glm::ivec2 pixel);

/// Of irradiance Y over pixels of a rectangle at which something is seen.
struct RegionStatistics {
    std::size_t pixels = 0;
    double least = 0, largest = 0, mean = 0;
    double uniformity = 0;  // least / mean; 0 in the dark
};
RegionStatistics statistics_of(const Frame& frame,
                               const Mixed& mixed,
                               glm::ivec2 from_px,
                               glm::ivec2 to_px);

}  // namespace nearfield::viewer
