// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/sky_table.h"

#include "formats/files/luminaire.h"
#include "formats/model/axis_window.h"
#include "formats/model/profile.h"
#include "formats/model/tables.h"
#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/stored_cdf.glsl.h"
#include "formats/shared/tonemap.glsl.h"

#include <algorithm>
#include <cmath>

namespace nearfield::environment {
namespace {

/// The picture as the only image of a luminaire: what is drawn by is luminance times solid angle.
Slab as_slab(const LatLong& picture) {
    Slab slab;
    slab.delta_m = 1.0;
    slab.grid = {1, 1};
    slab.pitch_m = {1.0, 1.0};
    slab.texels = picture.size_px;
    slab.s_max_m = {1.0, 1.0};
    slab.profile = model::make_profile("box");
    slab.coeffs.reserve(picture.radiance.size());
    for (int y = 0; y < picture.size_px.y; ++y) {
        const auto sr = static_cast<float>(pixel_sr(picture, y));
        for (int x = 0; x < picture.size_px.x; ++x)
            slab.coeffs.push_back(sr *
                                  shared::luminance709(picture.radiance[picture.index({x, y})]));
    }
    return slab;
}

shared::StoredCdf columns(const SkyTable& table) {
    return {table.column_cdf.data()};
}

shared::StoredCdf rows(const SkyTable& table, int column) {
    return {table.row_cdf.data() +
            static_cast<std::size_t>(column) * static_cast<std::size_t>(table.size_px.y + 1)};
}

float pixel_density(const SkyTable& table, glm::ivec2 pixel) {
    const float chance =
        shared::cdf_step(columns(table), pixel.x) * shared::cdf_step(rows(table, pixel.x), pixel.y);
    const LatLong shape{table.size_px, {}};
    return static_cast<float>(static_cast<double>(chance) / pixel_sr(shape, pixel.y));
}

/// A place in a row's zone: evenly by solid angle, that is by the cosine of the polar angle.
float polar_part(int row, int rows_in_all, float part) {
    const double pi = std::acos(-1.0);
    const double above = std::cos(pi * row / rows_in_all);
    const double below = std::cos(pi * (row + 1) / rows_in_all);
    const double polar = std::acos(glm::mix(above, below, static_cast<double>(part)));
    return static_cast<float>(polar / pi);
}

}  // namespace

SkyTable make_sky_table(const LatLong& picture) {
    SlabTables tables = model::build_tables(as_slab(picture));
    return {picture.size_px, std::move(tables.marginal_cdf), std::move(tables.conditional_cdf)};
}

SkySample draw(const SkyTable& table, glm::vec2 xi) {
    SkySample sample;
    if (table.is_dark())
        return sample;
    const auto pick = [](shared::StoredCdf cdf, int texels, float at) {
        return shared::invert_cdf(cdf, shared::restrict_cdf(cdf, shared::whole_axis(texels)), at,
                                  false, 0);
    };
    const shared::TexelPick column = pick(columns(table), table.size_px.x, xi.x);
    const shared::TexelPick row = pick(rows(table, column.texel), table.size_px.y, xi.y);
    if (row.texel < 0)
        return sample;
    sample.pixel = {column.texel, row.texel};
    sample.direction = shared::direction_from_latlong(
        {(static_cast<float>(column.texel) + column.fraction) / static_cast<float>(table.size_px.x),
         polar_part(row.texel, table.size_px.y, row.fraction)});
    sample.density = pixel_density(table, sample.pixel);
    return sample;
}

float density(const SkyTable& table, glm::vec3 direction) {
    if (table.is_dark())
        return 0.0F;
    const glm::vec2 at = shared::latlong_from_direction(direction) * glm::vec2(table.size_px);
    return pixel_density(table, glm::clamp(glm::ivec2(at), glm::ivec2(0), table.size_px - 1));
}

}  // namespace nearfield::environment
