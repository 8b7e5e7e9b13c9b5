// SPDX-License-Identifier: Apache-2.0
#include "sample_data/demo_scene.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace nearfield::sample_data {
namespace {

constexpr double kLampHeight_m = 0.65, kLampHalfDistance_m = 0.6;
constexpr float kWall_m = 11.0F;                           // distance of the wall's face
constexpr float kRoadRight_m = -2.0F, kRoadLeft_m = 5.0F;  // the road's edges, x
constexpr float kStart_m = -3.0F;                          // where everything begins, z
constexpr float kPaint_m = 0.0004F;                        // dry thickness of road paint
constexpr float kStop_m = 7.2F;                            // where the stop line begins, z
constexpr double kAspect = 16.0 / 9.0;

enum MaterialIndex {
    kAsphalt,
    kPaint,
    kStone,
    kPavement,
    kPlaster,
    kPlinth,
    kRed,
    kCar,
    kGlass,
    kDark,
    kPlastic
};

/// A dielectric with GGX' lobe. Color and roughness are also the core material's, for programs that
/// do not know the extension.
Material glossy(const std::string& name, glm::vec3 color, float roughness) {
    Material material{name, color, 0.0F, roughness};
    shared::Brdf brdf{};
    brdf.kind = shared::kBrdfGgx;
    brdf.diffuse = color;
    brdf.specular = glm::vec3(0.04F);
    brdf.alpha = glm::vec2(roughness * roughness);
    material.given_brdf = brdf;
    return material;
}

std::vector<Material> materials() {
    return {{"asphalt", glm::vec3(0.19F, 0.19F, 0.195F), 0.0F, 1.0F},
            {"paint", glm::vec3(0.80F), 0.0F, 1.0F},
            {"stone", glm::vec3(0.42F, 0.41F, 0.39F), 0.0F, 1.0F},
            {"pavement", glm::vec3(0.28F, 0.27F, 0.26F), 0.0F, 1.0F},
            {"plaster", glm::vec3(0.30F, 0.295F, 0.28F), 0.0F, 1.0F},
            {"plinth", glm::vec3(0.22F, 0.20F, 0.185F), 0.0F, 1.0F},
            {"red", glm::vec3(0.40F, 0.03F, 0.025F), 0.0F, 1.0F},
            glossy("car paint", glm::vec3(0.08F, 0.20F, 0.42F), 0.45F),
            glossy("window", glm::vec3(0.03F, 0.03F, 0.035F), 0.35F),
            {"housing", glm::vec3(0.02F), 0.0F, 1.0F},
            {"plastic", glm::vec3(0.40F), 0.0F, 1.0F}};
}

void add_mesh(Scene& scene, Mesh mesh) {
    const int index = static_cast<int>(scene.meshes.size());
    scene.instances.push_back({mesh.name, index, glm::dmat4(1.0)});
    scene.meshes.push_back(std::move(mesh));
}

// An upright prism over a convex outline in the plane spanned by two axes, from `lower` to `upper`
// along the third (axis). The outline runs counter-clockwise seen from the end of the axis.
Mesh prism(const std::string& name,
           int material,
           const std::vector<glm::vec2>& outline,
           int axis,
           float lower,
           float upper) {
    Mesh mesh{name, {}, {}, {}, material};
    const auto corner = [&](glm::vec2 p, float along) {
        glm::vec3 at(0.0F);
        at[axis] = along;
        at[(axis + 1) % 3] = p.x;
        at[(axis + 2) % 3] = p.y;
        return at;
    };
    const auto count = static_cast<std::uint32_t>(outline.size());
    for (const glm::vec2 p : outline) {
        mesh.positions_m.push_back(corner(p, lower));
    }
    for (const glm::vec2 p : outline) {
        mesh.positions_m.push_back(corner(p, upper));
    }
    for (std::uint32_t k = 0; k < count; ++k) {
        const std::uint32_t next = (k + 1) % count;
        mesh.triangles.emplace_back(k, next, count + next);
        mesh.triangles.emplace_back(k, count + next, count + k);
    }
    for (std::uint32_t k = 1; k + 1 < count; ++k) {
        mesh.triangles.emplace_back(0U, k + 1, k);
        mesh.triangles.emplace_back(count, count + k, count + k + 1);
    }
    return mesh;
}

void add_box(
    Scene& scene, const std::string& name, int material, glm::vec3 lower, glm::vec3 upper) {
    add_mesh(scene,
             prism(name, material,
                   {{lower.y, lower.z}, {upper.y, lower.z}, {upper.y, upper.z}, {lower.y, upper.z}},
                   0, lower.x, upper.x));
}

// Paint on the road, a sheet without sides: upright sides of a millimetre would stand square to the
// light that grazes the road, far brighter than the paint and far thinner than a pixel.
void add_marking(Scene& scene, const std::string& name, glm::vec2 lower_xz, glm::vec2 upper_xz) {
    Mesh mesh{name, {}, {}, {}, kPaint};
    mesh.positions_m = {{lower_xz.x, kPaint_m, lower_xz.y},
                        {lower_xz.x, kPaint_m, upper_xz.y},
                        {upper_xz.x, kPaint_m, upper_xz.y},
                        {upper_xz.x, kPaint_m, lower_xz.y}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    add_mesh(scene, std::move(mesh));
}

void add_cylinder(Scene& scene,
                  const std::string& name,
                  int material,
                  glm::vec2 center_zx,
                  float radius_m,
                  float lower_m,
                  float upper_m) {
    constexpr int kSides = 32;
    std::vector<glm::vec2> outline;
    for (int k = 0; k < kSides; ++k) {
        const float angle = glm::two_pi<float>() * static_cast<float>(k) / kSides;
        outline.push_back(center_zx + radius_m * glm::vec2(std::cos(angle), std::sin(angle)));
    }
    add_mesh(scene, prism(name, material, outline, 1, lower_m, upper_m));
}

void add_road(Scene& scene) {
    add_box(scene, "road", kAsphalt, {kRoadRight_m, -0.1F, kStart_m}, {kRoadLeft_m, 0.0F, kWall_m});
    for (const float x : {kRoadRight_m + 0.15F, kRoadLeft_m - 0.30F}) {
        add_marking(scene, "edge line", {x, kStart_m}, {x + 0.15F, kWall_m - 0.1F});
    }
    for (float z = kStart_m; z + 1.5F < kStop_m; z += 3.0F) {
        add_marking(scene, "center line", {1.44F, z}, {1.56F, z + 1.5F});
    }
    // A stop line, and bars of a crossing before the wall: near and far detail in the light.
    add_marking(scene, "stop line", {-1.5F, kStop_m}, {1.35F, kStop_m + 0.4F});
    for (float x = -1.5F; x < 4.5F; x += 0.9F) {
        add_marking(scene, "crossing", {x, 8.2F}, {x + 0.45F, 10.2F});
    }
    add_box(scene, "right curb", kStone, {kRoadRight_m - 0.15F, -0.1F, kStart_m},
            {kRoadRight_m, 0.12F, kWall_m});
    add_box(scene, "left curb", kStone, {kRoadLeft_m, -0.1F, kStart_m},
            {kRoadLeft_m + 0.15F, 0.12F, kWall_m});
    add_box(scene, "right pavement", kPavement, {kRoadRight_m - 4.15F, -0.1F, kStart_m},
            {kRoadRight_m - 0.15F, 0.11F, kWall_m});
    add_box(scene, "left pavement", kPavement, {kRoadLeft_m + 0.15F, -0.1F, kStart_m},
            {kRoadLeft_m + 3.15F, 0.11F, kWall_m});
}

void add_wall(Scene& scene) {
    const float right = -6.2F, left = 8.2F;
    add_box(scene, "wall", kPlaster, {right, 0.0F, kWall_m}, {left, 3.2F, kWall_m + 0.3F});
    // Its top slopes, to shed water; the outline in (y, z), seen from the left.
    add_mesh(
        scene,
        prism(
            "plinth", kPlinth,
            {{0.0F, kWall_m - 0.06F}, {0.20F, kWall_m - 0.06F}, {0.28F, kWall_m}, {0.0F, kWall_m}},
            0, right, left));
    add_box(scene, "coping", kStone, {right, 3.2F, kWall_m - 0.08F},
            {left, 3.32F, kWall_m + 0.38F});
    for (const float x : {-5.6F, -3.4F, 3.4F, 5.6F, 7.8F}) {
        add_box(scene, "pilaster", kPlaster, {x - 0.2F, 0.0F, kWall_m - 0.12F},
                {x + 0.2F, 3.2F, kWall_m});
    }
}

void add_bollard(Scene& scene, float x_m, float z_m) {
    constexpr float kFoot_m = 0.0F, kBand_m = 0.62F, kBandEnd_m = 0.76F, kTop_m = 0.95F;
    add_cylinder(scene, "bollard", kPlastic, {z_m, x_m}, 0.055F, kFoot_m, kBand_m);
    add_cylinder(scene, "bollard band", kRed, {z_m, x_m}, 0.056F, kBand_m, kBandEnd_m);
    add_cylinder(scene, "bollard top", kPlastic, {z_m, x_m}, 0.055F, kBandEnd_m, kTop_m);
}

void add_car(Scene& scene) {
    add_box(scene, "car body", kCar, {2.35F, 0.25F, 5.2F}, {4.15F, 0.85F, 9.4F});
    // The cabin's outline in (y, z), seen from the car's left.
    add_mesh(scene,
             prism("car cabin", kGlass,
                   {{0.85F, 5.7F}, {1.42F, 6.5F}, {1.42F, 8.4F}, {0.85F, 9.1F}}, 0, 2.47F, 4.03F));
    for (const float z : {6.0F, 8.6F}) {
        for (const float x : {2.45F, 3.85F}) {
            std::vector<glm::vec2> outline;
            for (int k = 0; k < 32; ++k) {
                const float angle = glm::two_pi<float>() * static_cast<float>(k) / 32.0F;
                outline.emplace_back(0.31F + 0.31F * std::cos(angle), z + 0.31F * std::sin(angle));
            }
            add_mesh(scene, prism("wheel", kDark, outline, 0, x, x + 0.2F));
        }
    }
}

Camera look(const std::string& name, glm::dvec3 from_m, glm::dvec3 to_m, double yfov_deg) {
    const glm::dmat4 camera_from_world = glm::lookAt(from_m, to_m, glm::dvec3(0.0, 1.0, 0.0));
    return {name, glm::inverse(camera_from_world), glm::radians(yfov_deg), kAspect};
}

}  // namespace

Scene make_demo_scene(const std::string& uri, const std::string& path, double delta_m) {
    Scene scene;
    scene.materials = materials();
    add_road(scene);
    add_wall(scene);
    add_car(scene);
    for (const float z : {4.6F, 6.2F, 7.8F, 9.4F}) {
        add_bollard(scene, -1.75F, z);
    }
    add_bollard(scene, 1.95F, 7.0F);
    for (const double x : {kLampHalfDistance_m, -kLampHalfDistance_m}) {
        const bool is_left = x > 0.0;
        LuminaireInstance lamp;
        lamp.name = is_left ? "left headlight" : "right headlight";
        lamp.uri = uri;
        lamp.path = path;
        lamp.world_from_luminaire =
            glm::translate(glm::dmat4(1.0), glm::dvec3(x, kLampHeight_m, delta_m));
        scene.luminaires.push_back(lamp);
        // Behind the lens, where it casts no shadow.
        const glm::vec3 lens(static_cast<float>(x), static_cast<float>(kLampHeight_m), 0.0F);
        add_box(scene, "housing", kDark, lens + glm::vec3(-0.10F, -0.08F, -0.30F),
                lens + glm::vec3(0.10F, 0.08F, -0.03F));
    }
    scene.cameras = {look("road", {1.1, 1.75, -0.4}, {0.15, 0.42, 8.0}, 42.0),
                     look("driver", {0.35, 1.25, -1.6}, {0.1, 0.55, 11.0}, 28.0),
                     look("bird", {0.4, 8.5, 3.2}, {0.4, 0.0, 7.0}, 50.0),
                     look("side", {-4.4, 1.8, 3.4}, {0.6, 0.35, 8.0}, 48.0)};
    return scene;
}

}  // namespace nearfield::sample_data
