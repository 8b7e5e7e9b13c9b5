// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/image.h"
#include "formats/files/lightfield.h"
#include "formats/model/sampler.h"
#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace nearfield::render {

// So many samples a camera sample and lamp keep the ratio estimator's bias small.
constexpr int kFewestSamples = 8;
constexpr int kUsualSamples = 64;
constexpr int kMostSamples = 1 << 20;

struct RenderOptions {
    glm::ivec2 size_px{640,
                       0};  // height 0: by the camera's aspect ratio, 3/4 of the width if unknown
    std::string camera;     // by name; empty: the first
    int samples_per_pixel = 1;  // 1: the pixel's center; n*n: n x n strata

    /// How light is found. Empty: the windowed sum times traced visibility, and samples for glossy
    /// lobes alone; else samples with a shadow ray each for everything.
    std::optional<model::Sampler> sampler;
    /// Of a pixel and lamp, >= 2: more, less noise. 0: 64, or as many as error_rel and time_s call
    /// for; with one of those: at most so many.
    int samples = 0;
    int q = 0;  // of the windowed sum: windows of at most so many texels a side; 0: exact
    std::optional<model::Sequence> sequence;  // of samplers; empty: default_sequence
    model::Shift shift = model::Shift::Random;
    std::uint32_t seed = 1;

    /// Passes are added until Noise::error_rel() falls to it; 0: one pass.
    double error_rel = 0;
    /// Passes are added while they fit, counted from the call of render(); 0: no limit. What such a
    /// picture holds depends on the clock.
    double time_s = 0;

    int threads = 0;  // 0: all cores. The picture does not depend on it
    /// Adds the layer sigma_measured where a lamp's file holds sigmas: in double, many times
    /// the time of a light sum.
    bool sigma_measured = false;
};

/// Throws Error naming the option if one is out of range.
void check(const RenderOptions& options);

/// Errors of radiance Y relative to radiance Y, over lit pixels: those brighter than 1e-3 of the
/// brightest.
struct Noise {
    double mean_rel = 0, p95_rel = 0;  // sampling sigma; p95: what 95 % of the pixels do not exceed
    double share_above_10_percent = 0;
    double bias_mean_rel = 0;  // bound of the bias of sums on coarser images

    /// What RenderOptions::error_rel asks for.
    double error_rel() const { return mean_rel + bias_mean_rel; }
};

/// Of a picture's layers: radiance R, G, B, sigma Y and, where not null, bias_bound Y. All 0 where
/// nothing is lit.
Noise summarize_noise(const Layer& radiance, const Layer& sigma, const Layer* bias = nullptr);

/// What a picture cost and how noisy it is. Stages' times are shares of the wall time by time spent
/// in them.
struct RenderReport {
    Quantity quantity = Quantity::Photometric;  // radiance is in cd/m^2 or in W/(m^2 sr)
    double load_s = 0, build_s = 0, plan_s = 0, camera_s = 0, sums_s = 0, visibility_s = 0;
    int threads = 0;  // used
    std::uint64_t camera_rays = 0, shadow_rays = 0;
    double multiply_adds = 0;  // of the windowed sums
    int passes = 0;
    double samples =
        0;      // of a pixel and lamp, all passes; a mean where time cut the last one short
    int q = 0;  // of the windowed sum, as asked for or as time called for
    Noise sampling;
    double time_s = 0;                // of the call
    bool is_error_reached = true;     // false: error_rel was asked for and could not be had
    bool has_sigma_measured = false;  // the layer is there: it was asked for, and a file knows
};

struct Rendered {
    Picture picture;  // layers as listed in docs/scenes.md; provenance is empty
    RenderReport report;
};

/// A report in one line for people.
std::string summary(const RenderReport& report, const RenderOptions& options, glm::ivec2 size_px);
std::string summary(const Noise& noise);

/// What a picture's file says of where it comes from: options, light fields with their hashes,
/// figures. The scene's own file is the caller's to add to the inputs, where there is one.
Provenance describe(const Scene& scene, const RenderOptions& options, const RenderReport& report);

/// How far a picture is.
struct RenderProgress {
    double fraction = 0;   // of the work, as far as is known
    int passes = 0;        // complete
    double error_rel = 0;  // after them; 0 before the first
};

struct RenderHooks {
    std::function<void(const RenderProgress&)> progress;  // from any thread, one at a time
    std::function<double()> clock_s;  // seconds, rising, from any thread; empty: the steady clock
};

/// Renders the light that arrives directly from the scene's luminaires.
///
/// Out     without time_s the same bits for any number of threads. With the windowed sum noise in
///         penumbrae and gloss alone; its sigma is a layer, and with q > 0 the bias' bound too.
/// Throws  Error if a camera or light field is missing or not one, or if the picture is larger than
///         the memory that is left.
/// Cost    a camera sample and lit lamp: one windowed sum (prepared.h) a pass, and a shadow ray a
///         sample.
Rendered render(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks = {});

}  // namespace nearfield::render
