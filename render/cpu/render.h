// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/image.h"
#include "formats/files/lightfield.h"
#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <string>

namespace nearfield::render {

struct RenderOptions {
    glm::ivec2 size_px{640,
                       0};  // height 0: by the camera's aspect ratio, 3/4 of the width if unknown
    std::string camera;     // by name; empty: the first
    int samples_per_pixel = 1;    // 1: the pixel's center; n*n: n x n strata
    int visibility_samples = 64;  // a pixel and lamp, >= 2; more: less noise in penumbrae and gloss
    std::uint32_t seed = 1;
    int threads = 0;  // 0: all cores. The picture does not depend on it
    /// Adds the layer sigma_measured where a lamp's file holds sigmas: in double, many times
    /// the time of a light sum.
    bool sigma_measured = false;
};

/// Throws Error naming the option if one is out of range.
void check(const RenderOptions& options);

/// Sampling sigma of radiance Y relative to radiance Y, over lit pixels: those brighter than 1e-3
/// of the brightest.
struct Noise {
    double mean_rel = 0, p95_rel = 0;  // p95: what 95 % of the lit pixels do not exceed
    double share_above_10_percent = 0;
};

/// Of a picture's layers: radiance R, G, B and sigma Y. All 0 where nothing is lit.
Noise summarize_noise(const Layer& radiance, const Layer& sigma);

/// What a picture cost and how noisy it is. Stages' times are shares of the wall time by time spent
/// in them.
struct RenderReport {
    Quantity quantity = Quantity::Photometric;  // radiance is in cd/m^2 or in W/(m^2 sr)
    double load_s = 0, build_s = 0, camera_s = 0, sums_s = 0, visibility_s = 0;
    int threads = 0;  // used
    std::uint64_t camera_rays = 0, shadow_rays = 0;
    double multiply_adds = 0;  // of the windowed sums
    Noise sampling;
    bool has_sigma_measured = false;  // the layer is there: it was asked for, and a file knows
};

struct Rendered {
    Picture picture;  // layers as listed in docs/scenes.md; provenance is empty
    RenderReport report;
};

/// A report in one line for people.
std::string summary(const RenderReport& report, glm::ivec2 size_px);
std::string summary(const Noise& noise);

/// What a picture's file says of where it comes from: options, light fields with their hashes,
/// figures. The scene's own file is the caller's to add to the inputs, where there is one.
Provenance describe(const Scene& scene, const RenderOptions& options, const RenderReport& report);

/// Renders the light that arrives directly from the scene's luminaires.
///
/// Out     the same bits for any number of threads. Sampling noise in penumbrae and gloss alone;
///         its sigma is a layer.
/// Throws  Error if a camera or light field is missing or not one.
/// Cost    a camera sample and lit lamp: one windowed sum (prepared.h) and visibility_samples
///         shadow rays.
Rendered render(const Scene& scene,
                const RenderOptions& options,
                const std::function<void(double fraction)>& progress = {});

}  // namespace nearfield::render
