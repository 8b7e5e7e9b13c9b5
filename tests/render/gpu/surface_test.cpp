// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/tracer.h"
#include "render/film.h"
#include "render/gpu/storage.h"
#include "render/gpu/surfaces.h"
#include "sample_data/demo_scene.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/scenes.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render::gpu {
namespace {

class SurfaceTest : public GlTest {};

struct Seen {
    glm::ivec2 size_px{0};
    std::vector<float> position, normal, tangent;

    glm::dvec3 vector(const std::vector<float>& values, std::size_t pixel) const {
        return {values[4 * pixel], values[4 * pixel + 1], values[4 * pixel + 2]};
    }
    int material(std::size_t pixel) const { return static_cast<int>(position[4 * pixel + 3]) - 1; }
};

Seen draw(Device& device, const Scene& scene, glm::ivec2 size_px, glm::dvec2 at_px = {0.5, 0.5}) {
    const SceneBuffers buffers = upload_scene(device, scene);
    const SurfacePass pass = make_surface_pass(device, buffers, size_px);
    device.run_pass("surfaces", [&] { draw_surfaces(buffers, scene.cameras[0], at_px, pass); });
    const Surfaces& surfaces = pass.surfaces;
    return {size_px, read_back(surfaces.position, size_px, 4),
            read_back(surfaces.normal, size_px, 4),
            surfaces.has_tangents ? read_back(surfaces.tangent, size_px, 4) : std::vector<float>()};
}

/// How a G-buffer differs from the hits of a ray a pixel.
struct Differences {
    std::size_t pixels = 0, other_material = 0;
    std::vector<double> position_rel;  // of the distance from the eye, ascending
    std::vector<double> normal, tangent;
    double depth_rel = 0;

    double share_above(const std::vector<double>& values, double limit) const {
        const auto above = values.end() - std::upper_bound(values.begin(), values.end(), limit);
        return static_cast<double>(above) / static_cast<double>(values.size());
    }
};

Differences compare(const Scene& scene, const Seen& seen, glm::dvec2 at_px = {0.5, 0.5}) {
    const Tracer tracer(scene, std::vector<std::uint32_t>(scene.instances.size(), ~0U), 1);
    const Camera& camera = scene.cameras[0];
    const glm::dvec3 eye(camera.world_from_camera[3]);
    const glm::dvec3 forward = -glm::normalize(glm::dvec3(camera.world_from_camera[2]));
    Differences found;
    for (int y = 0; y < seen.size_px.y; ++y)
        for (int x = 0; x < seen.size_px.x; ++x) {
            const auto pixel = static_cast<std::size_t>(y * seen.size_px.x + x);
            const auto hit =
                tracer.trace(eye, camera_ray(camera, seen.size_px, glm::dvec2(x, y) + at_px));
            ++found.pixels;
            if (seen.material(pixel) != (hit ? hit->material : -1)) {
                ++found.other_material;
                continue;
            }
            if (!hit)
                continue;
            const double distance_m = glm::length(hit->position_world_m - eye);
            const glm::dvec3 position_m = seen.vector(seen.position, pixel);
            found.position_rel.push_back(glm::length(position_m - hit->position_world_m) /
                                         distance_m);
            found.normal.push_back(
                glm::length(seen.vector(seen.normal, pixel) - hit->shading_normal));
            if (!seen.tangent.empty())
                found.tangent.push_back(
                    glm::length(seen.vector(seen.tangent, pixel) - hit->tangent));
            const double depth_m = glm::dot(position_m - eye, forward);
            found.depth_rel =
                std::max(found.depth_rel,
                         std::abs(static_cast<double>(seen.normal[4 * pixel + 3]) / depth_m - 1.0));
        }
    for (std::vector<double>* values : {&found.position_rel, &found.normal, &found.tangent})
        std::sort(values->begin(), values->end());
    return found;
}

/// A ball of quads with the sphere's normals, and tangents along its circles of latitude.
Mesh ball(int rings) {
    Mesh mesh;
    mesh.name = "ball";
    const int columns = 2 * rings;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i <= columns; ++i) {
            const float theta =
                glm::pi<float>() * static_cast<float>(j) / static_cast<float>(rings);
            const float phi =
                glm::two_pi<float>() * static_cast<float>(i) / static_cast<float>(columns);
            const glm::vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                              std::cos(theta));
            mesh.positions_m.push_back(0.5F * n);
            mesh.normals.push_back(n);
            mesh.tangents.emplace_back(-std::sin(phi), std::cos(phi), 0.0F);
        }
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<unsigned>(j * (columns + 1) + i);
            const unsigned c = a + static_cast<unsigned>(columns) + 1;
            if (j > 0)
                mesh.triangles.emplace_back(a, c, a + 1);
            if (j + 1 < rings)
                mesh.triangles.emplace_back(a + 1, c, c + 1);
        }
    return mesh;
}

/// A floor, and a ball that is stretched, mirrored and turned.
Scene ball_scene() {
    Scene scene = test::floor_scene();
    Material brushed{"brushed", glm::vec3(0.5F), 1.0F, 0.3F};
    scene.materials.push_back(brushed);
    scene.meshes.push_back(ball(24));
    scene.meshes.back().material = 1;
    glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), {0.3, -0.2, 0.6});
    matrix = glm::rotate(matrix, 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
    scene.instances.push_back({"ball", 1, glm::scale(matrix, {1.5, -0.7, 1.0})});
    scene.cameras = {test::camera_at({3.1, -4.2, 2.3}, {-3, 4, -2}, {0, 0, 1}, 0.6)};
    return scene;
}

// Where both see the same triangle: positions are vertices and results rounded to float, a few
// units of 6e-8 of the coordinates, and grow with obliquity.
constexpr double kPosition = 2e-6;
// Normals are interpolated by weights in float on one side and by Embree's on the other.
constexpr double kNormal = 2e-5;
// Of pixels on triangles' borders, where the rasterizer's 1/256 of a pixel decides.
constexpr double kBorderShare = 0.002;

void expect_equal(const Differences& found) {
    EXPECT_GT(found.position_rel.size(), found.pixels / 4);
    EXPECT_LE(static_cast<double>(found.other_material),
              kBorderShare * static_cast<double>(found.pixels));
    EXPECT_LE(found.share_above(found.position_rel, kPosition), kBorderShare);
    EXPECT_LE(found.share_above(found.normal, kNormal), kBorderShare);
    EXPECT_LT(found.depth_rel, 1e-6);  // of float, of depth and of the position it is checked by
    for (const auto& [name, share] : {std::pair{"p50", 0.5}, std::pair{"p99", 0.99}}) {
        const auto at = [share = share](const std::vector<double>& values) {
            return fmt::format(
                "{:.1e}",
                values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]);
        };
        testing::Test::RecordProperty(fmt::format("position_rel_{}", name), at(found.position_rel));
        testing::Test::RecordProperty(fmt::format("normal_{}", name), at(found.normal));
    }
}

TEST_F(SurfaceTest, AgreesWithRaysInTheDemoScene) {
    const Scene scene = sample_data::make_demo_scene("lamp", "lamp", 0.1);
    for (const Camera& camera : scene.cameras) {
        SCOPED_TRACE(camera.name);
        Scene one = scene;
        one.cameras = {camera};
        expect_equal(compare(one, draw(device(), one, {160, 90})));
    }
}

TEST_F(SurfaceTest, AgreesOnStretchedAndMirroredInstancesWithTangents) {
    const Scene scene = ball_scene();
    const Differences found = compare(scene, draw(device(), scene, {96, 80}));
    expect_equal(found);
    ASSERT_FALSE(found.tangent.empty());
    EXPECT_LE(found.share_above(found.tangent, kNormal), kBorderShare);
}

// Surfaces are seen from both sides, their shading normals on the viewer's.
TEST_F(SurfaceTest, AgreesInsideABall) {
    Scene scene = ball_scene();
    scene.cameras = {test::camera_at({0.35, -0.1, 0.7}, {1, 1, 0.3}, {0, 0, 1}, 1.2)};
    expect_equal(compare(scene, draw(device(), scene, {64, 48})));
}

TEST_F(SurfaceTest, AgreesForAnyPlaceInThePixel) {
    const Scene scene = ball_scene();
    for (const glm::dvec2 at_px : {glm::dvec2(0.125, 0.875), glm::dvec2(0.9, 0.3)}) {
        const Seen seen = draw(device(), scene, {64, 48}, at_px);
        expect_equal(compare(scene, seen, at_px));
    }
}

// Proves that the rasterizer's depths tell surfaces apart that are 1e-4 of their distance apart,
// near and far, also where a triangle reaches from the eye to the far end.
TEST_F(SurfaceTest, TellsCloseSurfacesApartFarAway) {
    Scene scene = test::floor_scene();
    scene.materials.push_back({"upper", glm::vec3(0.25F), 0.0F, 1.0F});
    scene.meshes = {test::rectangle("floor", {400, 400}), test::rectangle("sheet", {1, 350})};
    scene.meshes[1].material = 1;
    scene.instances = {{"floor", 0, glm::dmat4(1.0)},
                       {"sheet", 1, glm::translate(glm::dmat4(1.0), {0, 0, 0.02})}};
    scene.cameras = {test::camera_at({0, -190, 1.5}, {0, 1, -0.02}, {0, 0, 1}, 0.3)};
    expect_equal(compare(scene, draw(device(), scene, {96, 96})));
}

TEST_F(SurfaceTest, NothingIsSeenWhereNothingIs) {
    Scene scene = test::floor_scene();
    scene.cameras = {test::camera_at({0, 0, 4}, {0, 0, 1}, {0, 1, 0}, 0.6)};
    const Seen away = draw(device(), scene, {16, 8});
    scene.instances.clear();
    const Seen empty = draw(device(), scene, {16, 8});
    for (const Seen* seen : {&away, &empty})
        for (const float value : seen->position)
            EXPECT_EQ(value, 0.0F);
}

TEST_F(SurfaceTest, UploadedPointsAreReadBackAsTheyAre) {
    const std::vector<SurfacePoint> points = {
        {{1.0F, 2.0F, 3.0F}, {0.0F, 1.0F, 0.0F}, {1.0F, 0.0F, 0.0F}, 2, 7.0F}, {}};
    const Surfaces surfaces = upload_surfaces(device(), {2, 1}, points, {0, 0, 9}, true);
    EXPECT_EQ(read_back(surfaces.position, {2, 1}, 4),
              (std::vector<float>{1, 2, 3, 3, 0, 0, 0, 0}));
    EXPECT_EQ(read_back(surfaces.normal, {2, 1}, 4), (std::vector<float>{0, 1, 0, 7, 0, 0, 1, 0}));
    EXPECT_EQ(read_back(surfaces.tangent, {2, 1}, 4), (std::vector<float>{1, 0, 0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace nearfield::render::gpu
