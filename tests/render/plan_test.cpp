// SPDX-License-Identifier: Apache-2.0
#include "formats/files/luminaire.h"
#include "formats/model/luminaire.h"
#include "formats/model/tables.h"
#include "render/cpu/render.h"
#include "render/cpu/shade.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>

namespace nearfield::render {
namespace {

using test::add_blocker;
using test::difference;
using test::floor_scene;
using test::layer;
using test::plain_scene;
using test::pose;
using test::small;
using test::uneven_scene;

Rendered render_forced(const Scene& scene, Switch Effects::*effect, Switch wanted) {
    RenderOptions options = small();
    options.effects.*effect = wanted;
    return render_cpu(scene, options);
}

/// Of the picture's light and sigma.
double change(const Rendered& a, const Rendered& b) {
    return std::max(difference(layer(a.picture, ""), layer(b.picture, "")),
                    difference(layer(a.picture, "irradiance"), layer(b.picture, "irradiance")));
}

double bytes(const Rendered& rendered, PassId id) {
    for (const PassReport& cost : rendered.report.costs)
        if (cost.id == id)
            return cost.bytes;
    return 0.0;
}

bool has_cost(const Rendered& rendered, PassId id) {
    return std::any_of(rendered.report.costs.begin(), rendered.report.costs.end(),
                       [&](const PassReport& cost) { return cost.id == id; });
}

// Float sums in another order, and their conversion through double.
constexpr double kRounding = 1e-6;

// Proves that shadows cost no ray and no sample where nothing can throw one, that forcing them
// changes nothing there, and that they matter where something does.
TEST(Plan, ShadowsOnlyWhereCalledFor) {
    const Rendered plain = render_cpu(plain_scene(), small());
    EXPECT_FALSE(has_pass(plain.report.plan, PassId::ShadowRays));
    EXPECT_FALSE(has_cost(plain, PassId::ShadowRays));
    EXPECT_FALSE(has_pass(plain.report.plan, PassId::Samples));
    EXPECT_EQ(plain.report.shadow_rays, 0U);
    EXPECT_EQ(plain.report.samples, 0.0);
    EXPECT_EQ(plain.report.sampling.mean_rel, 0.0);
    for (const float sigma : layer(plain.picture, "sigma").values)
        EXPECT_EQ(sigma, 0.0F);
    const Rendered forced = render_forced(plain_scene(), &Effects::shadows, Switch::On);
    EXPECT_TRUE(has_pass(forced.report.plan, PassId::ShadowRays));
    EXPECT_GT(forced.report.shadow_rays, 0U);
    EXPECT_LT(change(plain, forced), kRounding);

    Scene with_post = plain_scene();
    add_blocker(with_post, "post", {0.5, 0.2, 0.5}, {0.3, 0.3});
    const Rendered shadowed = render_cpu(with_post, small());
    EXPECT_TRUE(has_cost(shadowed, PassId::ShadowRays));
    EXPECT_GT(shadowed.report.shadow_rays, 0U);
    const Rendered without = render_forced(with_post, &Effects::shadows, Switch::Off);
    EXPECT_EQ(without.report.shadow_rays, 0U);
    EXPECT_GT(change(without, shadowed), 0.1);
}

// Proves that without shadows not even a point on the lamp is drawn, and that the light is what it
// is with them.
TEST(Plan, WithoutShadowsNoPointIsDrawn) {
    const Scene scene = plain_scene();
    const Lamps lamps = load_lamps(scene);
    const Tracer tracer(scene, lamps.instance_masks, 1);
    const std::optional<Hit> hit = tracer.trace({0.1, 0, 0.5}, {0, 0, -1});
    ASSERT_TRUE(hit.has_value());
    const shared::Brdf gray = brdf(scene.materials[0]);
    LightSums sums;
    sum_light(lamps.lamps[0], 0, {&*hit, 1}, sums);
    glm::vec3 irradiance(0.0F);
    for (const bool has_shadows : {false, true}) {
        const ShadeQuery query{*hit,
                               {0, 0, 1},
                               gray,
                               shared::frame_from_normal({0, 0, 1}),
                               make_sets(64, 1),
                               {0, 0},
                               0,
                               1,
                               model::Shift::Random,
                               has_shadows};
        Scratch scratch;
        const LampLight light = shade_diffuse(lamps.lamps[0], tracer, query, sums, 0, scratch);
        EXPECT_EQ(scratch.points.size(), has_shadows ? 64U : 0U);
        EXPECT_EQ(scratch.shadow_rays, has_shadows ? 64U : 0U);
        EXPECT_EQ(light.variance_y, 0.0F);
        EXPECT_GT(light.irradiance.y, 0.0F);
        EXPECT_TRUE(!has_shadows || light.irradiance == irradiance);
        irradiance = light.irradiance;
    }
}

// Proves the same of samplers that draw all light: the samples stay, the rays go.
TEST(Plan, SamplersDrawWithoutRaysWhereNothingThrowsShadows) {
    RenderOptions options = small();
    options.sampler = model::Sampler::Systematic;
    Scene scene = uneven_scene();
    scene.instances.resize(1);  // the floor
    scene.luminaires[0].excludes = {};
    const Rendered plain = render_cpu(scene, options);
    EXPECT_EQ(plain.report.shadow_rays, 0U);
    EXPECT_GT(plain.report.samples, 0.0);
    EXPECT_GT(plain.report.sampling.mean_rel, 0.0);
    options.effects.shadows = Switch::On;
    const Rendered forced = render_cpu(scene, options);
    EXPECT_GT(forced.report.shadow_rays, 0U);
    EXPECT_LT(change(plain, forced), kRounding);
}

// Proves that gloss reads no tables and reflects nothing where no material has a lobe.
TEST(Plan, GlossOnlyWhereCalledFor) {
    const Rendered plain = render_cpu(plain_scene(), small());
    EXPECT_FALSE(has_pass(plain.report.plan, PassId::Gloss));
    EXPECT_EQ(bytes(plain, PassId::Gloss), 0.0);
    const Rendered forced = render_forced(plain_scene(), &Effects::gloss, Switch::On);
    EXPECT_TRUE(has_pass(forced.report.plan, PassId::Gloss));
    EXPECT_GT(bytes(forced, PassId::Gloss), 0.0);
    EXPECT_LT(change(plain, forced), kRounding);

    Scene glossy = plain_scene();
    glossy.materials[0].metallic = 0.6F;
    glossy.materials[0].roughness = 0.5F;
    const Rendered with = render_cpu(glossy, small());
    EXPECT_GT(bytes(with, PassId::Gloss), 0.0);
    const Rendered without = render_forced(glossy, &Effects::gloss, Switch::Off);
    EXPECT_EQ(bytes(without, PassId::Gloss), 0.0);
    EXPECT_GT(difference(layer(with.picture, ""), layer(without.picture, "")), 0.01);
    // What is left is Lambert's part.
    for (std::size_t i = 0; i < layer(without.picture, "").values.size(); ++i)
        EXPECT_NEAR(layer(without.picture, "").values[i],
                    layer(without.picture, "irradiance").values[i] *
                        layer(without.picture, "albedo").values[i] / 3.14159265F,
                    1e-6F * layer(without.picture, "irradiance").values[i]);
}

// Proves that one channel is summed where nothing has a color, a third of the work of three, and
// that without color luminance stays: exactly so on gray materials.
TEST(Plan, ColorOnlyWhereCalledFor) {
    const Rendered plain = render_cpu(plain_scene(), small());
    EXPECT_FALSE(plain.report.plan.color.is_in);
    const Rendered forced = render_forced(plain_scene(), &Effects::color, Switch::On);
    EXPECT_TRUE(forced.report.plan.color.is_in);
    EXPECT_EQ(forced.report.multiply_adds, 3.0 * plain.report.multiply_adds);
    EXPECT_GT(bytes(forced, PassId::LightSums), 1.5 * bytes(plain, PassId::LightSums));
    EXPECT_LT(change(plain, forced), kRounding);

    const Rendered colored = render_cpu(uneven_scene(), small());
    EXPECT_TRUE(colored.report.plan.color.is_in);
    const Rendered gray = render_forced(uneven_scene(), &Effects::color, Switch::Off);
    EXPECT_EQ(gray.report.multiply_adds, colored.report.multiply_adds / 3.0);
    const Layer& rgb = layer(colored.picture, "irradiance");
    const Layer& y = layer(gray.picture, "irradiance");
    float largest = 0.0F;
    for (const float value : y.values)
        largest = std::max(largest, value);
    float widest = 0.0F;
    for (std::size_t i = 0; i < rgb.values.size(); i += 3) {
        EXPECT_EQ(y.values[i], y.values[i + 1]);
        EXPECT_EQ(y.values[i], y.values[i + 2]);
        // Shadow samples are weighted by channel, so that penumbrae's noise differs.
        const float rgb_y =
            0.2126F * rgb.values[i] + 0.7152F * rgb.values[i + 1] + 0.0722F * rgb.values[i + 2];
        const bool has_noise = layer(colored.picture, "sigma").values[i / 3] > 0.0F;
        EXPECT_TRUE(has_noise || std::abs(rgb_y - y.values[i]) < 2e-6F * largest) << i;
        widest = std::max(widest, std::abs(rgb.values[i] - rgb.values[i + 2]));
    }
    EXPECT_GT(widest, 0.01F * largest);
}

// Proves that colored materials turn gray too, lobes included.
TEST(Plan, WithoutColorMaterialsAreGray) {
    Scene scene = uneven_scene();
    scene.materials[0] = {"copper", {0.9F, 0.4F, 0.2F}, 0.8F, 0.3F};
    const Rendered gray = render_forced(scene, &Effects::color, Switch::Off);
    const Layer& radiance = layer(gray.picture, "");
    for (std::size_t i = 0; i < radiance.values.size(); i += 3) {
        EXPECT_EQ(radiance.values[i], radiance.values[i + 1]);
        EXPECT_EQ(radiance.values[i], radiance.values[i + 2]);
    }
    EXPECT_GT(*std::max_element(radiance.values.begin(), radiance.values.end()), 0.0F);
}

// Proves that lamps have the channels asked for, in coefficients and in tables, though their file
// holds others, and that their light is the file's.
TEST(Plan, LampsHaveTheChannelsAskedFor) {
    Scene scene = uneven_scene();
    scene.luminaires[0].path = "uneven.luminaire.exr";
    const LightField file = read_lightfield("uneven.lightfield.exr");
    write_luminaire(model::pack(file, false), std::nullopt, scene.luminaires[0].path);
    for (const int channels : {0, 1, 3}) {
        LampParts parts;
        parts.tables = true;
        parts.channels = channels;
        const Lamps lamps = load_lamps(scene, parts);
        const model::SamplingSlab& slab = lamps.lamps[0].file->sampling[0];
        const int expected = channels == 0 ? 3 : channels;
        EXPECT_EQ(lamps.lamps[0].file->file_channels, 3);
        EXPECT_EQ(slab.prepared.slab.channels, expected);
        const MipLevel& mip = slab.tables.mips.front();
        EXPECT_EQ(mip.coeffs.size(),
                  static_cast<std::size_t>(expected * 6 * mip.texels.x * mip.texels.y));
        EXPECT_NEAR(model::flux(slab.prepared.slab).y,
                    channels == 1 ? model::luminance(model::flux(file)) : model::flux(file).y,
                    1e-6 * model::flux(file).y);
    }
}

// Proves that a tone-mapped picture is planned where the caller makes one.
TEST(Plan, ToneMappingOnlyWhereCalledFor) {
    const auto is_planned = [](bool is_displayed, Switch wanted) {
        RenderOptions options = small(4);
        options.is_displayed = is_displayed;
        options.effects.tone_mapping = wanted;
        return has_pass(render_cpu(plain_scene(), options).report.plan, PassId::ToneMapping);
    };
    EXPECT_FALSE(is_planned(false, Switch::Auto));
    EXPECT_TRUE(is_planned(true, Switch::Auto));
    EXPECT_TRUE(is_planned(false, Switch::On));
    EXPECT_FALSE(is_planned(true, Switch::Off));
}

// Proves that a surface whose triangle faces away stays dark without shadow rays too, though its
// interpolated normals lean towards the lamp.
TEST(Plan, TrianglesThatFaceAwayStayDarkWithoutRays) {
    Scene scene = plain_scene();
    scene.meshes[0].normals.assign(4, glm::normalize(glm::vec3(1, 0, 0.1F)));
    scene.luminaires[0].world_from_luminaire = pose({1.5, 0, -0.3}, {-1, 0, 0.05});
    const Rendered planned = render_cpu(scene, small());
    EXPECT_EQ(planned.report.shadow_rays, 0U);
    for (const float value : layer(planned.picture, "").values)
        EXPECT_EQ(value, 0.0F);
    scene.luminaires[0].world_from_luminaire = pose({1.5, 0, 0.3}, {-1, 0, -0.05});
    const Layer above = layer(render_cpu(scene, small()).picture, "");
    EXPECT_GT(*std::max_element(above.values.begin(), above.values.end()), 0.0F);
}

// Proves that a picture without noise ends after one pass, whatever is asked for.
TEST(Plan, WithoutSamplesOnePassIsEnough) {
    RenderOptions options = small();
    options.error_rel = 0.001;
    const Rendered to_error = render_cpu(plain_scene(), options);
    EXPECT_EQ(to_error.report.passes, 1);
    EXPECT_TRUE(to_error.report.is_error_reached);
    options.error_rel = 0.0;
    options.time_s = 1e6;
    const Rendered in_time = render_cpu(plain_scene(), options);
    EXPECT_EQ(in_time.report.passes, 1);
    EXPECT_EQ(in_time.report.q, 0);
    EXPECT_EQ(layer(to_error.picture, "").values, layer(in_time.picture, "").values);
}

// Proves that both devices' plans agree about what the scene calls for, each in its own passes.
TEST(Plan, DevicesShareTheTable) {
    const Scene scene = uneven_scene();
    const Lamps lamps = load_lamps(scene);
    const auto names = [&](Device device, bool is_in) {
        std::string text;
        for (const PlannedPass& pass : plan_of(scene, lamps, {}, {16, 16}, device).passes) {
            EXPECT_FALSE(pass.reason.empty());
            EXPECT_EQ(pass.bytes > 0.0,
                      pass.is_in && pass.id != PassId::ShadowRays && pass.id != PassId::Samples)
                << pass.name;
            text += pass.is_in == is_in ? std::string(pass.name) + ";" : "";
        }
        return text;
    };
    EXPECT_EQ(names(Device::Cpu, true), "camera rays;light sums;samples;shadow rays;");
    EXPECT_EQ(names(Device::Cpu, false),
              "gloss;environment;sky irradiance;sky samples;sky rays;tone mapping;");
    EXPECT_EQ(names(Device::Gl, true), "g-buffer;shadow maps;light sums;accumulate;");
    EXPECT_EQ(
        names(Device::Gl, false),
        "box energies;samples;gloss;environment;sky maps;sky irradiance;sky samples;tone mapping;");
}

// Proves that the explanation has a line for each pass and lamp, in or out, with its reason, and
// times for those that are in.
TEST(Plan, ExplanationNamesEveryPassAndLamp) {
    Scene scene = plain_scene();
    scene.luminaires.push_back(scene.luminaires[0]);
    scene.luminaires[1].name = "spare";
    scene.luminaires[1].on = false;
    const std::string text = explain(render_cpu(scene, small()).report);
    const auto line_of = [&](const std::string& name) {
        const std::size_t at = ("\n" + text).find("\n" + name + " ");
        return at == std::string::npos ? "no " + name : text.substr(at, text.find('\n', at) - at);
    };
    EXPECT_NE(line_of("camera rays").find(" ms "), std::string::npos) << text;
    EXPECT_NE(line_of("light sums").find(" MiB "), std::string::npos) << text;
    EXPECT_NE(line_of("shadow rays").find("out "), std::string::npos) << text;
    EXPECT_EQ(line_of("shadow rays").find(" ms "), std::string::npos) << text;
    EXPECT_NE(line_of("gloss").find("no material has a lobe"), std::string::npos) << text;
    EXPECT_NE(line_of("plain").find("lights 'floor'"), std::string::npos) << text;
    EXPECT_NE(line_of("spare").find("off"), std::string::npos) << text;
    EXPECT_NE(line_of("color").find("gray"), std::string::npos) << text;
}

}  // namespace
}  // namespace nearfield::render
