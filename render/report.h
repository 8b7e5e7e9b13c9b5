// SPDX-License-Identifier: Apache-2.0
/// What a renderer hands back beside the picture, and what it says while it works.
#pragma once

#include "formats/files/image.h"
#include "formats/files/lightfield.h"
#include "formats/scene/scene.h"
#include "render/options.h"
#include "render/plan.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nearfield::render {

/// Errors of radiance Y relative to radiance Y, over lit pixels: those brighter than 1e-3 of the
/// brightest.
struct Noise {
    double mean_rel = 0, p95_rel = 0;  // sampling sigma; p95: what 95 % of the pixels do not exceed
    double share_above_10_percent = 0;
    double bias_mean_rel = 0;  // bound of the bias of sums on coarser images

    /// What RenderOptions::error_rel asks for.
    double error_rel() const { return mean_rel + bias_mean_rel; }
};

/// Of a picture's layers: radiance R, G, B, sigma Y and, where not null, bias_bound Y and depth Z.
/// Pixels of depth 0 see an environment past everything: they do not count, nor does it count as
/// the brightest. All 0 where nothing is lit.
Noise summarize_noise(const Layer& radiance,
                      const Layer& sigma,
                      const Layer* bias = nullptr,
                      const Layer* depth = nullptr);

/// What a pass took.
struct PassReport {
    PassId id = PassId::CameraRays;
    double time_s = 0;  // a share of the wall time
    double bytes = 0;   // what it alone held
};

/// What a picture cost and how noisy it is. Stages' times are shares of the wall time by time spent
/// in them.
struct RenderReport {
    Quantity quantity = Quantity::Photometric;  // radiance is in cd/m^2 or in W/(m^2 sr)
    double load_s = 0, build_s = 0, plan_s = 0, camera_s = 0, sums_s = 0, visibility_s = 0;
    double lamp_bytes = 0;      // of lamps' textures, on the graphics card
    std::string device;         // its name: "CPU", or what OpenGL calls it
    std::string device_reason;  // why this one, where the choice was left to the renderer
    int threads = 0;            // used
    std::uint64_t camera_rays = 0, shadow_rays = 0;
    std::uint64_t sky_samples = 0;  // filtered ones of the environment; counted by the CPU alone
    double multiply_adds = 0;       // of the windowed sums
    int passes = 0;
    double samples =
        0;      // of a pixel and lamp, all passes; a mean where time cut the last one short
    int q = 0;  // of the windowed sum, as asked for or as time called for
    /// Pixels between the planes of a lamp with shadow maps that some of these do not show: lit
    /// from there, whatever stands between. Lamps and slabs added, one sample a pixel.
    int unmapped_pixels = 0;
    Noise sampling;
    double time_s = 0;                // of the call
    bool is_error_reached = true;     // false: error_rel was asked for and could not be had
    bool has_sigma_measured = false;  // the layer is there: it was asked for, and a file knows
    Plan plan;                        // what was computed, and why
    std::vector<PassReport> costs;    // of the plan's passes that are in
};

struct Rendered {
    Picture picture;  // layers as listed in docs/scenes.md; provenance is empty
    RenderReport report;
};

/// A report in one line for people.
std::string summary(const RenderReport& report, const RenderOptions& options, glm::ivec2 size_px);
std::string summary(const Noise& noise);

/// The device, the plan and what each pass took, as a table for people: passes, color and lamps, in
/// or out, and why.
std::string explain(const RenderReport& report);

/// What a picture's file says of where it comes from: options, light fields with their hashes,
/// figures. The scene's own file is the caller's to add to the inputs, where there is one.
Provenance describe(const Scene& scene, const RenderOptions& options, const RenderReport& report);

/// How far a picture is.
struct RenderProgress {
    double fraction = 0;   // of the work, as far as is known
    int passes = 0;        // complete
    double error_rel = 0;  // after them; 0 before the first
};

/// Thrown by a renderer that RenderHooks::is_stopped told to give its picture up.
struct Stopped {};

struct RenderHooks {
    std::function<void(const RenderProgress&)> progress;  // from any thread, one at a time
    std::function<double()> clock_s;  // seconds, rising, from any thread; empty: the steady clock
    /// Asked now and then by the OpenGL renderer; true ends the call by Stopped. Empty: never.
    std::function<bool()> is_stopped;
};

}  // namespace nearfield::render
