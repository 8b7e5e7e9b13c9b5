// SPDX-License-Identifier: Apache-2.0
#include "tests/render/scenes.h"

#include "formats/model/profile.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <stdexcept>

namespace nearfield::test {
namespace {

constexpr double kCameraHeightM = 4.0, kFloorM = 4.0;

}  // namespace

LightField one_window_lamp(double aperture_m, float coefficient, Weighting weighting) {
    Slab slab;
    slab.delta_m = 0.1;
    slab.grid = {1, 1};
    slab.pitch_m = glm::dvec2(aperture_m);
    slab.texels = {1, 1};
    slab.s_min_m = glm::dvec2(-0.3);
    slab.s_max_m = glm::dvec2(0.3);
    slab.profile = model::make_profile("box");
    slab.weighting = weighting;
    slab.coeffs = {coefficient};
    LightField lightfield;
    lightfield.slabs = {slab};
    return lightfield;
}

LuminaireInstance write_lamp(const LightField& lightfield,
                             const std::string& name,
                             const glm::dmat4& world_from_luminaire) {
    LuminaireInstance lamp;
    lamp.name = name;
    lamp.uri = lamp.path = name + ".lightfield.exr";
    lamp.world_from_luminaire = world_from_luminaire;
    write_lightfield(lightfield, std::nullopt, lamp.path);
    return lamp;
}

Mesh rectangle(const std::string& name, glm::vec2 size_m) {
    const glm::vec2 half = 0.5F * size_m;
    Mesh mesh;
    mesh.name = name;
    mesh.positions_m = {
        {-half.x, -half.y, 0}, {half.x, -half.y, 0}, {half.x, half.y, 0}, {-half.x, half.y, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

glm::dmat4 pose(glm::dvec3 position, glm::dvec3 direction) {
    const glm::dvec3 z = glm::normalize(direction);
    const glm::dvec3 helper = std::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
    return {glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0),
            glm::dvec4(position, 1)};
}

Camera camera_at(glm::dvec3 position, glm::dvec3 direction, glm::dvec3 up, double yfov_rad) {
    Camera camera;
    camera.name = "camera";
    camera.world_from_camera = glm::inverse(glm::lookAt(position, position + direction, up));
    camera.yfov_rad = yfov_rad;
    return camera;
}

Scene floor_scene() {
    Scene scene;
    scene.materials = {{"gray", glm::vec3(0.5F), 0.0F, 1.0F}};
    scene.meshes = {rectangle("floor mesh", glm::vec2(kFloorM))};
    scene.instances = {{"floor", 0, glm::dmat4(1.0)}};
    // The floor's edges are the picture's upper and lower edge.
    scene.cameras = {camera_at({0, 0, kCameraHeightM}, {0, 0, -1}, {0, 1, 0},
                               2.0 * std::atan(0.5 * kFloorM / kCameraHeightM))};
    return scene;
}

void add_blocker(Scene& scene, const std::string& name, glm::dvec3 center, glm::vec2 size_m) {
    scene.instances.push_back(
        {name, static_cast<int>(scene.meshes.size()), glm::translate(glm::dmat4(1.0), center)});
    scene.meshes.push_back(rectangle(name + " mesh", size_m));
}

const Layer& layer(const Picture& picture, const std::string& name) {
    for (const Layer& candidate : picture.layers)
        if (candidate.name == name)
            return candidate;
    throw std::runtime_error("no layer " + name);
}

glm::dvec2 floor_position(glm::ivec2 pixel, glm::ivec2 size_px) {
    const glm::dvec2 middle = glm::dvec2(pixel) + 0.5;
    return glm::dvec2(middle.x - 0.5 * size_px.x, 0.5 * size_px.y - middle.y) *
           (kFloorM / size_px.y);
}

Scene half_covered() {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.2, 1.0F), "lamp", pose({0, 0, 2}, kDown))};
    add_blocker(scene, "sheet", {1, 0, 2.0999}, {2, 4});  // covers x > 0; U is at z = 2.1
    scene.cameras = {
        camera_at({0, -3, 1}, {0, 3, -1}, {0, 0, 1}, 0.5)};  // looks at the middle from below
    return scene;
}

Scene uneven_scene() {
    LightField lamp = one_window_lamp(0.02, 1.0F);
    Slab& slab = lamp.slabs[0];
    slab.grid = {3, 2};
    slab.texels = {5, 4};
    slab.channels = 3;
    slab.profile = model::make_profile("bspline");
    slab.coeffs.resize(std::size_t{3} * 6 * 20);
    for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
        slab.coeffs[i] = static_cast<float>((i * 7919) % 101);
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(lamp, "uneven", pose({-0.8, 0.5, 0.6}, {0.9, -0.3, -0.6}))};
    scene.luminaires[0].excludes = {"cover"};
    add_blocker(scene, "post", {0.3, 0.1, 0.25}, {0.2, 0.4});
    add_blocker(scene, "cover", {-0.8, 0.5, 0.5}, {0.1, 0.1});
    return scene;
}

Scene plain_scene() {
    LightField lamp = one_window_lamp(0.1, 1.0F);
    lamp.slabs[0].texels = {9, 7};
    lamp.slabs[0].coeffs.resize(63);
    for (std::size_t i = 0; i < 63; ++i)
        lamp.slabs[0].coeffs[i] = static_cast<float>((i * 37) % 11);
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(lamp, "plain", pose({0.3, 0, 1}, kDown))};
    return scene;
}

Scene with_second_lamp(Scene scene) {
    LuminaireInstance second = scene.luminaires.front();
    second.name = "second";
    second.world_from_luminaire[3] += glm::dvec4(0.4, -0.3, 0.2, 0.0);
    second.dim = 0.5;
    scene.luminaires.push_back(second);
    return scene;
}

Scene transformed(Scene scene, const glm::dmat4& matrix) {
    for (Instance& instance : scene.instances)
        instance.world_from_mesh = matrix * instance.world_from_mesh;
    for (LuminaireInstance& lamp : scene.luminaires)
        lamp.world_from_luminaire = matrix * lamp.world_from_luminaire;
    for (Camera& camera : scene.cameras)
        camera.world_from_camera = matrix * camera.world_from_camera;
    return scene;
}

}  // namespace nearfield::test
