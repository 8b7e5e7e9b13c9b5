// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/frame_report.h"

#include "render/film.h"
#include "render/gpu/storage.h"

namespace nearfield::render::gpu {
namespace {

/// What drawing keeps from lamp to lamp.
std::uint64_t energy_bytes(const LightSamples& samples) {
    return samples.entries * sizeof(float) + samples.totals * sizeof(double) +
           samples.luminances * sizeof(float);
}

/// What passes hold that is made once, before they run.
std::uint64_t bytes_before(const GlFrame& frame, std::uint64_t surface_bytes, PassId id) {
    const glm::ivec2 size_px = frame.film.size_px;
    const auto pixels =
        static_cast<std::uint64_t>(size_px.x) * static_cast<std::uint64_t>(size_px.y);
    switch (id) {
        case PassId::GBuffer:
            return surface_bytes;
        case PassId::LightSums:
            return frame.on_card.sum_bytes;
        case PassId::BoxEnergies:
            return energy_bytes(frame.passes.samples) +
                   energy_bytes(frame.passes.unshadowed_samples);
        case PassId::Samples:
            return frame.on_card.table_bytes;
        case PassId::Environment:
            return frame.sky != nullptr ? frame.sky->on_card.bytes : 0;
        case PassId::Accumulate:
            return pixels * (16U * (4U + frame.film.of_lamp.size()) + (frame.film.bias ? 36U : 0U));
        default:
            return 0;
    }
}

}  // namespace

void read_surfaces(const Surfaces& surfaces,
                   const std::vector<shared::Brdf>& brdfs,
                   Picture& picture) {
    const std::vector<float> position = read_back(surfaces.position, surfaces.size_px, 4);
    const std::vector<float> normal = read_back(surfaces.normal, surfaces.size_px, 4);
    for (std::size_t k = 0; 4 * k < position.size(); ++k) {
        const int material = static_cast<int>(position[4 * k + 3]) - 1;
        if (material < 0)
            continue;
        for (std::size_t c = 0; c < 3; ++c) {
            picture.layers[kAlbedo].values[3 * k + c] =
                brdfs[static_cast<std::size_t>(material)].diffuse[static_cast<int>(c)];
            picture.layers[kNormal].values[3 * k + c] = normal[4 * k + c];
        }
        picture.layers[kDepth].values[k] = normal[4 * k + 3];
    }
}

void read_depth(const Surfaces& surfaces, Picture& picture) {
    const std::vector<float> position = read_back(surfaces.position, surfaces.size_px, 4);
    const std::vector<float> normal = read_back(surfaces.normal, surfaces.size_px, 4);
    std::vector<float>& depth = picture.layers[kDepth].values;
    for (std::size_t k = 0; k < depth.size(); ++k)
        depth[k] = position[4 * k + 3] > 0.0F ? normal[4 * k + 3] : 0.0F;
}

void report_costs(const GlFrame& frame, std::uint64_t surface_bytes, RenderReport& report) {
    for (const PlannedPass& pass : report.plan.passes) {
        PassReport cost{pass.id, 0.0,
                        static_cast<double>(bytes_before(frame, surface_bytes, pass.id))};
        for (const PassCost& one : frame.device.costs())
            if (one.name == pass.name) {
                cost.time_s += one.time_s;
                cost.bytes += static_cast<double>(one.bytes);
            }
        if (pass.is_in)
            report.costs.push_back(cost);
    }
}

}  // namespace nearfield::render::gpu
