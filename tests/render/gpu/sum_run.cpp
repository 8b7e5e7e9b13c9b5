// SPDX-License-Identifier: Apache-2.0
#include "tests/render/gpu/sum_run.h"

#include "render/gpu/scene_buffers.h"
#include "render/gpu/storage.h"
#include "render/gpu/surfaces.h"

#include <algorithm>

namespace nearfield::render::gpu {
namespace {

constexpr int kWidthPx = 24;

Surfaces surfaces_of(Device& device,
                     glm::ivec2 size_px,
                     std::span<const model::ReceiverF> receivers,
                     glm::dvec3 eye_world_m) {
    std::vector<SurfacePoint> points(static_cast<std::size_t>(size_px.x) *
                                     static_cast<std::size_t>(size_px.y));
    std::transform(receivers.begin(), receivers.end(), points.begin(),
                   [](const model::ReceiverF& receiver) {
                       SurfacePoint point;
                       point.position_world_m = receiver.position_m;
                       point.normal = receiver.normal;
                       point.material = 0;
                       return point;
                   });
    return upload_surfaces(device, size_px, points, eye_world_m, false);
}

std::vector<glm::vec4> texels_of(const Texture& texture, glm::ivec2 size_px, std::size_t count) {
    const std::vector<float> values = read_back(texture, size_px, 4);
    std::vector<glm::vec4> texels(count);
    for (std::size_t k = 0; k < count; ++k)
        texels[k] = {values[4 * k], values[4 * k + 1], values[4 * k + 2], values[4 * k + 3]};
    return texels;
}

}  // namespace

SumLight run_sum(Device& device,
                 LightSumPrograms& programs,
                 std::span<const SumSlab> slabs,
                 std::span<const model::ReceiverF> receivers,
                 const SumRun& run) {
    const glm::ivec2 size_px(kWidthPx,
                             (static_cast<int>(receivers.size()) + kWidthPx - 1) / kWidthPx);
    const Surfaces surfaces = surfaces_of(device, size_px, receivers, run.eye_world_m);
    const Buffer materials = upload_materials(device, {run.brdf});
    const Texture light = make_texture(device, "light", GL_RGBA32F, size_px);
    const Texture irradiance = make_texture(device, "irradiance", GL_RGBA32F, size_px);
    for (const Texture* image : {&light, &irradiance})
        glClearTexImage(image->id(), 0, GL_RGBA, GL_FLOAT, nullptr);
    glBindImageTexture(0, light.id(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32F);
    glBindImageTexture(1, irradiance.id(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32F);
    bind_surfaces(surfaces, materials);
    device.run_pass("light sum", [&] {
        for (const SumSlab& slab : slabs)
            add_light_sum(device, programs, slab, run.q, run.dim, size_px);
    });
    return {texels_of(light, size_px, receivers.size()),
            texels_of(irradiance, size_px, receivers.size())};
}

}  // namespace nearfield::render::gpu
