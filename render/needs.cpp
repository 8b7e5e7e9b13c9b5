// SPDX-License-Identifier: Apache-2.0
#include "render/needs.h"

#include "render/occluders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace nearfield::render {
namespace {

const Material& material_of(const Scene& scene, const Instance& instance) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    return scene.materials[static_cast<std::size_t>(mesh.material)];
}

bool is_gray(glm::vec3 color) {
    return color.r == color.g && color.g == color.b;
}

bool is_lit(const std::optional<SceneEnvironment>& environment) {
    return environment && environment->intensity > 0.0;
}

Need environment_need(const Scene& scene) {
    if (!scene.environment)
        return {false, "the scene has none"};
    return {is_lit(scene.environment),
            is_lit(scene.environment)
                ? fmt::format("'{}' is around", scene.environment->uri)
                : fmt::format("'{}' has intensity 0", scene.environment->uri)};
}

Need diffuse_need(const Scene& scene) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Material& material = material_of(scene, scene.instances[i]);
        if (brdf(material).diffuse != glm::vec3(0.0F))
            return {true, fmt::format("{} is of '{}', which has a diffuse part",
                                      name_of_instance(scene, i), material.name)};
    }
    return {false, "no material has a diffuse part"};
}

/// All triangles in one plane hide nothing of the sky from each other.
Need sky_shadows_need(const Scene& scene) {
    std::optional<glm::dvec4> plane;  // normal of unit length, offset
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        for (const glm::uvec3 triangle : mesh.triangles) {
            glm::dvec3 corners[3];
            for (int k = 0; k < 3; ++k)
                corners[k] = glm::dvec3(instance.world_from_mesh *
                                        glm::dvec4(mesh.positions_m[triangle[k]], 1.0));
            const glm::dvec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
            if (!plane && glm::length(across) > 0.0) {
                const glm::dvec3 normal = glm::normalize(across);
                plane = glm::dvec4(normal, -glm::dot(normal, corners[0]));
            }
            for (const glm::dvec3 corner : corners) {
                // What shadow rays tell apart: 16 units in the last place of float.
                const double size = glm::length(corner) + 1e-30;
                if (plane && std::abs(glm::dot(*plane, glm::dvec4(corner, 1.0))) > 2e-6 * size)
                    return {true,
                            fmt::format("{} may stand before the sky", name_of_instance(scene, i))};
            }
        }
    }
    return {false, "all surfaces lie in one plane"};
}

Need color_need(const Scene& scene, const Lamps& lamps) {
    for (const Lamp& lamp : lamps.lamps)
        if (lamp.file->file_channels == 3)
            return {true, fmt::format("lamp '{}' has three channels", lamp.name)};
    if (is_lit(scene.environment))
        return {true, fmt::format("environment '{}' may have colors", scene.environment->uri)};
    for (const Instance& instance : scene.instances) {
        const Material& material = material_of(scene, instance);
        const shared::Brdf reflection = brdf(material);
        if (!is_gray(reflection.diffuse) || !is_gray(reflection.specular))
            return {true, fmt::format("material '{}' is not gray", material.name)};
    }
    return {false, "all lamps have one channel, all materials are gray"};
}

Need light_need(const Scene& scene, const std::vector<std::size_t>& reached) {
    if (reached.empty())
        return {false, "nothing lies in its beam"};
    const std::string first = name_of_instance(scene, reached.front());
    return {true, reached.size() == 1
                      ? fmt::format("lights {}", first)
                      : fmt::format("lights {} and {} more", first, reached.size() - 1)};
}

LampNeed lamp_need(const Scene& scene, const Lamps& lamps, const Lamp& lamp) {
    const std::vector<std::size_t> reached = instances_reached(scene, lamp);
    LampNeed need{lamp.name, light_need(scene, reached), {false, "it lights nothing"}};
    if (reached.empty())
        return need;
    std::vector<bool> is_blocking;
    for (const std::uint32_t mask : lamps.instance_masks)
        is_blocking.push_back((mask & lamp.mask) != 0U);
    const std::optional<std::string> occluder = find_occluder(scene, lamp, reached, is_blocking);
    need.shadows = {
        occluder.has_value(),
        occluder.value_or(fmt::format("nothing can stand in the light of '{}'", lamp.name))};
    return need;
}

/// Of the first lamp that calls for them.
Need shadows_need(const std::vector<LampNeed>& lamps) {
    for (const LampNeed& lamp : lamps)
        if (lamp.shadows.is_called_for)
            return lamp.shadows;
    return {false, lamps.empty() ? "no lamp is on" : "nothing can stand in any lamp's light"};
}

}  // namespace

Need gloss_need(const Scene& scene) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Material& material = material_of(scene, scene.instances[i]);
        if (shared::brdf_is_glossy(brdf(material)))
            return {true, fmt::format("{} is of '{}', which has a lobe", name_of_instance(scene, i),
                                      material.name)};
    }
    return {false, "no material has a lobe"};
}

Needs needs_of(const Scene& scene, const Lamps& lamps, const RenderOptions& options) {
    Needs needs;
    for (const LuminaireInstance& luminaire : scene.luminaires)
        if (!luminaire.on || luminaire.dim == 0.0)
            needs.unlit.push_back({luminaire.name, luminaire.on ? "dimmed to 0" : "off"});
    for (const Lamp& lamp : lamps.lamps)
        needs.lamps.push_back(lamp_need(scene, lamps, lamp));
    needs.shadows = shadows_need(needs.lamps);
    needs.color = color_need(scene, lamps);
    needs.gloss = gloss_need(scene);
    needs.environment = environment_need(scene);
    needs.diffuse = diffuse_need(scene);
    needs.sky_shadows = sky_shadows_need(scene);
    needs.tone_mapping = {options.is_displayed,
                          options.is_displayed ? "a PNG is written" : "no PNG is written"};
    return needs;
}

}  // namespace nearfield::render
