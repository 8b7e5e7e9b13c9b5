// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/sky_maps.h"

#include "formats/shared/frame.glsl.h"
#include "render/gpu/storage.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace nearfield::render::gpu {
namespace {

// Bindings of sky_maps.glsl, and sky_map.vert's location.
constexpr GLuint kDepth = 3, kViews = 6;
constexpr GLint kClipFromWorld = 0;

void draw_views(const SkyMapPass& pass,
                const SceneBuffers& scene,
                const std::vector<glm::mat4>& views,
                const SkyMaps& maps) {
    constexpr float kFarthest = 0.0F;
    glBindFramebuffer(GL_FRAMEBUFFER, pass.framebuffer.id());
    glViewport(0, 0, maps.key.map_px, maps.key.map_px);
    glUseProgram(pass.draw.id());
    glBindVertexArray(scene.array.id());
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    for (std::size_t n = 0; n < views.size(); ++n) {
        glNamedFramebufferTextureLayer(pass.framebuffer.id(), GL_DEPTH_ATTACHMENT, maps.depth.id(),
                                       0, static_cast<GLint>(n));
        glClearBufferfv(GL_DEPTH, 0, &kFarthest);
        glProgramUniformMatrix4fv(pass.draw.id(), kClipFromWorld, 1, GL_FALSE, &views[n][0][0]);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(scene.index_count()), GL_UNSIGNED_INT,
                       nullptr);
    }
    glNamedFramebufferTexture(pass.framebuffer.id(), GL_DEPTH_ATTACHMENT, 0, 0);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace

SkyMapPass make_sky_map_pass() {
    SkyMapPass pass;
    pass.draw = link_draw("render/shaders/sky_map.vert", "render/shaders/shadow_map.frag");
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    pass.framebuffer = Framebuffer(id);
    glNamedFramebufferDrawBuffer(id, GL_NONE);
    return pass;
}

glm::dmat4 clip_from_world(glm::dvec3 direction, std::span<const DrawRange> instances) {
    const shared::SurfaceFrame frame = shared::frame_from_normal(glm::vec3(direction));
    const glm::dmat3 turn =
        glm::transpose(glm::dmat3(glm::dvec3(frame.x), glm::dvec3(frame.y), direction));
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const DrawRange& range : instances)
        for (unsigned c = 0; c < 8 && range.indices > 0; ++c) {
            const glm::dvec3 corner =
                turn * glm::dvec3((c & 1U) != 0 ? range.high_world_m.x : range.low_world_m.x,
                                  (c & 2U) != 0 ? range.high_world_m.y : range.low_world_m.y,
                                  (c & 4U) != 0 ? range.high_world_m.z : range.low_world_m.z);
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    if (!(low.x <= high.x))
        low = high = glm::dvec3(0.0);
    // A hundredth more, so that nothing lies on the border or at depth 0, which is "nothing"; and
    // something where all lies in one plane.
    const glm::dvec3 middle = 0.5 * (low + high);
    const glm::dvec3 half = 0.505 * (high - low) + 1e-3 * glm::length(high - low) + 1e-9;
    const glm::dvec3 scale = glm::dvec3(1.0, 1.0, 0.5) / half;
    glm::dmat4 clip(1.0);
    for (int column = 0; column < 3; ++column)
        clip[column] = glm::dvec4(scale * turn[column], 0.0);
    clip[3] = glm::dvec4(-scale * middle + glm::dvec3(0.0, 0.0, 0.5), 1.0);
    return clip;
}

void update_sky_maps(Device& device,
                     const SkyMapPass& pass,
                     const SceneBuffers& scene,
                     const Sky& sky,
                     int map_px,
                     SkyMaps& maps) {
    const SkyMapKey key{sky.environment, sky.environment_from_world, scene.geometry_hash, map_px};
    if (maps.renders > 0 && key == maps.key)
        return;
    std::vector<glm::mat4> views;
    for (const glm::vec3 direction : sky.environment->directions->directions)
        views.emplace_back(clip_from_world(
            glm::dvec3(glm::transpose(sky.environment_from_world) * direction), scene.instances));
    // A dark sky has no direction, but textures have a layer.
    const int layers = std::max(static_cast<int>(views.size()), 1);
    if (maps.renders == 0 || maps.key.map_px != map_px || maps.key.environment != sky.environment)
        maps.depth = make_texture_array(device, "shadow maps of the environment",
                                        GL_DEPTH_COMPONENT32F, glm::ivec2(map_px), layers);
    maps.views = make_buffer_of(device, views, "views of the environment");
    maps.key = key;
    draw_views(pass, scene, views, maps);
    device.check("shadow maps of the environment");
    ++maps.renders;
}

void bind_sky_maps(const SkyMaps& maps) {
    glBindTextureUnit(kDepth, maps.depth.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kViews, maps.views.id());
}

}  // namespace nearfield::render::gpu
