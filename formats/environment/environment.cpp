// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/environment.h"

#include "formats/shared/tonemap.glsl.h"

#include <utility>

namespace nearfield::environment {

Environment prepare(LatLong picture, const Parts& parts) {
    if (parts.is_gray)
        for (glm::vec3& rgb : picture.radiance)
            rgb = glm::vec3(shared::luminance709(rgb));
    Environment environment;
    environment.picture = std::move(picture);
    if (parts.maps)
        environment.maps = make_paraboloid_map(environment.picture);
    if (parts.table)
        environment.table = make_sky_table(environment.picture);
    if (parts.harmonics)
        environment.harmonics = project(environment.picture);
    if (parts.directions > 0)
        environment.directions = make_visibility_fit(
            environment.picture,
            environment.table ? *environment.table : make_sky_table(environment.picture),
            parts.directions);
    return environment;
}

double bytes(const Environment& environment) {
    std::size_t count = environment.picture.radiance.size() * sizeof(glm::vec3);
    if (environment.maps)
        for (const ParaboloidMap::Level& level : environment.maps->levels)
            count += 2 * level.sides.front().size() * sizeof(glm::vec3);
    if (environment.table)
        count += (environment.table->column_cdf.size() + environment.table->row_cdf.size()) *
                 sizeof(float);
    return static_cast<double>(count);
}

}  // namespace nearfield::environment
