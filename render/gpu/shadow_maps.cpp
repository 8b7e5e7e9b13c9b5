// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/shadow_maps.h"

#include "formats/files/error.h"
#include "render/gpu/storage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace nearfield::render::gpu {
namespace {

// Of the planes' distance: casters and receivers nearer to U's plane are left out.
constexpr double kNearestOfDelta = 1e-4;

// Locations in shadow_map.vert and shadow_visibility.comp.
constexpr GLint kEye = 0, kTurn = 1, kTangents = 2, kNearest = 3;
constexpr GLint kCells = 0;

// As std430 lays ShadowCells of shadows.glsl out.
struct CellBlock {
    glm::vec4 eye_world_m_view, tangents;
};
static_assert(sizeof(CellBlock) == 32);

double scale_of(const PlacedSlab& slab) {
    return glm::length(glm::dvec3(slab.world_from_slab[0]));
}

double nearest_world_m(const PlacedSlab& slab) {
    return kNearestOfDelta * slab.prepared->slab.delta_m * scale_of(slab);
}

glm::dvec3 eye_world_m(const PlacedSlab& slab, const ShadowView& view) {
    return {slab.world_from_slab * glm::dvec4(view.eye_m, 1.0)};
}

ShadowKey key_of(const Lamps& lamps,
                 const Lamp& lamp,
                 const SceneBuffers& scene,
                 const ShadowMapOptions& options) {
    ShadowKey key{lamp.file, {}, {}, scene.geometry_hash, options};
    for (const PlacedSlab& slab : lamp.slabs)
        key.world_from_slab.push_back(slab.world_from_slab);
    for (const std::uint32_t mask : lamps.instance_masks)
        key.is_caster.push_back((mask & lamp.mask) != 0);
    return key;
}

/// Whether all of a box lies beside the view's pyramid.
bool is_out_of_view(const PlacedSlab& slab, const ShadowView& view, const DrawRange& range) {
    unsigned beside = 31U;  // a bit a plane: all corners so far are beyond it
    for (unsigned c = 0; c < 8; ++c) {
        const glm::dvec3 corner((c & 1U) != 0 ? range.high_world_m.x : range.low_world_m.x,
                                (c & 2U) != 0 ? range.high_world_m.y : range.low_world_m.y,
                                (c & 4U) != 0 ? range.high_world_m.z : range.low_world_m.z);
        const glm::dvec3 p =
            glm::dvec3(slab.slab_from_world * glm::dvec4(corner, 1.0)) - view.eye_m;
        const glm::dvec2 low = view.tangent_min * p.z, high = view.tangent_max * p.z;
        const std::array<bool, 5> is_beyond = {p.z <= 0.0, p.x<low.x, p.x> high.x,
                                               p.y<low.y, p.y> high.y};
        for (unsigned plane = 0; plane < is_beyond.size(); ++plane)
            if (!is_beyond[plane])
                beside &= ~(1U << plane);
    }
    return beside != 0;
}

std::size_t draw_view(const ShadowPass& pass,
                      const SceneBuffers& scene,
                      const PlacedSlab& slab,
                      const ShadowView& view,
                      const std::vector<bool>& is_caster) {
    const glm::vec3 eye(eye_world_m(slab, view));
    const glm::mat3 turn(slab.slab_from_world_rotation);
    const glm::vec4 tangents(glm::vec2(0.5 * (view.tangent_min + view.tangent_max)),
                             glm::vec2(2.0 / (view.tangent_max - view.tangent_min)));
    const GLuint program = pass.draw.id();
    glProgramUniform3fv(program, kEye, 1, &eye[0]);
    glProgramUniformMatrix3fv(program, kTurn, 1, GL_FALSE, &turn[0][0]);
    glProgramUniform4fv(program, kTangents, 1, &tangents[0]);
    glProgramUniform1f(program, kNearest, static_cast<float>(nearest_world_m(slab)));
    std::size_t indices = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const DrawRange& range = scene.instances[i];
        if (!is_caster[i] || range.indices == 0 || is_out_of_view(slab, view, range))
            continue;
        const std::size_t offset = range.first_index * sizeof(std::uint32_t);
        // OpenGL takes an offset as a pointer.
        // NOLINTNEXTLINE(performance-no-int-to-ptr)
        const auto* first = reinterpret_cast<const void*>(offset);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.indices), GL_UNSIGNED_INT, first);
        indices += range.indices;
    }
    return indices / 3;
}

void draw_views(const ShadowPass& pass,
                const SceneBuffers& scene,
                const Lamp& lamp,
                ShadowMaps& maps) {
    const int map_px = maps.key.options.map_px;
    constexpr float kFarthest = 0.0F;
    glBindFramebuffer(GL_FRAMEBUFFER, pass.framebuffer.id());
    glViewport(0, 0, map_px, map_px);
    glUseProgram(pass.draw.id());
    glBindVertexArray(scene.array.id());
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    maps.triangles = 0;
    for (std::size_t v = 0; v < maps.views.views.size(); ++v) {
        const ShadowView& view = maps.views.views[v];
        glNamedFramebufferTextureLayer(pass.framebuffer.id(), GL_DEPTH_ATTACHMENT, maps.depth.id(),
                                       0, static_cast<GLint>(v));
        glClearBufferfv(GL_DEPTH, 0, &kFarthest);
        maps.triangles += draw_view(pass, scene, lamp.slabs[view.slab], view, maps.key.is_caster);
    }
    glNamedFramebufferTexture(pass.framebuffer.id(), GL_DEPTH_ATTACHMENT, 0, 0);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

Buffer make_cells(Device& device,
                  const PlacedSlab& slab,
                  const ShadowViews& views,
                  std::size_t index) {
    const auto nearest = static_cast<float>(nearest_world_m(slab));
    std::vector<glm::vec4> values = {glm::vec4(nearest, 0.0F, 0.0F, 0.0F)};
    for (const int v : views.of_cell[index]) {
        CellBlock block{glm::vec4(0.0F, 0.0F, 0.0F, -1.0F), glm::vec4(0.0F)};
        if (v >= 0) {
            const ShadowView& view = views.views[static_cast<std::size_t>(v)];
            block.eye_world_m_view =
                glm::vec4(glm::vec3(eye_world_m(slab, view)), static_cast<float>(v));
            block.tangents = glm::vec4(glm::vec2(view.tangent_min),
                                       glm::vec2(1.0 / (view.tangent_max - view.tangent_min)));
        }
        values.push_back(block.eye_world_m_view);
        values.push_back(block.tangents);
    }
    return make_buffer_of(device, values, "cells of a lamp's shadow maps");
}

/// Runs a program of measurement over width x height; found: at binding 5.
void measure(const Program& program,
             const MeasuredShadows& of,
             const Buffer& found,
             glm::ivec2 size) {
    bind_surfaces(of.surfaces, of.materials);
    bind_slab(of.slab_textures);
    bind_shadows(of.maps, of.slab);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, found.id());
    dispatch_2d(program, size.x, size.y);
    of.device.check("a measurement of shadow maps");
}

}  // namespace

ShadowPass make_shadow_pass() {
    ShadowPass pass;
    pass.draw = link_draw("render/shaders/shadow_map.vert", "render/shaders/shadow_map.frag");
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    pass.framebuffer = Framebuffer(id);
    glNamedFramebufferDrawBuffer(id, GL_NONE);
    return pass;
}

void update_shadow_maps(Device& device,
                        const ShadowPass& pass,
                        const SceneBuffers& scene,
                        const Lamps& lamps,
                        std::size_t lamp,
                        const ShadowMapOptions& options,
                        ShadowMaps& maps) {
    check(options);
    const Lamp& of = lamps.lamps[lamp];
    ShadowKey key = key_of(lamps, of, scene, options);
    if (maps.renders > 0 && key == maps.key)
        return;
    maps.key = std::move(key);
    maps.views = find_shadow_views(of.slabs, options, device.max_layers());
    // A lamp without light has no view, but textures have a layer.
    maps.depth = make_texture_array(device, "shadow maps of lamp '" + of.name + "'",
                                    GL_DEPTH_COMPONENT32F, glm::ivec2(options.map_px),
                                    std::max(static_cast<int>(maps.views.views.size()), 1));
    maps.cells.clear();
    for (std::size_t s = 0; s < of.slabs.size(); ++s)
        maps.cells.push_back(make_cells(device, of.slabs[s], maps.views, s));
    draw_views(pass, scene, of, maps);
    device.check("shadow maps");
    ++maps.renders;
}

Defines shadow_defines(const ShadowMapOptions& options) {
    const int side = options.pcf_taps == 1   ? 1
                     : options.pcf_taps == 4 ? 2
                     : options.pcf_taps == 9 ? 3
                                             : 4;
    return {"HAS_SHADOWS", fmt::format("SHADOW_TAPS_PER_SIDE {}", side)};
}

void bind_shadows(const ShadowMaps& maps, std::size_t slab) {
    glBindTextureUnit(3, maps.depth.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, maps.cells[slab].id());
}

Program link_unmapped(const ShadowMapOptions& options) {
    return link_compute("render/shaders/shadow_unmapped.comp", shadow_defines(options));
}

int count_unmapped(const MeasuredShadows& of, const Program& unmapped) {
    const Buffer count =
        make_zero_buffer(of.device, sizeof(glm::uvec4), "the count of unmapped pixels");
    measure(unmapped, of, count, of.surfaces.size_px);
    return static_cast<int>(read_buffer<std::uint32_t>(count, 1).front());
}

std::vector<float> cell_visibilities(const MeasuredShadows& of) {
    const auto cells = static_cast<int>(of.maps.views.of_cell[of.slab].size());
    const int pixels = of.surfaces.size_px.x * of.surfaces.size_px.y;
    const std::size_t count = static_cast<std::size_t>(cells) * static_cast<std::size_t>(pixels);
    const Buffer found =
        make_zero_buffer(of.device, count * sizeof(float), "visibilities of cells");
    const Program program =
        link_compute("render/shaders/shadow_visibility.comp", shadow_defines(of.maps.key.options));
    glProgramUniform1i(program.id(), kCells, cells);
    measure(program, of, found, {cells, pixels});
    return read_buffer<float>(found, count);
}

}  // namespace nearfield::render::gpu
