// SPDX-License-Identifier: Apache-2.0
/// What a scene calls for, so that nothing else is computed. Each answer has its reason.
#pragma once

#include "formats/scene/scene.h"
#include "render/lamps.h"
#include "render/options.h"

#include <string>
#include <vector>

namespace nearfield::render {

/// Whether something is called for, and why or why not, in words for people.
struct Need {
    bool is_called_for = false;
    std::string reason;
};

/// Of a lamp that is on.
struct LampNeed {
    std::string name;
    Need light;    // not called for: no instance lies in its beam, and its light is exactly 0
    Need shadows;  // not called for: nothing can stand between it and what it lights
};

/// A lamp that is off, or dimmed to 0: it is not loaded.
struct UnlitLamp {
    std::string name, reason;
};

struct Needs {
    std::vector<UnlitLamp> unlit;
    std::vector<LampNeed> lamps;  // as in Lamps
    Need shadows;                 // of any lamp
    Need color, gloss, tone_mapping;
    Need environment;  // the scene has one that is not dimmed to 0
    Need diffuse;      // a material in use has a diffuse part
    Need sky_shadows;  // something may stand before it: triangles of more than one plane
};

/// What the scene calls for; what options.effects force is the plan's business (plan.h).
///
/// Light    per lamp: a bounding box in its beam, by beam.h.
/// Shadows  per lamp: called for unless each plane of a triangle that could stop its light has the
///          lamp's U rectangles and all geometry in its beam on one side. Exact where it says no;
///          where triangles lie in more than 64 planes it says yes.
/// Color    a lamp of three channels, a material that is not gray, or an environment.
/// Gloss    a material with a lobe.
///
/// Cost     shadows: at most 64 times the vertices a lamp.
Needs needs_of(const Scene& scene, const Lamps& lamps, const RenderOptions& options);

/// The same of gloss alone, which lamps need not be loaded for.
Need gloss_need(const Scene& scene);

}  // namespace nearfield::render
