// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/tile.h"

#include "formats/shared/rng.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/lap.h"
#include "render/cpu/tile_block.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

// Light sums run over the hits of so many pixels together: their windows overlap, and what they
// read of an image, 16 receivers' weights included, stays in the first-level cache.
constexpr int kBlockPx = 4;

std::size_t index_of(const Frame& frame, glm::ivec2 pixel) {
    return static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(frame.picture.size_px.x) +
           static_cast<std::size_t>(pixel.x);
}

/// One camera ray a pixel, the same ones in every pass, and in the first the layers that need no
/// light.
void trace_camera(const Frame& frame,
                  const Pass& pass,
                  glm::ivec2 first,
                  glm::ivec2 last,
                  int stratum,
                  Block& block) {
    const int strata = frame.strata * frame.strata;
    std::vector<Layer>& layers = frame.picture.layers;
    const glm::dvec3 origin(frame.camera.world_from_camera[3]);
    const glm::dvec3 forward = -glm::normalize(glm::dvec3(frame.camera.world_from_camera[2]));
    block.samples.clear();
    block.hits.clear();
    for (int y = first.y; y < last.y; ++y)
        for (int x = first.x; x < last.x; ++x) {
            Sample sample;
            sample.pixel = {x, y};
            sample.index = index_of(frame, sample.pixel);
            const auto key =
                static_cast<std::uint32_t>(sample.index) * static_cast<std::uint32_t>(strata) +
                static_cast<std::uint32_t>(stratum);
            const glm::uvec4 random = shared::hash4({key, ~0U, frame.options.seed, 0U});
            sample.direction =
                camera_ray(frame.camera, frame.picture.size_px,
                           film_position_px({x, y}, stratum, frame.strata, random.x, random.y));
            const std::optional<Hit> hit = frame.tracer.trace(origin, sample.direction);
            if (!hit) {
                add_sky_past(frame, sample.index, sample.direction,
                             pass.weight / static_cast<float>(strata));
                continue;
            }
            sample.brdf = &frame.brdfs[static_cast<std::size_t>(hit->material)];
            sample.frame =
                shared::frame_from_tangent(glm::vec3(hit->shading_normal), glm::vec3(hit->tangent));
            block.samples.push_back(sample);
            block.hits.push_back(*hit);
            if (pass.index != 0)
                continue;
            add_rgb(layers[kAlbedo], sample.index,
                    sample.brdf->diffuse * (1.0F / static_cast<float>(strata)));
            if (stratum == strata / 2) {  // depths and normals have no meaningful mean
                layers[kDepth].values[sample.index] =
                    static_cast<float>(glm::dot(hit->position_world_m - origin, forward));
                add_rgb(layers[kNormal], sample.index, glm::vec3(hit->shading_normal));
            }
        }
}

bool needs_sums(const Frame& frame) {
    return !frame.options.sampler.has_value();
}

LampLight shade_by_samples(
    const Frame& frame, const ShadeQuery& query, const Lamp& lamp, std::size_t k, Block& block) {
    model::SamplerOptions sampler;
    sampler.sampler = frame.options.sampler.value_or(model::Sampler::Systematic);
    sampler.sequence = frame.options.sequence.value_or(model::default_sequence(sampler.sampler));
    return shade_sampled(lamp, frame.tracer, query, sampler,
                         needs_sums(frame) ? &block.sums : nullptr, k, block.scratch);
}

LampLight shade_glossy(const Frame& frame,
                       const ShadeQuery& query,
                       int q,
                       const Lamp& lamp,
                       std::size_t k,
                       Block& block) {
    // The sum for lobes has no coarser form.
    if (needs_sums(frame) && q == 0 && resolves_lobe(lamp, query))
        return shade_reflected(lamp, frame.tracer, query, block.scratch);
    return shade_by_samples(frame, query, lamp, k, block);
}

/// The sum where it is right, samples elsewhere.
LampLight shade(const Frame& frame,
                const ShadeQuery& query,
                int q,
                const Lamp& lamp,
                std::size_t k,
                Block& block) {
    if (!query.has_shadows && !faces(lamp, query.hit))
        return {};
    if (!shared::brdf_is_glossy(query.brdf))
        return needs_sums(frame)
                   ? shade_diffuse(lamp, frame.tracer, query, block.sums, k, block.scratch)
                   : shade_by_samples(frame, query, lamp, k, block);
    Lap lap;
    const double rays_before_s = block.scratch.shadow_rays_s;
    const LampLight light = shade_glossy(frame, query, q, lamp, k, block);
    block.scratch.gloss_s += lap.time_s() - (block.scratch.shadow_rays_s - rays_before_s);
    return light;
}

/// Adds one lamp's light to the layers, from sums that are ready.
void shade_block(
    const Frame& frame, const Pass& pass, int stratum, std::size_t lamp, Block& block) {
    const int strata = frame.strata * frame.strata;
    const auto lamps = static_cast<std::uint32_t>(frame.lamps.lamps.size());
    // Sets are numbered through passes, camera samples and lamps.
    const std::uint32_t first_set =
        ((pass.index * static_cast<std::uint32_t>(strata) + static_cast<std::uint32_t>(stratum)) *
             lamps +
         static_cast<std::uint32_t>(lamp)) *
        static_cast<std::uint32_t>(kMostSets);
    const float share = pass.weight / static_cast<float>(strata);
    std::vector<Layer>& layers = frame.picture.layers;
    for (std::size_t k = 0; k < block.samples.size(); ++k) {
        const Sample& sample = block.samples[k];
        ShadeQuery query = query_of(frame, pass, block, k, first_set);
        query.has_shadows = frame.plan.lamps[lamp].has_shadows;
        const LampLight light = shade(frame, query, pass.q, frame.lamps.lamps[lamp], k, block);
        add_rgb(layers[kRadiance], sample.index, light.radiance * share);
        add_rgb(layers[kIrradiance], sample.index, light.irradiance * share);
        add_rgb(layers[kFirstLamp + lamp], sample.index, light.radiance * share);
        layers[kSigma].values[sample.index] += light.variance_y * share * share;
        if (frame.bias_layer)
            layers[*frame.bias_layer].values[sample.index] +=
                block.sums.bias_bound_rel * shared::luminance709(light.radiance) * share;
        // The same coefficients err alike in all lamps and samples that show them: added as they
        // are, an upper bound where files differ.
        if (frame.measured_layer)
            layers[*frame.measured_layer].values[sample.index] += light.sigma_measured_y * share;
    }
}

void render_block(const Frame& frame,
                  const Pass& pass,
                  glm::ivec2 first,
                  glm::ivec2 last,
                  Block& block,
                  TileReport& report) {
    for (int stratum = 0; stratum < frame.strata * frame.strata; ++stratum) {
        Lap lap;
        trace_camera(frame, pass, first, last, stratum, block);
        report.camera_rays += static_cast<std::uint64_t>((last.x - first.x) * (last.y - first.y));
        report.camera_s += lap.time_s();
        if (block.hits.empty())
            continue;
        if (frame.sky != nullptr) {
            shade_sky_block(frame, pass, stratum, block);
            report.sky_s += lap.time_s();
        }
        for (std::size_t lamp = 0; lamp < frame.lamps.lamps.size(); ++lamp) {
            if (!frame.plan.lamps[lamp].is_lit)
                continue;
            if (needs_sums(frame)) {
                sum_light(frame.lamps.lamps[lamp], pass.q, block.hits, block.sums);
                report.multiply_adds += block.sums.multiply_adds;
                report.sums_s += lap.time_s();
            }
            shade_block(frame, pass, stratum, lamp, block);
            report.shading_s += lap.time_s();
        }
    }
}

}  // namespace

void add_rgb(Layer& layer, std::size_t pixel, glm::vec3 value) {
    for (std::size_t c = 0; c < 3; ++c)
        layer.values[3 * pixel + c] += value[static_cast<int>(c)];
}

ShadeQuery query_of(const Frame& frame,
                    const Pass& pass,
                    const Block& block,
                    std::size_t k,
                    std::uint32_t first_set) {
    const Sample& sample = block.samples[k];
    return {block.hits[k],
            -sample.direction,
            *sample.brdf,
            sample.frame,
            sets_of(frame.options, pass.samples),
            glm::uvec2(sample.pixel),
            first_set,
            frame.options.seed,
            frame.options.shift,
            true};
}

void render_tile(const Frame& frame, const Pass& pass, glm::ivec2 first, TileReport& report) {
    const glm::ivec2 last = glm::min(first + kTilePx, frame.picture.size_px);
    Block block;
    for (int y = first.y; y < last.y; y += kBlockPx)
        for (int x = first.x; x < last.x; x += kBlockPx)
            render_block(frame, pass, {x, y}, glm::min(glm::ivec2(x, y) + kBlockPx, last), block,
                         report);
    report.shadow_rays += block.scratch.shadow_rays;
    report.sky_samples += block.scratch.sky_samples;
    report.shadow_rays_s += block.scratch.shadow_rays_s;
    report.gloss_s += block.scratch.gloss_s;
}

float root_of_variance(const RenderOptions& options, const TileWeight& weight) {
    const SampleSets sets = sets_of(options, kMostSets * options.samples_per_pixel);
    // Passes of unequal weight count as so many of equal ones.
    const float passes = weight.sum * weight.sum / weight.squares;
    return static_cast<float>(
        unbiased_root((sets.sets - 1) * options.samples_per_pixel * static_cast<double>(passes)));
}

void finish_tile(const Frame& frame, glm::ivec2 first, const TileWeight& weight) {
    const glm::ivec2 last = glm::min(first + kTilePx, frame.picture.size_px);
    const float root = root_of_variance(frame.options, weight);
    for (std::size_t l = 0; l < frame.picture.layers.size(); ++l) {
        if (l == kAlbedo || l == kDepth || l == kNormal)
            continue;
        Layer& layer = frame.picture.layers[l];
        const std::size_t channels = layer.channels.size();
        for (int y = first.y; y < last.y; ++y)
            for (std::size_t i = index_of(frame, {first.x, y}) * channels;
                 i < index_of(frame, {last.x, y}) * channels; ++i)
                layer.values[i] =
                    (l == kSigma ? root * std::sqrt(layer.values[i]) : layer.values[i]) /
                    weight.sum;
    }
}

}  // namespace nearfield::render
