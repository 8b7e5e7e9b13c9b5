// SPDX-License-Identifier: Apache-2.0
#include "render/materials.h"

#include "formats/shared/tonemap.glsl.h"

namespace nearfield::render {
namespace {

glm::vec3 grayed(glm::vec3 color) {
    return glm::vec3(shared::luminance709(color));
}

}  // namespace

shared::Brdf planned_brdf(const Material& material, const Plan& plan) {
    shared::Brdf reflection = brdf(material);
    if (!plan.has_gloss)
        reflection.specular = glm::vec3(0.0F);
    if (plan.color.is_removed) {
        reflection.diffuse = grayed(reflection.diffuse);
        reflection.specular = grayed(reflection.specular);
    }
    return reflection;
}

}  // namespace nearfield::render
