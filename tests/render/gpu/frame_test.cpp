// SPDX-License-Identifier: Apache-2.0
// A whole frame of two lamps in color, lit by OpenGL and by the CPU: the same surfaces, read back
// from the G-buffer, and each device's own.
#include "formats/model/profile.h"
#include "render/cpu/render.h"
#include "render/cpu/shade.h"
#include "render/film.h"
#include "render/gpu/passes.h"
#include "render/gpu/render.h"
#include "render/gpu/storage.h"
#include "render/materials.h"
#include "tests/render/gpu/comparisons.h"
#include "tests/render/gpu/gl_fixture.h"
#include "tests/render/scenes.h"
#include "tests/support/lamps.h"

#include <glm/gtc/matrix_transform.hpp>

#include <optional>

namespace nearfield::render::gpu {
namespace {

using model::Sampler;
using test::layer;
using test::share_within;

constexpr glm::ivec2 kSizePx(256, 192);
constexpr int kSamples = 16;

/// Floor and post in the light of an uneven lamp and of one with radiance weighting, mirrored and
/// twice as large.
Scene two_lamp_scene() {
    support::LampShape shape;
    shape.channels = 3;
    shape.decades = 1;
    const auto lamp = [&](const char* basis, Weighting weighting, std::uint64_t seed) {
        LightField made;
        made.slabs = {support::random_lamp(model::make_profile(basis), weighting, seed, shape)};
        return made;
    };
    Scene scene = test::uneven_scene();
    scene.materials = {{"ochre", {0.7F, 0.5F, 0.3F}, 0.0F, 1.0F}};
    const glm::dmat4 mirrored = test::pose({0.9, 0.4, 1.5}, {-0.4, -0.1, -1.0}) *
                                glm::scale(glm::dmat4(1.0), {-2.0, 2.0, 2.0});
    scene.luminaires = {
        test::write_lamp(lamp("bspline", Weighting::Irradiance, 7), "first",
                         test::pose({-0.8, 0.5, 0.9}, {0.8, -0.3, -0.8})),
        test::write_lamp(lamp("bilinear", Weighting::Radiance, 8), "second", mirrored)};
    scene.cameras = {test::camera_at({0.3, -2.6, 2.0}, {-0.3, 2.6, -2.0}, {0, 0, 1}, 0.9)};
    return scene;
}

RenderOptions options_of(std::optional<Sampler> sampler) {
    RenderOptions options;
    options.size_px = kSizePx;
    options.sampler = sampler;
    options.samples = kSamples;
    options.effects.shadows = Switch::Off;
    return options;
}

/// What the G-buffer holds, as the CPU's renderer knows it: [pixel], nothing where nothing is seen.
std::vector<std::optional<Hit>> read_hits(const Surfaces& surfaces) {
    const std::vector<float> position = read_back(surfaces.position, surfaces.size_px, 4);
    const std::vector<float> normal = read_back(surfaces.normal, surfaces.size_px, 4);
    std::vector<std::optional<Hit>> hits(position.size() / 4);
    for (std::size_t k = 0; k < hits.size(); ++k) {
        if (position[4 * k + 3] == 0.0F)
            continue;
        Hit hit;
        hit.position_world_m = {position[4 * k], position[4 * k + 1], position[4 * k + 2]};
        hit.shading_normal = {normal[4 * k], normal[4 * k + 1], normal[4 * k + 2]};
        hit.geometric_normal = hit.shading_normal;
        hits[k] = hit;
    }
    return hits;
}

struct LitFrame {
    Picture picture;  // radiance and irradiance by OpenGL
    std::vector<std::optional<Hit>> hits;
};

LitFrame light_by_gl(Device& device, const Scene& scene, const RenderOptions& options) {
    RenderReport report;
    const Opening opening = open_scene(scene, options, render::Device::Gl, report);
    SceneBuffers buffers = upload_scene(device, scene);
    buffers.materials = upload_materials(device, {planned_brdf(scene.materials[0], report.plan)});
    SurfacePass surfaces = make_surface_pass(device, buffers, opening.size_px);
    LampsOnCard on_card;
    upload_lamps(device, opening.lamps, report.plan, options, on_card);
    LightPasses passes = make_light_passes(device, report.plan, options, false);
    Film film = make_film(device, opening.size_px, opening.lamps.lamps.size(), false);
    GlFrame frame{scene,   options,  opening, report.plan, device,
                  buffers, surfaces, on_card, passes,      film};
    SampleQuery query;
    query.size_px = opening.size_px;
    query.sets = sets_of(options, options.samples);
    query.seed = options.seed;
    add_pass(frame, glm::dvec2(0.5), query, 0, 1.0F);
    LitFrame lit{make_picture(opening.lamps, opening.size_px, {}), {}};
    read_film(film, 1.0F, lit.picture);
    lit.hits = read_hits(surfaces.surfaces);
    return lit;
}

/// One lamp at one pixel, by the CPU's own functions.
LampLight light_of_pixel(const Lamp& lamp,
                         const Tracer& tracer,
                         const ShadeQuery& query,
                         const RenderOptions& options,
                         Scratch& scratch) {
    if (options.sampler) {
        model::SamplerOptions sampler;
        sampler.sampler = *options.sampler;
        sampler.sequence = model::default_sequence(*options.sampler);
        return shade_sampled(lamp, tracer, query, sampler, nullptr, 0, scratch);
    }
    LightSums sums;
    sum_light(lamp, 0, {&query.hit, 1}, sums);
    return shade_diffuse(lamp, tracer, query, sums, 0, scratch);
}

Picture light_by_cpu(const Scene& scene,
                     const RenderOptions& options,
                     const std::vector<std::optional<Hit>>& hits) {
    RenderReport report;
    const Opening opening = open_scene(scene, options, render::Device::Gl, report);
    const Tracer tracer(Scene{}, {}, 1);
    const shared::Brdf brdf = planned_brdf(scene.materials[0], report.plan);
    const glm::dvec3 eye_m(opening.camera.world_from_camera[3]);
    Picture picture = make_picture(opening.lamps, opening.size_px, {});
    Scratch scratch;
    for (std::size_t k = 0; k < hits.size(); ++k)
        for (std::size_t lamp = 0; hits[k] && lamp < opening.lamps.lamps.size(); ++lamp) {
            const auto width = static_cast<std::size_t>(opening.size_px.x);
            const ShadeQuery query{*hits[k],
                                   glm::normalize(eye_m - hits[k]->position_world_m),
                                   brdf,
                                   shared::frame_from_normal(glm::vec3(hits[k]->shading_normal)),
                                   sets_of(options, options.samples),
                                   {k % width, k / width},
                                   static_cast<std::uint32_t>(lamp * kMostSets),
                                   options.seed,
                                   options.shift,
                                   false};
            const LampLight light =
                light_of_pixel(opening.lamps.lamps[lamp], tracer, query, options, scratch);
            for (std::size_t c = 0; c < 3; ++c) {
                const int channel = static_cast<int>(c);
                picture.layers[kRadiance].values[3 * k + c] += light.radiance[channel];
                picture.layers[kIrradiance].values[3 * k + c] += light.irradiance[channel];
            }
        }
    return picture;
}

class GlFrameTest : public GlTest {};

TEST_F(GlFrameTest, SumIsTheCpusAtEveryPixelOfOneGBuffer) {
    const Scene scene = two_lamp_scene();
    const RenderOptions options = options_of(std::nullopt);
    const LitFrame gl = light_by_gl(device(), scene, options);
    const Picture cpu = light_by_cpu(scene, options, gl.hits);
    test::expect_light(gl.picture);
    for (const char* name : {"", "irradiance"})
        EXPECT_EQ(share_within(layer(gl.picture, name), layer(cpu, name), 1e-4, 20000), 1.0)
            << name;
}

TEST_F(GlFrameTest, SamplesAreTheCpusAtNearlyEveryPixelOfOneGBuffer) {
    const Scene scene = two_lamp_scene();
    for (const Sampler sampler : {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                  Sampler::Systematic, Sampler::Cells}) {
        const RenderOptions options = options_of(sampler);
        const LitFrame gl = light_by_gl(device(), scene, options);
        const Picture cpu = light_by_cpu(scene, options, gl.hits);
        test::expect_light(gl.picture);
        const double share = share_within(layer(gl.picture, ""), layer(cpu, ""), 1e-3, 5000);
        EXPECT_GE(share, 0.999) << model::name_of(sampler);
        RecordProperty(model::name_of(sampler), std::to_string(share));
    }
}

// Pixels at triangles' borders see different ones now and then.
TEST(GlFrame, OwnSurfacesGiveTheSameLight) {
    const Scene scene = two_lamp_scene();
    for (const std::optional<Sampler> sampler :
         {std::optional<Sampler>(), std::optional(Sampler::Systematic)}) {
        const RenderOptions options = options_of(sampler);
        const Rendered gl = render_gl(scene, options), cpu = render_cpu(scene, options);
        const double share =
            share_within(layer(gl.picture, ""), layer(cpu.picture, ""), 1e-3, 20000);
        EXPECT_GE(share, 0.995);
        RecordProperty(sampler ? "systematic" : "sum", std::to_string(share));
    }
}

}  // namespace
}  // namespace nearfield::render::gpu
