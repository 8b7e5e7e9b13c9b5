// SPDX-License-Identifier: Apache-2.0
// Hard cases of what comes in: values that are no light, and lamps that are off.
#include "formats/files/error.h"
#include "formats/files/repair.h"
#include "formats/model/profile.h"
#include "formats/model/tables.h"
#include "render/cpu/render.h"
#include "tests/model/hard_cases.h"
#include "tests/render/scenes.h"
#include "tests/support/lamps.h"

#include <cmath>
#include <limits>

namespace nearfield::test {
namespace {

LightField small_lightfield() {
    LightField lightfield;
    lightfield.slabs = {
        support::random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 3)};
    return lightfield;
}

// Whether packing refuses the light field and says which texel is to blame.
bool is_refused(const LightField& lightfield, const std::string& place) {
    try {
        model::pack(lightfield, true);
    } catch (const Error& error) {
        return std::string(error.what()).find(place) != std::string::npos;
    }
    return false;
}

std::vector<HardRow> bad_values() {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const LightField valid = small_lightfield();
    const Slab& slab = valid.slabs[0];
    double accepted = 0.0, left = 0.0, uncounted = 0.0;
    for (const float bad : {kNan, -kNan, kInfinity, -kInfinity, -1.0F, -1e-40F})
        for (const int m : {0, 7, slab.image_count() - 1})
            for (const glm::ivec2 texel : {glm::ivec2(0, 0), glm::ivec2(5, 3), slab.texels - 1}) {
                LightField broken = valid;
                broken.slabs[0]
                    .coeffs[slab.image_offset(0, m) +
                            static_cast<std::size_t>(texel.y * slab.texels.x + texel.x)] = bad;
                const std::string place = "image " + std::to_string(m) + ", texel (" +
                                          std::to_string(texel.x) + ", " + std::to_string(texel.y) +
                                          ")";
                accepted += is_refused(broken, place) ? 0.0 : 1.0;
                uncounted += repair(broken).count() == 1 ? 0.0 : 1.0;
                left += is_refused(broken, "") ? 1.0 : 0.0;
            }
    return {
        {"bad values (of 54) packed, or refused without their place", 0.0, accepted, std::nullopt},
        {"bad values (of 54) that --repair leaves or does not count", 0.0, left + uncounted,
         std::nullopt}};
}

// What a scene's picture costs: multiply-adds and rays.
double cost_of(const Scene& scene) {
    render::RenderOptions options;
    options.size_px = {24, 18};
    options.samples = 8;
    const render::RenderReport report = render::render_cpu(scene, options).report;
    return report.multiply_adds + static_cast<double>(report.shadow_rays + report.camera_rays);
}

std::vector<HardRow> lamp_off() {
    const glm::dmat4 above = pose({0.2, 0.1, 1.0}, {0, 0, -1});
    Scene one = floor_scene();
    one.luminaires.push_back(write_lamp(one_window_lamp(0.05, 100.0F), "hard_case_on", above));
    Scene two = one;
    two.luminaires.push_back(write_lamp(one_window_lamp(0.05, 100.0F), "hard_case_off", above));
    const double alone = cost_of(one), both = cost_of(two);
    two.luminaires[1].on = false;
    const double off = cost_of(two) - alone;
    two.luminaires[1].on = true;
    two.luminaires[1].dim = 0.0;
    return {{"multiply-adds and rays of a lamp that is off, of one that is on", 0.0,
             off / (both - alone), std::nullopt},
            {"the same of a lamp with dim 0", 0.0, (cost_of(two) - alone) / (both - alone),
             std::nullopt}};
}

}  // namespace

std::vector<HardCase> file_cases() {
    return {
        {"BadValues", "NaN, Inf, negative texels in input",
         "one of them poisons every sum over its image", bad_values},
        {"LampOff", "two luminaires, one off", "work still done", lamp_off},
    };
}

}  // namespace nearfield::test
