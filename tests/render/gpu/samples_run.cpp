// SPDX-License-Identifier: Apache-2.0
#include "tests/render/gpu/samples_run.h"

#include "render/cpu/shade.h"
#include "render/gpu/scene_buffers.h"
#include "render/gpu/storage.h"
#include "tests/support/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace nearfield::render::gpu {
namespace {

double luminance(glm::dvec3 rgb) {
    return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

// The lamp as the CPU's renderer has it.
Lamp lamp_of(const SamplesCase& samples) {
    auto file = std::make_shared<LoadedLightField>();
    for (const TestSlab& slab : samples.slabs)
        file->sampling.push_back(slab.sampling);
    Lamp lamp;
    lamp.dim = samples.query.dim;
    for (std::size_t k = 0; k < samples.slabs.size(); ++k) {
        PlacedSlab slab;
        slab.prepared = &file->sampling[k].prepared;
        slab.slab_from_world = samples.slabs[k].placement.slab_from_world;
        slab.world_from_slab = samples.slabs[k].placement.world_from_slab;
        slab.slab_from_world_rotation = samples.slabs[k].placement.slab_from_world_rotation;
        lamp.slabs.push_back(slab);
    }
    lamp.file = file;
    return lamp;
}

Hit hit_of(const SurfacePoint& point) {
    Hit hit;
    hit.position_world_m = glm::dvec3(point.position_world_m);
    hit.geometric_normal = hit.shading_normal = glm::dvec3(point.normal);
    return hit;
}

double relative_difference(glm::vec3 found, glm::vec3 expected) {
    const glm::dvec3 gap = glm::abs(glm::dvec3(found) - glm::dvec3(expected));
    return std::max({gap.r, gap.g, gap.b}) /
           static_cast<double>(std::max({expected.r, expected.g, expected.b}));
}

bool is_light(const PixelLight& light) {
    const auto is_valid = [](float x) { return std::isfinite(x) && x >= 0.0F; };
    for (int c = 0; c < 3; ++c)
        if (!is_valid(light.radiance[c]) || !is_valid(light.irradiance[c]))
            return false;
    return is_valid(light.variance_y);
}

}  // namespace

TestSlab make_test_slab(Slab slab, const glm::dmat4& world_from_slab) {
    TestSlab made;
    made.placement.world_from_slab = world_from_slab;
    made.placement.slab_from_world = glm::inverse(world_from_slab);
    const glm::dmat3 turn(made.placement.slab_from_world);
    made.placement.slab_from_world_rotation = turn / std::cbrt(std::abs(glm::determinant(turn)));
    made.sampling = model::prepare_sampling(std::move(slab));
    return made;
}

shared::Brdf lambert() {
    shared::Brdf brdf{};
    brdf.kind = shared::kBrdfPhong;
    brdf.diffuse = {0.8F, 0.5F, 0.3F};
    return brdf;
}

std::vector<SurfacePoint> lit_points(const Slab& slab, glm::ivec2 size_px, std::uint64_t seed) {
    support::Random random{seed};
    const glm::dvec2 u_half = 0.5 * glm::dvec2(slab.grid) * slab.pitch_m;
    std::vector<SurfacePoint> points;
    for (int k = 0; k < size_px.x * size_px.y; ++k) {
        const double height_m = slab.delta_m * 0.05 * std::pow(600.0, random.uniform());
        const glm::dvec2 u = slab.u_center_m + glm::dvec2(random.uniform(-u_half.x, u_half.x),
                                                          random.uniform(-u_half.y, u_half.y));
        const glm::dvec2 s(random.uniform(slab.s_min_m.x, slab.s_max_m.x),
                           random.uniform(slab.s_min_m.y, slab.s_max_m.y));
        const glm::dvec2 p = u + (s - u) * ((slab.delta_m + height_m) / slab.delta_m);
        const double cosine = random.uniform(0.5, 1.0),
                     around = random.uniform(0.0, 2.0 * std::numbers::pi);
        const double sine = std::sqrt(1.0 - cosine * cosine);
        SurfacePoint point;
        point.position_world_m = glm::vec3(glm::dvec3(p, height_m));
        point.normal =
            glm::vec3(glm::dvec3(sine * std::cos(around), sine * std::sin(around), -cosine));
        point.material = 0;
        points.push_back(point);
    }
    return points;
}

std::vector<PixelLight> light_by_gl(Device& device, const SamplesCase& samples) {
    LightSamples drawing = make_light_samples(device, samples.needs);
    return light_by_gl(device, drawing, samples);
}

std::vector<PixelLight> light_by_gl(Device& device,
                                    LightSamples& drawing,
                                    const SamplesCase& samples) {
    const SampleNeeds& needs = samples.needs;
    SlabNeeds slab_needs;
    slab_needs.tables = true;
    slab_needs.cdfs =
        needs.sampler == model::Sampler::Precomputed || needs.sampler == model::Sampler::Pdis;
    slab_needs.has_color = needs.has_color;
    std::vector<SlabTextures> textures;
    for (const TestSlab& slab : samples.slabs)
        textures.push_back(upload_slab(device, slab.sampling.prepared.slab,
                                       slab.sampling.prepared.lit, &slab.sampling.tables,
                                       slab_needs, slab.placement));
    std::vector<SampledSlab> slabs;
    for (std::size_t k = 0; k < textures.size(); ++k)
        slabs.push_back({&textures[k], &samples.slabs[k].sampling.prepared.slab, {}});
    const Surfaces surfaces = upload_surfaces(device, samples.size_px, samples.points,
                                              glm::dvec3(samples.eye_m), needs.has_tangents);
    const Buffer materials = upload_materials(device, {samples.brdf});
    const std::array<Texture, 2> added = {
        make_texture(device, "light", GL_RGBA32F, samples.size_px),
        make_texture(device, "irradiance", GL_RGBA32F, samples.size_px)};
    for (GLuint unit = 0; unit < 2; ++unit) {
        glClearTexImage(added[unit].id(), 0, GL_RGBA, GL_FLOAT, nullptr);
        glBindImageTexture(unit, added[unit].id(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32F);
    }
    drawing.most_energies = samples.most_energies;
    bind_surfaces(surfaces, materials);
    add_light_samples(device, drawing, slabs, samples.query);
    device.check("samples");
    const std::vector<float> light = read_back(added[0], samples.size_px, 4);
    const std::vector<float> irradiance = read_back(added[1], samples.size_px, 4);
    std::vector<PixelLight> pixels;
    for (std::size_t k = 0; k < light.size(); k += 4)
        pixels.push_back({{light[k], light[k + 1], light[k + 2]},
                          {irradiance[k], irradiance[k + 1], irradiance[k + 2]},
                          light[k + 3]});
    return pixels;
}

std::vector<PixelLight> light_by_cpu(const SamplesCase& samples) {
    const Lamp lamp = lamp_of(samples);
    const Tracer tracer(Scene{}, {}, 1);
    const SampleQuery& query = samples.query;
    model::SamplerOptions options;
    options.sampler = samples.needs.sampler;
    options.sequence = samples.needs.sequence;
    options.k_max = query.k_max;
    Scratch scratch;
    std::vector<PixelLight> pixels;
    for (std::size_t k = 0; k < samples.points.size(); ++k) {
        const SurfacePoint& point = samples.points[k];
        const Hit hit = hit_of(point);
        const auto width = static_cast<std::size_t>(samples.size_px.x);
        const ShadeQuery shade{hit,
                               glm::normalize(glm::dvec3(samples.eye_m) - hit.position_world_m),
                               samples.brdf,
                               shared::frame_from_normal(point.normal),
                               query.sets,
                               {k % width, k / width},
                               query.first_set,
                               query.seed,
                               samples.needs.shift,
                               false};
        const LampLight light = shade_sampled(lamp, tracer, shade, options, nullptr, 0, scratch);
        pixels.push_back({light.radiance, light.irradiance, light.variance_y});
    }
    return pixels;
}

Difference difference(std::span<const PixelLight> found, std::span<const PixelLight> expected) {
    double brightest = 0.0;
    for (const PixelLight& light : expected)
        brightest = std::max(brightest, luminance(glm::dvec3(light.irradiance)));
    Difference result;
    std::vector<double> relative;
    for (std::size_t k = 0; k < expected.size(); ++k) {
        result.is_finite = result.is_finite && is_light(found[k]);
        if (!(luminance(glm::dvec3(expected[k].irradiance)) > 1e-3 * brightest))
            continue;
        const double of_pixel =
            std::max(relative_difference(found[k].irradiance, expected[k].irradiance),
                     relative_difference(found[k].radiance, expected[k].radiance));
        relative.push_back(of_pixel);
        if (of_pixel > 1e-3) {
            ++result.different;
            continue;
        }
        const auto mean = luminance(glm::dvec3(expected[k].radiance));
        // A variance of rounding alone counts as none.
        const double scale =
            std::max(static_cast<double>(expected[k].variance_y), 1e-4 * mean * mean);
        result.worst_variance = std::max(
            result.worst_variance,
            std::abs(static_cast<double>(found[k].variance_y - expected[k].variance_y)) / scale);
    }
    std::sort(relative.begin(), relative.end());
    result.pixels = relative.size();
    if (!relative.empty()) {
        result.median = relative[relative.size() / 2];
        result.worst = relative.back();
    }
    return result;
}

}  // namespace nearfield::render::gpu
