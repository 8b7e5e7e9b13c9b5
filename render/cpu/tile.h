// SPDX-License-Identifier: Apache-2.0
/// A picture's tiles: independent of each other, each the work of one thread at a time.
#pragma once

#include "render/cpu/shade.h"
#include "render/cpu/tracer.h"
#include "render/film.h"
#include "render/lamps.h"
#include "render/report.h"
#include "render/sky.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace nearfield::render {

constexpr int kTilePx = 16;  // 256 pixels: enough work a task, few enough idle cores at the end

/// Samples that all of a pixel's strata draw of a lamp in one pass over the frame.
struct Pass {
    std::uint32_t index = 0;  // its random numbers are its own
    int samples = 64;
    int q = 0;            // of the windowed sum; 0: exact
    float weight = 1.0F;  // among passes
};

/// What all tiles share. Between passes the picture holds sums: radiance and what is linear in it
/// times the passes' weights, sigma's layer variances times their squares.
struct Frame {
    const Scene& scene;
    const RenderOptions& options;
    const Camera& camera;
    const Lamps& lamps;
    const Tracer& tracer;
    const Plan& plan;
    Picture& picture;
    std::vector<shared::Brdf> brdfs;  // [material], of what the plan has of it
    int strata = 1;                   // a pixel's side
    std::optional<std::size_t> bias_layer, measured_layer, environment_layer;
    const Sky* sky = nullptr;  // null: darkness all around

    glm::ivec2 tiles() const { return (picture.size_px + kTilePx - 1) / kTilePx; }
};

struct TileReport {
    double camera_s = 0, sums_s = 0;
    double shading_s = 0;  // all that follows, of which:
    double shadow_rays_s = 0, gloss_s = 0;
    double sky_s = 0;  // light of the environment, its rays included
    std::uint64_t camera_rays = 0, shadow_rays = 0, sky_samples = 0, multiply_adds = 0;
};

/// Adds one pass of the pixels from `first` to `first + kTilePx`; a first pass (index 0) also
/// writes what needs no light.
void render_tile(const Frame& frame, const Pass& pass, glm::ivec2 first, TileReport& report);

/// What a tile's sums hold: the passes' weights, and their squares.
struct TileWeight {
    float sum = 0.0F, squares = 0.0F;

    void add(const Pass& pass) {
        sum += pass.weight;
        squares += pass.weight * pass.weight;
    }
};

/// Turns the tile's sums into means, and variances into sigma.
void finish_tile(const Frame& frame, glm::ivec2 first, const TileWeight& weight);

/// What multiplies the root of a pixel's variance, which few sets tell: unbiased_root.
float root_of_variance(const RenderOptions& options, const TileWeight& weight);

}  // namespace nearfield::render
