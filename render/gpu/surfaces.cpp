// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/surfaces.h"

#include "formats/files/error.h"
#include "render/gpu/storage.h"

#include <array>
#include <cmath>
#include <vector>

namespace nearfield::render::gpu {
namespace {

// As std140 lays FrameBlock of surface.glsl out.
struct FrameBlock {
    glm::vec4 eye_world_m;
    glm::ivec4 size_px;
};

// Nearer surfaces are not seen. Depth is kept as its ratio to the true one, in float: any small
// value serves.
constexpr float kNearest_m = 1e-6F;

// Locations in gbuffer.vert and gbuffer.comp.
constexpr GLint kEye = 0, kTurn = 1, kScale = 2, kShift = 3, kNear = 4;
constexpr GLint kForward = 2, kPixel = 3;
// Of sky_samples.comp, which alone reads it; no lamp's texture is bound there.
constexpr GLuint kTurnTexture = 15;

Buffer make_frame(Device& device, glm::dvec3 eye_world_m, glm::ivec2 size_px) {
    const FrameBlock block{glm::vec4(glm::vec3(eye_world_m), 1.0F), {size_px, 0, 0}};
    return make_buffer(device, std::as_bytes(std::span(&block, 1)));
}

Surfaces make_surfaces(Device& device, glm::ivec2 size_px, bool has_tangents) {
    Surfaces surfaces;
    surfaces.size_px = size_px;
    surfaces.has_tangents = has_tangents;
    surfaces.position = make_texture(device, "seen positions", GL_RGBA32F, size_px);
    surfaces.normal = make_texture(device, "seen normals", GL_RGBA32F, size_px);
    if (has_tangents)
        surfaces.tangent = make_texture(device, "seen tangents", GL_RGBA32F, size_px);
    return surfaces;
}

/// A camera's film: what a pixel's place (x, y, 1) becomes a direction by, and back.
struct Lens {
    glm::dvec3 eye_world_m;
    glm::dmat3 camera_from_world, world_from_film;
    glm::dvec3 forward;  // of unit length
    double px_per_unit;  // at distance 1
};

Lens lens_of(const Camera& camera, glm::ivec2 size_px) {
    const glm::dmat3 world_from_camera(camera.world_from_camera);
    Lens lens{};
    lens.eye_world_m = glm::dvec3(camera.world_from_camera[3]);
    lens.camera_from_world = glm::inverse(world_from_camera);
    lens.px_per_unit = 0.5 * size_px.y / std::tan(0.5 * camera.yfov_rad);
    const double px = 1.0 / lens.px_per_unit;
    // Film: x right, y down, from the top left corner; camera: y up, looking along -z.
    lens.world_from_film =
        world_from_camera *
        glm::dmat3(px, 0.0, 0.0, 0.0, -px, 0.0, -0.5 * size_px.x * px, 0.5 * size_px.y * px, -1.0);
    lens.forward = -glm::normalize(world_from_camera[2]);
    return lens;
}

void draw_triangles(const SceneBuffers& scene,
                    const Lens& lens,
                    glm::dvec2 at_px,
                    const SurfacePass& pass) {
    const glm::dvec2 size(pass.size_px);
    const GLuint program = pass.draw.id();
    const glm::vec3 eye(lens.eye_world_m);
    const glm::mat3 turn(lens.camera_from_world);
    // Row 0 is the picture's top: y is turned over. The place at_px of a pixel falls on its middle.
    const glm::vec2 scale(2.0 * lens.px_per_unit / size * glm::dvec2(1.0, -1.0));
    const glm::vec2 shift(2.0 * (0.5 - at_px) / size);
    glProgramUniform3fv(program, kEye, 1, &eye[0]);
    glProgramUniformMatrix3fv(program, kTurn, 1, GL_FALSE, &turn[0][0]);
    glProgramUniform2fv(program, kScale, 1, &scale[0]);
    glProgramUniform2fv(program, kShift, 1, &shift[0]);
    glProgramUniform1f(program, kNear, kNearest_m);

    glBindFramebuffer(GL_FRAMEBUFFER, pass.framebuffer.id());
    glViewport(0, 0, pass.size_px.x, pass.size_px.y);
    constexpr std::array<GLuint, 4> kNone = {0, 0, 0, 0};
    constexpr float kFarthest = 0.0F;
    glClearBufferuiv(GL_COLOR, 0, kNone.data());
    glClearBufferfv(GL_DEPTH, 0, &kFarthest);
    if (scene.index_count() == 0)
        return;
    glUseProgram(program);
    glBindVertexArray(scene.array.id());
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(scene.index_count()), GL_UNSIGNED_INT,
                   nullptr);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void resolve_pixels(const SceneBuffers& scene,
                    const Lens& lens,
                    glm::dvec2 at_px,
                    const SurfacePass& pass) {
    glm::dmat3 world_from_pixel = lens.world_from_film;
    world_from_pixel[2] += world_from_pixel[0] * at_px.x + world_from_pixel[1] * at_px.y;
    const GLuint program = pass.resolve.id();
    const glm::vec3 forward(lens.forward);
    glProgramUniform3dv(program, kEye, 1, &lens.eye_world_m[0]);
    glProgramUniformMatrix3dv(program, kTurn, 1, GL_FALSE, &world_from_pixel[0][0]);
    glProgramUniform3fv(program, kForward, 1, &forward[0]);
    if (pass.surfaces.has_turns) {
        glProgramUniform1f(program, kPixel, static_cast<float>(1.0 / lens.px_per_unit));
        glBindImageTexture(3, pass.surfaces.turn.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    }

    glBindTextureUnit(0, pass.triangle.id());
    const std::array<const Buffer*, 4> buffers = {&scene.positions, &scene.normals, &scene.tangents,
                                                  &scene.indices};
    for (GLuint k = 0; k < buffers.size(); ++k)
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4 + k, buffers[k]->id());
    const std::array<const Texture*, 3> images = {&pass.surfaces.position, &pass.surfaces.normal,
                                                  &pass.surfaces.tangent};
    for (GLuint k = 0; k < (pass.has_tangents ? 3U : 2U); ++k)
        glBindImageTexture(k, images[k]->id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    dispatch_2d(pass.resolve, pass.size_px.x, pass.size_px.y);
}

Framebuffer make_framebuffer(const SurfacePass& pass) {
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    Framebuffer framebuffer(id);
    glNamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, pass.triangle.id(), 0);
    glNamedFramebufferTexture(id, GL_DEPTH_ATTACHMENT, pass.depth.id(), 0);
    return framebuffer;
}

}  // namespace

Surfaces upload_surfaces(Device& device,
                         glm::ivec2 size_px,
                         std::span<const SurfacePoint> points,
                         glm::dvec3 eye_world_m,
                         bool has_tangents) {
    Surfaces surfaces = make_surfaces(device, size_px, has_tangents);
    surfaces.frame = make_frame(device, eye_world_m, size_px);
    std::vector<glm::vec4> positions, normals, tangents;
    for (const SurfacePoint& point : points) {
        positions.emplace_back(point.position_world_m, static_cast<float>(1 + point.material));
        normals.emplace_back(point.normal, point.depth_m);
        tangents.emplace_back(point.tangent, 0.0F);
    }
    upload(surfaces.position, size_px, 4, &positions[0][0]);
    upload(surfaces.normal, size_px, 4, &normals[0][0]);
    if (has_tangents)
        upload(surfaces.tangent, size_px, 4, &tangents[0][0]);
    device.check("upload of surfaces");
    return surfaces;
}

SurfacePass make_surface_pass(Device& device,
                              const SceneBuffers& scene,
                              glm::ivec2 size_px,
                              bool has_turns) {
    SurfacePass pass;
    pass.size_px = size_px;
    pass.has_tangents = scene.has_tangents;
    pass.draw = link_draw("render/shaders/gbuffer.vert", "render/shaders/gbuffer.frag");
    Defines defines;
    if (scene.has_tangents)
        defines.emplace_back("HAS_TANGENTS");
    if (has_turns)
        defines.emplace_back("HAS_TURNS");
    pass.resolve = link_compute("render/shaders/gbuffer.comp", defines);
    pass.triangle = make_texture(device, "seen triangles", GL_R32UI, size_px);
    pass.depth = make_texture(device, "depths", GL_DEPTH_COMPONENT32F, size_px);
    pass.framebuffer = make_framebuffer(pass);
    pass.surfaces = make_surfaces(device, size_px, scene.has_tangents);
    pass.surfaces.frame = make_frame(device, glm::dvec3(0.0), size_px);
    pass.surfaces.has_turns = has_turns;
    if (has_turns)
        pass.surfaces.turn = make_texture(device, "turns of normals", GL_R32F, size_px);
    device.check("surfaces");
    return pass;
}

void draw_surfaces(const SceneBuffers& scene,
                   const Camera& camera,
                   glm::dvec2 at_px,
                   const SurfacePass& pass) {
    const Lens lens = lens_of(camera, pass.size_px);
    const glm::vec4 eye(glm::vec3(lens.eye_world_m), 1.0F);
    glNamedBufferSubData(pass.surfaces.frame.id(), offsetof(FrameBlock, eye_world_m), sizeof(eye),
                         &eye[0]);
    draw_triangles(scene, lens, at_px, pass);
    resolve_pixels(scene, lens, at_px, pass);
}

void bind_surfaces(const Surfaces& surfaces, const Buffer& materials) {
    const std::array<GLuint, 3> textures = {surfaces.position.id(), surfaces.normal.id(),
                                            surfaces.tangent.id()};
    glBindTextures(0, static_cast<GLsizei>(textures.size()), textures.data());
    if (surfaces.has_turns)
        glBindTextureUnit(kTurnTexture, surfaces.turn.id());
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, surfaces.frame.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, materials.id());
}

}  // namespace nearfield::render::gpu
