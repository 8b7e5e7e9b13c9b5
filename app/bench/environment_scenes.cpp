// SPDX-License-Identifier: Apache-2.0
#include "app/bench/environment_scenes.h"

#include "formats/environment/latlong.h"
#include "formats/files/error.h"
#include "formats/files/image.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::bench {
namespace {

const double kPi = std::acos(-1.0);

/// Right-handed, looking at the origin.
Camera camera_from(glm::dvec3 position, double yfov_rad) {
    const glm::dvec3 back = glm::normalize(position);
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), back));
    Camera camera;
    camera.world_from_camera =
        glm::dmat4(glm::dvec4(right, 0.0), glm::dvec4(glm::cross(back, right), 0.0),
                   glm::dvec4(back, 0.0), glm::dvec4(position, 1.0));
    camera.yfov_rad = yfov_rad;
    camera.aspect = 1.0;
    return camera;
}

/// Normals from the triangles about each vertex, weighted by their area.
void shade_smoothly(Mesh& mesh) {
    mesh.normals.assign(mesh.positions_m.size(), glm::vec3(0.0F));
    for (const glm::uvec3 triangle : mesh.triangles) {
        const glm::vec3 a = mesh.positions_m[triangle.x];
        const glm::vec3 across =
            glm::cross(mesh.positions_m[triangle.y] - a, mesh.positions_m[triangle.z] - a);
        for (int k = 0; k < 3; ++k)
            mesh.normals[triangle[k]] += across;
    }
    for (glm::vec3& normal : mesh.normals)
        normal = glm::length(normal) > 0.0F ? glm::normalize(normal) : glm::vec3(0.0F, 1.0F, 0.0F);
}

glm::dvec3 on_ball(double polar, double azimuth) {
    return {std::sin(polar) * std::sin(azimuth), std::cos(polar),
            std::sin(polar) * std::cos(azimuth)};
}

}  // namespace

void write_hall(const std::string& path) {
    struct HallLamp {
        glm::dvec3 towards;
        double radius_deg, radiance;
    };
    constexpr std::array<HallLamp, 8> kLamps = {{{{0.2, 0.9, 0.4}, 2.0, 1500.0},
                                                 {{-0.7, 0.5, 0.5}, 1.2, 2200.0},
                                                 {{0.8, 0.4, 0.6}, 1.6, 700.0},
                                                 {{-0.3, 0.6, -0.8}, 2.5, 300.0},
                                                 {{0.9, 0.1, -0.2}, 4.0, 60.0},
                                                 {{-0.9, -0.1, 0.1}, 3.0, 90.0},
                                                 {{0.1, 0.3, 1.0}, 1.5, 900.0},
                                                 {{-0.1, -0.6, 0.8}, 2.0, 40.0}}};
    Picture picture;
    picture.size_px = {256, 128};
    picture.layers = {{"", {"R", "G", "B"}, {}}};
    environment::LatLong shape{picture.size_px, {}};
    for (int y = 0; y < picture.size_px.y; ++y)
        for (int x = 0; x < picture.size_px.x; ++x) {
            const glm::dvec3 d(environment::pixel_direction(shape, {x, y}));
            glm::dvec3 rgb = glm::dvec3(0.25, 0.18, 0.1) * (1.0 + 0.8 * d.y) +
                             glm::dvec3(0.05, 0.07, 0.1) * std::pow(std::sin(6.0 * d.x), 2);
            for (const HallLamp& lamp : kLamps)
                if (glm::dot(d, glm::normalize(lamp.towards)) >
                    std::cos(lamp.radius_deg * kPi / 180.0))
                    rgb += lamp.radiance * glm::dvec3(1.0, 0.85, 0.6);
            for (int c = 0; c < 3; ++c)
                picture.layers[0].values.push_back(static_cast<float>(rgb[c]));
        }
    write_picture(picture, std::nullopt, path);
}

void write_sun(const std::string& path, int height_px, glm::ivec2 pixel) {
    Picture picture;
    picture.size_px = {2 * height_px, height_px};
    picture.layers = {{"", {"Y"}, {}}};
    for (int y = 0; y < picture.size_px.y; ++y)
        for (int x = 0; x < picture.size_px.x; ++x)
            picture.layers[0].values.push_back(glm::ivec2(x, y) == pixel ? 1e6F : 0.0F);
    write_picture(picture, std::nullopt, path);
}

Mesh make_plate() {
    const glm::vec3 along(1.0F, 0.0F, 0.0F), up(0.0F, 0.77F, -0.638F);
    Mesh plate;
    plate.name = "plate";
    plate.positions_m = {-along - up, along - up, along + up, -along + up};
    plate.normals.assign(4, glm::normalize(glm::cross(along, up)));
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    return plate;
}

Mesh make_ball(int rows, double knobs) {
    Mesh mesh;
    mesh.name = knobs > 0.0 ? "knobby ball" : "ball";
    const int columns = 2 * rows;
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column <= columns; ++column) {
            const double polar = kPi * row / rows, azimuth = 2.0 * kPi * column / columns;
            const double radius = 1.0 - knobs +
                                  knobs * std::cos(9.0 * polar) * std::cos(8.0 * azimuth) *
                                      std::pow(std::sin(polar), 2);
            mesh.positions_m.emplace_back(radius * on_ball(polar, azimuth));
            mesh.normals.emplace_back(on_ball(polar, azimuth));
            // Around the axis.
            mesh.tangents.emplace_back(std::cos(azimuth), 0.0, -std::sin(azimuth));
        }
    const auto at = [&](int row, int column) {
        return static_cast<unsigned>(row * (columns + 1) + column);
    };
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            if (row > 0)
                mesh.triangles.emplace_back(at(row, column), at(row + 1, column + 1),
                                            at(row, column + 1));
            if (row + 1 < rows)
                mesh.triangles.emplace_back(at(row, column), at(row + 1, column),
                                            at(row + 1, column + 1));
        }
    if (knobs > 0.0)
        shade_smoothly(mesh);
    return mesh;
}

Mesh read_mesh(const std::string& path) {
    const Scene scene = read_scene(path);
    if (scene.meshes.empty())
        throw Error{"no surface to measure", path, "a mesh", "none"};
    Mesh mesh = scene.meshes.front();
    mesh.material = 0;
    mesh.tangents.clear();
    glm::vec3 low = mesh.positions_m.front(), high = low;
    for (const glm::vec3 p : mesh.positions_m) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const float scale = 2.0F / std::max(glm::length(high - low), 1e-12F);
    for (glm::vec3& p : mesh.positions_m)
        p = (p - 0.5F * (low + high)) * scale;
    if (mesh.normals.empty())
        shade_smoothly(mesh);
    return mesh;
}

Scene scene_of(const Mesh& mesh, const shared::Brdf& brdf, const std::string& picture) {
    Scene scene;
    Material material;
    material.name = "measured";
    material.given_brdf = brdf;
    scene.materials = {material};
    scene.meshes = {mesh};
    scene.instances = {{mesh.name, 0, glm::dmat4(1.0)}};
    scene.cameras = {camera_from({0.0, 0.6, 4.0}, 0.53)};
    scene.environment = SceneEnvironment{picture, picture};
    return scene;
}

void add_floor(Scene& scene) {
    Mesh floor;
    floor.name = "floor";
    floor.positions_m = {{-4, -1, -4}, {4, -1, -4}, {4, -1, 4}, {-4, -1, 4}};
    floor.normals.assign(4, glm::vec3(0.0F, 1.0F, 0.0F));
    floor.triangles = {{0, 2, 1}, {0, 3, 2}};
    floor.material = static_cast<int>(scene.materials.size());
    Material white;
    white.name = "floor";
    white.given_brdf = matt();
    scene.materials.push_back(white);
    scene.instances.push_back({"floor", static_cast<int>(scene.meshes.size()), glm::dmat4(1.0)});
    scene.meshes.push_back(floor);
    scene.cameras = {camera_from({0.0, 3.0, 5.0}, 0.6)};
}

shared::Brdf phong(float exponent) {
    shared::Brdf brdf{};
    brdf.kind = shared::kBrdfPhong;
    brdf.specular = glm::vec3(1.0F);
    brdf.exponent = exponent;
    return brdf;
}

shared::Brdf ggx(float alpha) {
    shared::Brdf brdf = ward(alpha, alpha);
    brdf.kind = shared::kBrdfGgx;
    return brdf;
}

shared::Brdf ward(float alpha_x, float alpha_y) {
    shared::Brdf brdf{};
    brdf.kind = shared::kBrdfWard;
    brdf.specular = glm::vec3(1.0F);
    brdf.alpha = {alpha_x, alpha_y};
    return brdf;
}

shared::Brdf matt() {
    shared::Brdf brdf{};
    brdf.diffuse = glm::vec3(0.8F);
    return brdf;
}

}  // namespace nearfield::bench
