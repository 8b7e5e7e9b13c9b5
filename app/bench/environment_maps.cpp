// SPDX-License-Identifier: Apache-2.0
// Paraboloid maps beside a cube map of as many texels, nearly: how far their filtered lookups are
// from means over caps, and how far they jump where maps or faces meet.
#include "app/bench/environment_sweep.h"
#include "formats/environment/cube_map.h"
#include "formats/environment/paraboloid_map.h"
#include "formats/environment/suns.h"
#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/filtered_samples.glsl.h"
#include "formats/shared/frame.glsl.h"
#include "formats/shared/tonemap.glsl.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace nearfield::bench {
namespace {

const double kPi = std::acos(-1.0);

/// Luminance that a map shows in a direction as the mean over a solid angle.
using Lookup = std::function<double(glm::vec3 direction, double solid_angle_sr)>;

/// As filtered samples choose it, without overlap.
float level_of(double texels, double solid_angle_sr, double sr_per_area) {
    return shared::filter_level(shared::kLevelMfis,
                                shared::texels_per_sample(static_cast<float>(texels), 1.0F,
                                                          static_cast<float>(1.0 / solid_angle_sr),
                                                          static_cast<float>(sr_per_area)));
}

/// Point k of n, evenly over the sphere (Fibonacci's lattice).
glm::vec3 sphere_point(int k, int n) {
    const double z = 1.0 - (2.0 * k + 1.0) / n, azimuth = kPi * (3.0 - std::sqrt(5.0)) * k;
    const double across = std::sqrt(1.0 - z * z);
    return {across * std::cos(azimuth), across * std::sin(azimuth), z};
}

double cap_mean(const environment::LatLong& picture, glm::vec3 middle, double solid_angle_sr) {
    constexpr int kPoints = 2000;
    const shared::SurfaceFrame frame = shared::frame_from_normal(middle);
    double sum = 0.0;
    for (int k = 0; k < kPoints; ++k) {
        const double height = solid_angle_sr / (2.0 * kPi) * (k + 0.5) / kPoints;
        const double azimuth = kPi * (3.0 - std::sqrt(5.0)) * k;
        const double across = std::sqrt(std::max(height * (2.0 - height), 0.0));
        sum += static_cast<double>(shared::luminance709(environment::radiance(
            picture,
            shared::world_from_local(frame, glm::vec3(across * std::cos(azimuth),
                                                      across * std::sin(azimuth), 1.0 - height)))));
    }
    return sum / kPoints;
}

/// Pairs of directions on the two sides of where maps or faces meet.
using Seam = std::function<glm::vec3(int k, int n, double side)>;

glm::vec3 across_equator(int k, int n, double side) {
    const double azimuth = 2.0 * kPi * (k + 0.5) / n;
    return glm::normalize(glm::vec3(std::cos(azimuth), std::sin(azimuth), side));
}

/// Along all twelve edges of a cube.
glm::vec3 across_edges(int k, int n, double side) {
    const int edge = k % 12, axis = edge % 3;
    glm::vec3 direction(0.0F);
    direction[axis] = static_cast<float>(2.0 * (k / 12 + 0.5) / (n / 12.0) - 1.0);
    direction[(axis + 1) % 3] = edge / 3 % 2 == 0 ? 1.0F : -1.0F;
    direction[(axis + 2) % 3] = (edge / 6 % 2 == 0 ? 1.0F : -1.0F) * static_cast<float>(1.0 + side);
    return glm::normalize(direction);
}

MapRow map_row(const char* name,
               const environment::LatLong& picture,
               double solid_angle_sr,
               const Lookup& lookup,
               const Seam& seam) {
    constexpr int kDirections = 1200;
    constexpr double kBeside = 1e-5;
    MapRow row;
    row.map = name;
    row.solid_angle_sr = solid_angle_sr;
    const auto mean = static_cast<double>(environment::mean_luminance(picture));
    double errors = 0.0, jumps = 0.0;
    for (int k = 0; k < kDirections; ++k) {
        const glm::vec3 direction = sphere_point(k, kDirections);
        errors += std::pow(
            lookup(direction, solid_angle_sr) - cap_mean(picture, direction, solid_angle_sr), 2);
        const double jump = lookup(seam(k, kDirections, kBeside), solid_angle_sr) -
                            lookup(seam(k, kDirections, -kBeside), solid_angle_sr);
        jumps += jump * jump;
        row.jump_most = std::max(row.jump_most, std::abs(jump) / mean);
    }
    row.error_rms = std::sqrt(errors / kDirections) / mean;
    row.jump_rms = std::sqrt(jumps / kDirections) / mean;
    return row;
}

/// What a mirror shows of a map about a cube's corner, which the paraboloids' seam passes too.
SeamPicture seam_picture(const char* name, double solid_angle_sr, const Lookup& lookup) {
    constexpr int kSide = 160;
    SeamPicture picture;
    picture.map = name;
    picture.solid_angle_sr = solid_angle_sr;
    picture.side_px = kSide;
    const shared::SurfaceFrame frame =
        shared::frame_from_normal(glm::normalize(glm::vec3(1.0F, 1.0F, 0.6F)));
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const glm::vec2 at = (glm::vec2(x, y) + 0.5F) / float{kSide} * 2.0F - 1.0F;
            picture.luminance.push_back(
                lookup(glm::normalize(shared::world_from_local(frame, glm::vec3(at, 1.0F))),
                       solid_angle_sr));
        }
    return picture;
}

}  // namespace

void compare_maps(Sweep& sweep) {
    // Without suns, which none of them holds.
    const environment::LatLong picture =
        environment::take_suns(environment::read_latlong(sweep.picture), 4096).rest;
    const environment::ParaboloidMap paraboloids = environment::make_paraboloid_map(picture);
    const environment::CubeMap cube =
        environment::make_cube_map(picture, std::max(paraboloids.side_px() / 2, 1));
    const Lookup in_paraboloids = [&](glm::vec3 direction, double solid_angle_sr) {
        return static_cast<double>(shared::luminance709(environment::filtered(
            paraboloids, direction,
            level_of(paraboloids.texels(), solid_angle_sr,
                     static_cast<double>(shared::paraboloid_sr_per_area(direction))))));
    };
    const Lookup in_cube = [&](glm::vec3 direction, double solid_angle_sr) {
        return static_cast<double>(shared::luminance709(environment::filtered(
            cube, direction,
            level_of(cube.texels(), solid_angle_sr, environment::cube_sr_per_area(direction)))));
    };
    for (const double solid_angle_sr : {0.003, 0.03, 0.3}) {
        sweep.findings.maps.push_back(
            map_row("paraboloids", picture, solid_angle_sr, in_paraboloids, across_equator));
        sweep.findings.maps.push_back(
            map_row("cube", picture, solid_angle_sr, in_cube, across_edges));
        sweep.step();
    }
    constexpr double kShown_sr = 0.1;
    sweep.findings.seams = {seam_picture("paraboloids", kShown_sr, in_paraboloids),
                            seam_picture("cube", kShown_sr, in_cube)};
}

}  // namespace nearfield::bench
