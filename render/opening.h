// SPDX-License-Identifier: Apache-2.0
/// How every renderer begins and ends.
#pragma once

#include "formats/scene/scene.h"
#include "render/lamps.h"
#include "render/report.h"
#include "render/sky.h"

#include <glm/glm.hpp>

#include <optional>

namespace nearfield::render {

/// A renderer's call: hooks that have a clock, and when it began by that.
struct Call {
    RenderHooks hooks;
    double start_s = 0;

    double elapsed_s() const { return hooks.clock_s() - start_s; }
};

/// Throws Error where options are out of range.
Call begin_call(const RenderOptions& options, const RenderHooks& hooks);

/// What is rendered, ready.
struct Opening {
    const Camera& camera;  // of the scene
    Lamps lamps;
    glm::ivec2 size_px{0};
    std::optional<Sky> sky;  // where the plan has an environment
};

/// What stays loaded from one picture to the next.
struct KeptFiles {
    LampFiles lamps;
    SkyFile sky;
};

/// Loads lamps and environment with the parts that the device's passes read, and plans; fills the
/// report's quantity, load_s, has_sigma_measured and plan. Throws Error where the camera or a light
/// field is missing or not one.
Opening open_scene(const Scene& scene,
                   const RenderOptions& options,
                   Device device,
                   RenderReport& report);
/// The same with files that stay loaded.
Opening open_scene(const Scene& scene,
                   const RenderOptions& options,
                   Device device,
                   KeptFiles& kept,
                   RenderReport& report);

/// Fills what is known at the end: is_error_reached, time_s.
void end_call(const Call& call, const RenderOptions& options, RenderReport& report);

}  // namespace nearfield::render
