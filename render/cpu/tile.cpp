// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/tile.h"

#include "formats/files/provenance.h"
#include "formats/shared/rng.glsl.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

// Light sums run over the hits of so many pixels together: their windows overlap, and what they
// read of an image, 16 receivers' weights included, stays in the first-level cache.
constexpr int kBlockPx = 4;

/// The middle of one of n x n strata of a pixel, moved within it at random if n > 1. Pixel (x, y)
/// spans x ... x + 1.
glm::dvec2 film_position_px(
    glm::ivec2 pixel, int stratum, int n, std::uint32_t random_x, std::uint32_t random_y) {
    const glm::dvec2 jitter =
        n == 1 ? glm::dvec2(0.5)
               : glm::dvec2(shared::unit_float(random_x), shared::unit_float(random_y));
    return glm::dvec2(pixel) +
           (glm::dvec2(stratum % n, stratum / n) + jitter) / static_cast<double>(n);
}

glm::dvec3 camera_ray(const Camera& camera, glm::ivec2 size_px, glm::dvec2 position_px) {
    const double tan_half = std::tan(0.5 * camera.yfov_rad);
    const double px =
        2.0 * tan_half / static_cast<double>(size_px.y);  // square pixels at distance 1
    const glm::dvec3 direction((position_px.x - 0.5 * size_px.x) * px,
                               (0.5 * size_px.y - position_px.y) * px, -1.0);
    // Cameras of scenes made elsewhere may carry a scale; directions do not.
    return glm::normalize(glm::dmat3(camera.world_from_camera) * direction);
}

void add(Layer& layer, std::size_t pixel, glm::vec3 value) {
    for (std::size_t c = 0; c < 3; ++c)
        layer.values[3 * pixel + c] += value[static_cast<int>(c)];
}

/// A camera ray that met something.
struct Sample {
    std::size_t pixel = 0;  // index in the picture
    std::uint32_t key = 0;  // of its random numbers
    glm::dvec3 direction{0.0};
    Reflectance reflectance;
};

/// What a block's steps hand each other; kept from block to block for its memory.
struct Block {
    std::vector<Sample> samples;
    std::vector<Hit> hits;  // [sample]
    LightSums sums;
    Scratch scratch;
    // Variance of radiance Y, [sample], and sigma_measured's, lamps of one file next to each other.
    std::vector<float> variance, measured;
};

/// One camera ray a pixel, and the layers that need no light.
void trace_camera(
    const Frame& frame, glm::ivec2 first, glm::ivec2 last, int stratum, Block& block) {
    const int samples = frame.strata * frame.strata;
    std::vector<Layer>& layers = frame.picture.layers;
    const glm::dvec3 origin(frame.camera.world_from_camera[3]);
    const glm::dvec3 forward = -glm::normalize(glm::dvec3(frame.camera.world_from_camera[2]));
    block.samples.clear();
    block.hits.clear();
    for (int y = first.y; y < last.y; ++y)
        for (int x = first.x; x < last.x; ++x) {
            Sample sample;
            sample.pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.picture.size_px.x) +
                static_cast<std::size_t>(x);
            sample.key =
                static_cast<std::uint32_t>(sample.pixel) * static_cast<std::uint32_t>(samples) +
                static_cast<std::uint32_t>(stratum);
            const glm::uvec4 random = shared::hash4({sample.key, ~0U, frame.options.seed, 0U});
            sample.direction =
                camera_ray(frame.camera, frame.picture.size_px,
                           film_position_px({x, y}, stratum, frame.strata, random.x, random.y));
            const std::optional<Hit> hit = frame.tracer.trace(origin, sample.direction);
            if (!hit)
                continue;
            sample.reflectance = frame.reflectances[static_cast<std::size_t>(hit->material)];
            add(layers[kAlbedo], sample.pixel,
                sample.reflectance.diffuse * (1.0F / static_cast<float>(samples)));
            if (stratum == samples / 2) {  // depths and normals have no meaningful mean
                layers[kDepth].values[sample.pixel] =
                    static_cast<float>(glm::dot(hit->position_world_m - origin, forward));
                add(layers[kNormal], sample.pixel, glm::vec3(hit->shading_normal));
            }
            block.samples.push_back(sample);
            block.hits.push_back(*hit);
        }
}

/// Adds one lamp's light to the layers, from sums that are ready.
void shade_block(const Frame& frame, std::size_t lamp, Block& block) {
    const int samples = frame.strata * frame.strata;
    const float share = 1.0F / static_cast<float>(samples);
    // Samples of one pixel share the pixel's visibility samples; 8 keep the ratio's bias small.
    const int visibility_samples = std::max(frame.options.visibility_samples / samples,
                                            std::min(8, frame.options.visibility_samples));
    std::vector<Layer>& layers = frame.picture.layers;
    for (std::size_t k = 0; k < block.samples.size(); ++k) {
        const Sample& sample = block.samples[k];
        const ShadeQuery query{block.hits[k],      -sample.direction,
                               sample.reflectance, {sample.key, static_cast<std::uint32_t>(lamp)},
                               frame.options.seed, visibility_samples};
        const LampLight light =
            shade(frame.lamps.lamps[lamp], frame.tracer, query, block.sums, k, block.scratch);
        add(layers[kRadiance], sample.pixel, light.radiance * share);
        add(layers[kIrradiance], sample.pixel, light.irradiance * share);
        add(layers[kFirstLamp + lamp], sample.pixel, light.radiance * share);
        block.variance[k] += light.sigma_y * light.sigma_y * share * share;
        // The same coefficients err alike in all lamps and samples that show them: added as they
        // are, an upper bound where files differ.
        block.measured[k] += light.sigma_measured_y * share;
    }
}

void render_block(
    const Frame& frame, glm::ivec2 first, glm::ivec2 last, Block& block, TileReport& report) {
    std::vector<Layer>& layers = frame.picture.layers;
    for (int stratum = 0; stratum < frame.strata * frame.strata; ++stratum) {
        double at_s = now_s();
        const auto spent = [&at_s](double& total_s) {
            const double before_s = at_s;
            at_s = now_s();
            total_s += at_s - before_s;
        };
        trace_camera(frame, first, last, stratum, block);
        report.camera_rays += static_cast<std::uint64_t>((last.x - first.x) * (last.y - first.y));
        spent(report.camera_s);
        if (block.hits.empty())
            continue;
        block.variance.assign(block.samples.size(), 0.0F);
        block.measured.assign(block.samples.size(), 0.0F);
        for (std::size_t lamp = 0; lamp < frame.lamps.lamps.size(); ++lamp) {
            sum_light(frame.lamps.lamps[lamp], block.hits, block.sums);
            report.multiply_adds += block.sums.multiply_adds;
            spent(report.sums_s);
            shade_block(frame, lamp, block);
            spent(report.visibility_s);
        }
        const std::size_t measured_layer = kFirstLamp + frame.lamps.lamps.size();
        for (std::size_t k = 0; k < block.samples.size(); ++k) {
            layers[kSigma].values[block.samples[k].pixel] += block.variance[k];
            if (measured_layer < layers.size())
                layers[measured_layer].values[block.samples[k].pixel] += block.measured[k];
        }
    }
}

}  // namespace

void render_tile(const Frame& frame, glm::ivec2 first, TileReport& report) {
    const glm::ivec2 last = glm::min(first + kTilePx, frame.picture.size_px);
    Block block;
    for (int y = first.y; y < last.y; y += kBlockPx)
        for (int x = first.x; x < last.x; x += kBlockPx)
            render_block(frame, {x, y}, glm::min(glm::ivec2(x, y) + kBlockPx, last), block, report);
    report.shadow_rays += block.scratch.shadow_rays;

    // Variances have been summed; the layer holds their roots.
    for (int y = first.y; y < last.y; ++y)
        for (int x = first.x; x < last.x; ++x) {
            float& sigma = frame.picture.layers[kSigma]
                               .values[static_cast<std::size_t>(y * frame.picture.size_px.x + x)];
            sigma = std::sqrt(sigma);
        }
}

}  // namespace nearfield::render
