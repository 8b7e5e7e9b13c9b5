// SPDX-License-Identifier: Apache-2.0
/// What a picture is asked for; the same for every device.
#pragma once

#include "formats/model/sampler.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace nearfield::render {

// So many samples a camera sample and lamp keep the ratio estimator's bias small.
constexpr int kFewestSamples = 8;
constexpr int kUsualSamples = 64;
constexpr int kMostSamples = 1 << 20;

enum class Device { Auto, Cpu, Gl };

/// Auto: as the scene calls for it (needs.h).
enum class Switch { Auto, On, Off };

/// What may be left out of a picture without a change where the scene does not call for it.
struct Effects {
    Switch color = Switch::Auto;         // off: gray, of equal luminance
    Switch shadows = Switch::Auto;       // off: light passes through everything
    Switch gloss = Switch::Auto;         // off: the materials' diffuse parts alone
    Switch tone_mapping = Switch::Auto;  // off: no picture for a display
    Switch environment = Switch::Auto;   // off: darkness all around; on changes nothing
};

/// How an environment's light is found.
enum class EnvironmentMethod {
    Filtered,   // diffuse by spherical harmonics, gloss by filtered samples: no noise, a bias
    Lights,     // as far lamps, drawn by luminance, the same for every pixel; a baseline
    Resampled,  // samples with a ray each, chosen among more by all but visibility; a baseline
    Reference,  // samples of sky and BRDF with a ray each: unbiased, noise
};

/// How far filtered samples are blurred (formats/shared/filtered_samples.glsl.h).
enum class FilterLevel { Fis, Gems, None, Mfis };

const char* name_of(EnvironmentMethod method);
const char* name_of(FilterLevel level);

struct EnvironmentOptions {
    EnvironmentMethod method = EnvironmentMethod::Filtered;
    int samples = 40;  // filtered ones of a glossy pixel; Resampled and Reference draw
                       // RenderOptions::samples
    /// Above 0: as many of them as this relative error calls for, pixel by pixel, 8 to `samples`
    /// (formats/shared/sample_count.glsl.h); 0: `samples` everywhere.
    double error_rel = 0.0;
    FilterLevel level = FilterLevel::Fis;
    bool is_anisotropic = false;  // several lookups along what a sample stands for
    bool is_shifted = false;      // a random shift a pixel: noise in place of structured error
    int directions = 16;  // in which filtered light asks for visibility, 0: none; of Lights: lamps
    int suns = 32;        // of Filtered: small bright parts summed apart, at most; 0: none
    int map_px = 512;     // a side of the maps that OpenGL draws of each direction
    int filter_px = 0;    // OpenGL: radius in which neighbors' fits of what is hidden are averaged
};

/// What stands for all points of a cell of a lamp's U plane.
enum class ShadowEye {
    Cell,   // the middle of its light, on U
    Paper,  // the mean over its images of the medians of C_m, on S: what stands between U and S is
            // missed, and shadows are displaced
};

/// Of the OpenGL renderer's shadow maps. Equal options on the same lamp and scene give the same
/// maps.
struct ShadowMapOptions {
    ShadowEye eye = ShadowEye::Cell;
    int maps = 0;      // of a lamp, at most (one a slab with light at least); 0: one a cell
    int map_px = 192;  // a side
    int pcf_taps = 4;  // percentage-closer filtering: 1, 4, 9 or 16

    bool operator==(const ShadowMapOptions&) const = default;
};

/// Throws Error naming the option if one is out of range.
void check(const ShadowMapOptions& options);

/// How the visibility of a lamp's cells, by shadow maps, weighs on its light (OpenGL, sums alone).
enum class ShadowWeights {
    Shares,  // each cell's own light by its own
    Pdis,    // an image's light by the plain mean over the cells of its basis function
};

struct RenderOptions {
    Device device = Device::Cpu;
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
    bool has_bias_bound = true;  // with q: how wrong that is, by sums at 2q (OpenGL: 4 times q's)
    std::optional<model::Sequence> sequence;  // of samplers; empty: default_sequence
    model::Shift shift = model::Shift::Random;
    std::uint32_t seed = 1;

    /// Passes are added until Noise::error_rel() falls to it; 0: one pass.
    double error_rel = 0;
    /// Passes are added while they fit, counted from the call of the renderer; 0: no limit. What
    /// such a picture holds depends on the clock.
    double time_s = 0;

    int threads = 0;  // 0: all cores. The picture does not depend on it
    /// Adds the layer sigma_measured where a lamp's file holds sigmas: in double, many times
    /// the time of a light sum.
    bool sigma_measured = false;

    bool shows_lamps = false;  // themselves, where the camera looks into them (seen_lamps.h)

    Effects effects;
    EnvironmentOptions environment;
    ShadowMapOptions shadow_maps;  // OpenGL alone
    ShadowWeights shadow_weights = ShadowWeights::Shares;
    bool is_displayed = false;  // the caller tone-maps the picture
};

/// Throws Error naming the option if one is out of range.
void check(const RenderOptions& options);

}  // namespace nearfield::render
