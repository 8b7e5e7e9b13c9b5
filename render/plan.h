// SPDX-License-Identifier: Apache-2.0
/// A picture's passes: one table for all devices, of which a plan takes what the scene calls for.
///
/// A new effect is a Need (needs.h), a row in the table (plan.cpp), and on each device the code
/// that looks at the plan.
#pragma once

#include "render/needs.h"

#include <glm/glm.hpp>

#include <string>
#include <vector>

namespace nearfield::render {

enum class PassId {
    CameraRays,   // CPU
    GBuffer,      // GPU: what the camera sees, rasterized
    ShadowMaps,   // GPU
    BoxEnergies,  // GPU: A_m of every receiver, from which samples are drawn
    LightSums,
    Samples,
    ShadowRays,  // CPU
    Gloss,
    Environment,            // what is seen past everything
    EnvironmentIrradiance,  // diffuse surfaces
    EnvironmentSamples,     // gloss; all surfaces where far lamps or a reference are asked for
    EnvironmentRays,        // CPU: whether the sky is visible
    EnvironmentMaps,        // GPU: the same by maps, and its fit
    Accumulate,             // GPU: passes added up
    ToneMapping,
};

struct PlannedPass {
    PassId id = PassId::CameraRays;
    const char* name = "";
    const char* does = "";  // in one sentence
    bool is_in = false;
    std::string reason;  // why it is in or out
    double bytes = 0;    // what it alone holds, about; 0 where it is out
};

/// A lamp's share of the plan.
struct LampPlan {
    std::string name;
    bool is_lit = true;  // false: its light is exactly 0 everywhere, and nothing is computed
    bool has_shadows = true;
    std::string light_reason, shadows_reason;
};

/// Color is no pass but the number of channels of all of them.
struct ColorPlan {
    bool is_in = true;
    bool is_removed = false;  // it is there, and was switched off
    std::string reason;
};

struct Plan {
    Device device = Device::Cpu;  // never Auto
    ColorPlan color;
    bool has_shadows = true;  // of any lamp
    bool has_gloss = true;
    bool has_tone_mapping = false;
    bool has_environment = false;
    bool draws_sky = false;       // its light by random samples, so that there is noise
    bool draws_samples = true;    // so that there may be noise
    std::vector<LampPlan> lamps;  // as in Lamps
    std::vector<UnlitLamp> unlit;
    std::vector<PlannedPass> passes;  // of the device, in their order, those that are out too
};

/// What the scene calls for, with what options.effects force.
Plan plan_of(const Scene& scene,
             const Lamps& lamps,
             const RenderOptions& options,
             glm::ivec2 size_px,
             Device device);

/// Whether a plan made with these options has gloss, before lamps are loaded.
bool plans_gloss(const Scene& scene, const RenderOptions& options);

/// The channels that lamps are loaded with: LampParts::channels.
int channels_to_load(const RenderOptions& options);

bool has_pass(const Plan& plan, PassId id);

/// Whether visibility of the environment is asked for.
bool hides_sky(const Plan& plan);

}  // namespace nearfield::render
