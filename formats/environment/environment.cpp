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
    LatLong rest;
    if (parts.suns > 0 && (parts.maps || parts.harmonics)) {
        Suns suns = take_suns(environment.picture, parts.suns);
        rest = std::move(suns.rest);
        if (!suns.suns.empty())
            environment.suns = std::move(suns);
    }
    const LatLong& filtered = environment.suns ? rest : environment.picture;
    if (parts.maps)
        environment.maps = make_paraboloid_map(filtered);
    if (parts.maps && environment.suns)
        environment.maps_with_suns = make_paraboloid_map(environment.picture);
    if (parts.table)
        environment.table = make_sky_table(environment.picture);
    if (parts.harmonics)
        environment.harmonics = project(filtered);
    if (parts.directions > 0)
        environment.directions = make_visibility_fit(
            environment.picture,
            environment.table ? *environment.table : make_sky_table(environment.picture),
            parts.directions);
    return environment;
}

double bytes(const Environment& environment) {
    std::size_t count = environment.picture.radiance.size() * sizeof(glm::vec3);
    for (const auto* maps : {&environment.maps, &environment.maps_with_suns})
        if (*maps)
            for (const ParaboloidMap::Level& level : (*maps)->levels)
                count += 2 * level.sides.front().size() * sizeof(glm::vec4);
    if (environment.table)
        count += (environment.table->column_cdf.size() + environment.table->row_cdf.size()) *
                 sizeof(float);
    return static_cast<double>(count);
}

}  // namespace nearfield::environment
