// SPDX-License-Identifier: Apache-2.0
#include "render/options.h"

#include "formats/files/error.h"
#include "render/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace nearfield::render {
namespace {

[[noreturn]] void refuse(const char* option, const std::string& expected, const std::string& got) {
    throw Error{"cannot render", option, expected, got};
}

void check_range(const char* option, int value, int least, int most, const char* meaning = "") {
    if (value < least || value > most)
        refuse(option, fmt::format("{}{} ... {}", least, meaning, most), fmt::format("{}", value));
}

}  // namespace

const char* name_of(EnvironmentMethod method) {
    switch (method) {
        case EnvironmentMethod::Lights:
            return "lights";
        case EnvironmentMethod::Resampled:
            return "resampled";
        case EnvironmentMethod::Reference:
            return "reference";
        default:
            return "filtered";
    }
}

const char* name_of(FilterLevel level) {
    switch (level) {
        case FilterLevel::Gems:
            return "gems";
        case FilterLevel::None:
            return "none";
        case FilterLevel::Mfis:
            return "mfis";
        default:
            return "fis";
    }
}

void check(const ShadowMapOptions& options) {
    check_range("shadow maps", options.maps, 0, 1 << 16, " (one a cell)");
    check_range("shadow map's side", options.map_px, 1, kMaxExtentPx);
    const int taps = options.pcf_taps;
    if (taps != 1 && taps != 4 && taps != 9 && taps != 16)
        refuse("shadow taps", "1, 4, 9 or 16", fmt::format("{}", taps));
}

void check(const RenderOptions& options) {
    check(options.shadow_maps);
    check_range("width", options.size_px.x, 1, kMaxExtentPx);
    check_range("height", options.size_px.y, 0, kMaxExtentPx, " (automatic)");
    const int side =
        static_cast<int>(std::lround(std::sqrt(std::max(options.samples_per_pixel, 0))));
    if (options.samples_per_pixel < 1 || options.samples_per_pixel > 1024 ||
        side * side != options.samples_per_pixel)
        refuse("samples per pixel", "a square number, 1, 4, 9 ... 1024",
               fmt::format("{}", options.samples_per_pixel));
    if (options.samples == 1)
        refuse("samples", "2 or more, whose spread tells the error", "1");
    check_range("samples", options.samples, 0, kMostSamples, " (automatic)");
    check_range("q", options.q, 0, 1 << 16, " (exact)");
    if (options.q > 0 && options.sampler)
        refuse("q", "0 with any sampler but sum", fmt::format("{}", options.q));
    if (options.shadow_weights == ShadowWeights::Pdis && options.sampler)
        refuse("shadow weights", "shares with any sampler but sum", "pdis");
    if (!(options.error_rel >= 0.0 && options.error_rel < 1.0))
        refuse("error", "above 0 and below 1", fmt::format("{}", options.error_rel));
    if (!(options.time_s >= 0.0))
        refuse("time", "0 (no limit) or more", fmt::format("{} s", options.time_s));
    if (options.sigma_measured && options.device == Device::Gl)
        refuse("sigma measured", "device cpu", "gl");
    check_range("environment samples", options.environment.samples, 1, kMostSamples);
    if (!(options.environment.error_rel >= 0.0 && options.environment.error_rel < 1.0))
        refuse("environment error", "0 (none) or more, and below 1",
               fmt::format("{}", options.environment.error_rel));
    check_range("environment directions", options.environment.directions, 0, 1 << 14);
    check_range("environment suns", options.environment.suns, 0, 4096);
    check_range("environment map's side", options.environment.map_px, 1, kMaxExtentPx);
    check_range("environment filter", options.environment.filter_px, 0, 16);
    check_range("threads", options.threads, 0, 4096, " (all)");
}

}  // namespace nearfield::render
