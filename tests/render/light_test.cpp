// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::render {
namespace {

using test::add_blocker;
using test::difference;
using test::floor_position;
using test::floor_scene;
using test::kDown;
using test::kWindowDelta;
using test::layer;
using test::one_window_lamp;
using test::pose;
using test::small;
using test::write_lamp;

// Proves units, the camera's geometry (pixel centers, axes) and the lamp's pose against I cos / r^2
// of a source whose intensity is delta^2 C a^2 / cos^3 (irradiance weighting) or C a^2 cos
// (radiance weighting). Says nothing about extended sources.
TEST(Light, PointLikeLampGivesIntensityTimesCosineOverSquaredDistance) {
    constexpr double kAperture = 1e-4, kHeight = 2.0;
    constexpr float kCoefficient = 1e9F;
    constexpr double kTolerance = 2e-6;  // float sums; a / r = 5e-5, squared
    const double area = kAperture * kAperture;
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        Scene scene = floor_scene();
        const glm::dvec2 lamp_xy(0.3, -0.7);
        scene.luminaires = {write_lamp(one_window_lamp(kAperture, kCoefficient, weighting), "point",
                                       pose({lamp_xy.x, lamp_xy.y, kHeight}, kDown))};
        const RenderOptions options = small(8);
        const Rendered rendered = render_cpu(scene, options);
        const Layer& irradiance = layer(rendered.picture, "irradiance");
        const Layer& radiance = layer(rendered.picture, "");
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                const double u_height =
                    kHeight + kWindowDelta;  // light starts at U, delta behind the lamp's origin
                const glm::dvec2 away = floor_position({x, y}, options.size_px) - lamp_xy;
                const double r2 = glm::dot(away, away) + u_height * u_height;
                const double cosine = u_height / std::sqrt(r2);
                const double intensity = area * static_cast<double>(kCoefficient) *
                                         (weighting == Weighting::Irradiance
                                              ? kWindowDelta * kWindowDelta / std::pow(cosine, 3)
                                              : cosine);
                const double expected = intensity * cosine / r2;
                const auto index = static_cast<std::size_t>(3 * (y * 8 + x));
                EXPECT_NEAR(irradiance.values[index] / expected, 1.0, kTolerance) << x << " " << y;
                EXPECT_NEAR(radiance.values[index] / (expected * 0.5 / glm::pi<double>()), 1.0,
                            kTolerance);
            }
    }
}

// Proves that the depth layer is measured along the camera's axis and that normals face the viewer.
TEST(Light, DepthIsAlongTheAxisAndNormalsFaceTheViewer) {
    Scene scene = floor_scene();
    std::swap(scene.meshes[0].triangles[0].x,
              scene.meshes[0].triangles[0].y);  // turned away by winding
    const Rendered rendered = render_cpu(scene, small());
    for (const float depth : layer(rendered.picture, "depth").values)
        EXPECT_NEAR(depth, 4.0, 1e-6);
    EXPECT_NEAR(layer(rendered.picture, "normal").values[2], 1.0, 1e-7);
}

// Proves that a lamp that is off, or dimmed to nothing, is not even opened, and that dim scales
// light.
TEST(Light, LampsThatAreOffCostNothingAndDimScalesLight) {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.05, 1.0F), "lamp", pose({0, 0, 2}, kDown))};
    const Rendered full = render_cpu(scene, small());
    scene.luminaires[0].dim = 0.25;
    LuminaireInstance off = scene.luminaires[0];
    off.path = "no such file";
    off.on = false;
    LuminaireInstance dark = off;
    dark.on = true;
    dark.dim = 0.0;
    scene.luminaires.push_back(off);
    scene.luminaires.push_back(dark);
    const Rendered dimmed = render_cpu(scene, small());
    EXPECT_EQ(dimmed.report.shadow_rays, full.report.shadow_rays);
    EXPECT_EQ(dimmed.picture.layers.size(), full.picture.layers.size());
    EXPECT_FLOAT_EQ(layer(dimmed.picture, "").values[0], 0.25F * layer(full.picture, "").values[0]);
}

// Proves exact zeros: behind U, and on a surface that faces away from its viewer's side.
TEST(Light, NoLightBehindTheLampOrThroughASurface) {
    Scene scene = floor_scene();
    const LightField lamp = one_window_lamp(0.05, 1.0F);
    for (const glm::dmat4& where : {pose({0, 0, 2}, -kDown), pose({0, 0, -2}, -kDown)}) {
        scene.luminaires = {write_lamp(lamp, "lamp", where)};
        const Rendered rendered = render_cpu(scene, small());
        for (const float value : layer(rendered.picture, "irradiance").values)
            EXPECT_EQ(value, 0.0F);
        EXPECT_EQ(rendered.report.shadow_rays, 0U);
    }
}

// Proves that slabs add and share samples by their energy: a lamp of two slabs is two lamps of one.
TEST(Light, LightOfSlabsAndLampsAdds) {
    LightField both = one_window_lamp(0.05, 1.0F);
    both.slabs.push_back(both.slabs[0]);
    both.slabs[1].coeffs = {3.0F};
    both.slabs[1].luminaire_from_slab.translation_m = {0.5, 0, 0.1};
    LightField second = both;
    second.slabs.erase(second.slabs.begin());
    Scene scene = floor_scene();
    const glm::dmat4 place = pose({0, 0, 2}, kDown);
    scene.luminaires = {write_lamp(both, "both", place)};
    const Rendered together = render_cpu(scene, small());
    second.slabs[0].luminaire_from_slab = {};
    both.slabs.pop_back();
    scene.luminaires = {write_lamp(both, "first", place),
                        write_lamp(second, "second", glm::translate(place, {0.5, 0, 0.1}))};
    const Rendered apart = render_cpu(scene, small());
    EXPECT_LT(difference(layer(together.picture, ""), layer(apart.picture, "")), 2e-6);
    const Layer& sum = layer(apart.picture, "");
    for (std::size_t i = 0; i < sum.values.size(); ++i)
        EXPECT_FLOAT_EQ(sum.values[i], layer(apart.picture, "lamp.first").values[i] +
                                           layer(apart.picture, "lamp.second").values[i]);
}

// Proves the gloss of a point-like lamp against Phong's formula, and that its noise is reported
// where it is none.
TEST(Light, GlossOfAPointLikeLampIsPhongs) {
    Scene scene = floor_scene();
    scene.materials[0] = {"varnish", glm::vec3(0.3F, 0.5F, 0.7F), 0.4F, 0.6F};
    scene.luminaires = {
        write_lamp(one_window_lamp(1e-4, 1e9F), "point", pose({0.4, 0.2, 2}, kDown))};
    const RenderOptions options = small(9);
    const Rendered rendered = render_cpu(scene, options);
    const shared::Brdf r = brdf(scene.materials[0]);
    const double e = 0.01 * 1e9 * 1e-8 / (2.1 * 2.1);
    for (int x = 0; x < 9; ++x) {
        const glm::dvec3 p(floor_position({x, 4}, options.size_px), 0);
        const glm::dvec3 l = glm::normalize(glm::dvec3(0.4, 0.2, 2.1) - p),
                         v = glm::normalize(glm::dvec3(0, 0, 4) - p);
        const double cosine = std::max(0.0, glm::dot(glm::dvec3(-l.x, -l.y, l.z), v));
        const double n = static_cast<double>(r.exponent);
        const double lobe = (n + 2) / (2 * glm::pi<double>()) * std::pow(cosine, n);
        for (int c = 0; c < 3; ++c) {
            const double expected = e * (static_cast<double>(r.diffuse[c]) / glm::pi<double>() +
                                         static_cast<double>(r.specular[c]) * lobe);
            EXPECT_NEAR(
                layer(rendered.picture, "").values[static_cast<std::size_t>(3 * (4 * 9 + x) + c)] /
                    expected,
                1.0, 1e-4);  // the aperture's width turns the lobe
        }
    }
    EXPECT_LT(rendered.report.sampling.p95_rel, 1e-4);
}

/// A picture's luminance summed, and the standard deviation of that sum.
struct Total {
    double y = 0, variance = 0;
};
Total total(const Rendered& rendered) {
    Total result;
    const Layer& radiance = layer(rendered.picture, "");
    for (std::size_t i = 0; i < radiance.values.size(); i += 3)
        result.y += static_cast<double>(shared::luminance709(
            {radiance.values[i], radiance.values[i + 1], radiance.values[i + 2]}));
    for (const float sigma : layer(rendered.picture, "sigma").values)
        result.variance += static_cast<double>(sigma * sigma);
    return result;
}

// Proves that the two ways to find gloss agree, in penumbrae too: the sum with f_r for every texel,
// which has no noise where nothing is hidden, and lamp and lobe samples.
TEST(Light, GlossBySumAndBySamplesAgree) {
    LightField lamp = one_window_lamp(0.1, 1.0F);
    lamp.slabs[0].texels = {48, 40};
    lamp.slabs[0].coeffs.resize(std::size_t{48} * 40);
    for (std::size_t i = 0; i < lamp.slabs[0].coeffs.size(); ++i)
        lamp.slabs[0].coeffs[i] = static_cast<float>((i * 37) % 11);
    Scene scene = floor_scene();
    scene.materials[0].metallic = 0.6F;
    scene.materials[0].roughness = 0.5F;
    scene.luminaires = {write_lamp(lamp, "fine", pose({0.3, 0.2, 0.5}, {-0.3, -0.1, -1}))};
    add_blocker(scene, "post", {0.1, 0.1, 0.25}, {0.1, 0.2});
    RenderOptions options = small(60);
    const Total summed = total(render_cpu(scene, options));
    options.sampler = model::Sampler::Systematic;
    const Total sampled = total(render_cpu(scene, options));
    ASSERT_GT(summed.variance, 0.0);
    ASSERT_GT(sampled.variance, summed.variance);
    constexpr double kGlossySum = 1e-3;  // formats/model/glossy_sum.h
    EXPECT_NEAR(summed.y, sampled.y,
                3.0 * std::sqrt(summed.variance + sampled.variance) + kGlossySum * summed.y);
}

}  // namespace
}  // namespace nearfield::render
