// SPDX-License-Identifier: Apache-2.0
/// Light that arrives from far away in all directions: latitude-longitude pictures of it, and what
/// renderers read of them. Rotation and intensity are the scene's, and change nothing here.
///
/// Directions are of the picture's own frame, of unit length. Values are the file's; what unit they
/// have the scene says.
#pragma once

#include "formats/environment/harmonics.h"
#include "formats/environment/latlong.h"
#include "formats/environment/paraboloid_map.h"
#include "formats/environment/sky_table.h"
#include "formats/environment/suns.h"
#include "formats/environment/visibility_fit.h"

#include <optional>
#include <string>

namespace nearfield::environment {

/// Which parts are made.
struct Parts {
    bool maps = false;       // for filtered samples
    bool table = false;      // for samples by luminance
    bool harmonics = false;  // for diffuse surfaces
    int suns = 0;            // taken out of maps and harmonics, at most
    int directions = 0;      // for shadows of filtered light, or as so many far lamps
    bool is_gray = false;    // luminance in place of colors

    bool operator==(const Parts&) const = default;
};

struct Environment {
    LatLong picture;
    std::optional<Suns> suns;           // only if there are any; without the rest, which is in maps
    std::optional<ParaboloidMap> maps;  // without suns
    std::optional<ParaboloidMap>
        maps_with_suns;  // only beside suns: for lobes that show their shape
    std::optional<SkyTable> table;
    std::optional<Harmonics> harmonics;  // without suns
    std::optional<VisibilityFit> directions;
};

Environment prepare(LatLong picture, const Parts& parts);

/// Memory of the parts, the picture included.
double bytes(const Environment& environment);

}  // namespace nearfield::environment
