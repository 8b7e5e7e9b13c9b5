// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"

#include "formats/files/error.h"
#include "formats/model/profile.h"
#include "render/cpu/lamps.h"
#include "tests/render/scenes.h"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::render {
namespace {

using test::add_blocker;
using test::floor_position;
using test::floor_scene;
using test::layer;
using test::one_window_lamp;
using test::pose;
using test::write_lamp;

const glm::dvec3 kDown(0, 0, -1);
constexpr double kDelta = 0.1;  // of one_window_lamp

RenderOptions small(int side_px = 16) {
    RenderOptions options;
    options.size_px = {side_px, side_px};
    return options;
}

/// Largest difference of two layers relative to the first one's largest value.
double difference(const Layer& a, const Layer& b) {
    double largest = 0.0, worst = 0.0;
    EXPECT_EQ(a.values.size(), b.values.size());
    for (std::size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i) {
        largest = std::max(largest, static_cast<double>(a.values[i]));
        worst = std::max(worst, static_cast<double>(std::abs(a.values[i] - b.values[i])));
    }
    EXPECT_GT(largest, 0.0);
    return worst / largest;
}

// Proves units, the camera's geometry (pixel centers, axes) and the lamp's pose against I cos / r^2
// of a source whose intensity is delta^2 C a^2 / cos^3 (irradiance weighting) or C a^2 cos
// (radiance weighting). Says nothing about extended sources.
TEST(Render, PointLikeLampGivesIntensityTimesCosineOverSquaredDistance) {
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
        const Rendered rendered = render(scene, options);
        const Layer& irradiance = layer(rendered.picture, "irradiance");
        const Layer& radiance = layer(rendered.picture, "");
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                const double u_height =
                    kHeight + kDelta;  // light starts at U, delta behind the lamp's origin
                const glm::dvec2 away = floor_position({x, y}, options.size_px) - lamp_xy;
                const double r2 = glm::dot(away, away) + u_height * u_height;
                const double cosine = u_height / std::sqrt(r2);
                const double intensity =
                    area * static_cast<double>(kCoefficient) *
                    (weighting == Weighting::Irradiance ? kDelta * kDelta / std::pow(cosine, 3)
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
TEST(Render, DepthIsAlongTheAxisAndNormalsFaceTheViewer) {
    Scene scene = floor_scene();
    std::swap(scene.meshes[0].triangles[0].x,
              scene.meshes[0].triangles[0].y);  // turned away by winding
    const Rendered rendered = render(scene, small());
    for (const float depth : layer(rendered.picture, "depth").values)
        EXPECT_NEAR(depth, 4.0, 1e-6);
    EXPECT_NEAR(layer(rendered.picture, "normal").values[2], 1.0, 1e-7);
}

// Proves that an opaque rectangle takes all light and that sigma is zero where nothing is
// uncertain.
TEST(Render, BlockerShadowsTotally) {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.05, 1.0F), "lamp", pose({0, 0, 2}, kDown))};
    add_blocker(scene, "blocker", {0, 0, 1.9}, {4, 4});
    scene.cameras = {test::camera_at({0, -3, 1}, {0, 3, -1}, {0, 0, 1}, 0.5)};  // under the blocker
    const Rendered rendered = render(scene, small());
    for (const char* name : {"", "irradiance", "sigma"})
        for (const float value : layer(rendered.picture, name).values)
            EXPECT_EQ(value, 0.0F);
    EXPECT_GT(rendered.report.shadow_rays, 0U);
}

/// A lamp with a square aperture, half of it hidden from the floor's middle by a sheet just below
/// U's plane.
Scene half_covered() {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.2, 1.0F), "lamp", pose({0, 0, 2}, kDown))};
    add_blocker(scene, "sheet", {1, 0, 2.0999}, {2, 4});  // covers x > 0; U is at z = 2.1
    scene.cameras = {
        test::camera_at({0, -3, 1}, {0, 3, -1}, {0, 0, 1}, 0.5)};  // looks at the middle from below
    return scene;
}

// Proves the ratio estimator against geometry: on a lamp whose integrand is even over U, light is
// the visible share of the aperture. The middle of an odd picture looks at the aperture's middle.
TEST(Render, HalfCoveredApertureGivesHalf) {
    const double unshadowed = kDelta * kDelta * 0.2 * 0.2 / (2.1 * 2.1);
    RenderOptions options = small(1);
    double sum = 0, squares = 0, sigma = 0;
    constexpr int kSeeds = 200;
    for (int seed = 0; seed < kSeeds; ++seed) {
        options.seed = static_cast<std::uint32_t>(seed);
        const Rendered rendered = render(half_covered(), options);
        const double ratio = layer(rendered.picture, "irradiance").values[0] / unshadowed;
        sum += ratio;
        squares += (ratio - 0.5) * (ratio - 0.5);
        sigma +=
            layer(rendered.picture, "sigma").values[0] / (unshadowed * 0.5 / glm::pi<double>());
    }
    const double rms = std::sqrt(squares / kSeeds);
    RecordProperty("observed_rms", std::to_string(rms));
    RecordProperty("predicted_sigma", std::to_string(sigma / kSeeds));
    EXPECT_NEAR(sum / kSeeds, 0.5, 3.0 * rms / std::sqrt(kSeeds));
    // 64 independent samples would spread by 1/16; the estimate says so, and stratified ones do
    // better.
    EXPECT_NEAR(sigma / kSeeds, 1.0 / 16.0, 0.005);
    EXPECT_LT(rms, sigma / kSeeds);
}

// Measures the ratio estimator's bias at 8 samples against 1024 over penumbra pixels and seeds.
TEST(Render, RatioEstimatorBiasIsBelowOnePercentAtEightSamples) {
    // A lamp with structure: weights differ from sample to sample only then.
    LightField lamp = one_window_lamp(0.2, 1.0F);
    Slab& slab = lamp.slabs[0];
    slab.texels = {9, 7};
    slab.coeffs.resize(63);
    for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
        slab.coeffs[i] = static_cast<float>((i * 37) % 11);
    Scene scene = half_covered();
    scene.luminaires = {write_lamp(lamp, "structured", pose({0, 0, 2}, kDown))};
    scene.instances[1].world_from_mesh = glm::translate(glm::dmat4(1.0), {1, 0, 1.2});
    const auto total = [&](int samples, int seeds) {
        double sum = 0;
        for (int seed = 0; seed < seeds; ++seed) {
            RenderOptions options = small(32);
            options.visibility_samples = samples;
            options.seed = static_cast<std::uint32_t>(seed);
            const Rendered rendered = render(scene, options);
            for (const float value : layer(rendered.picture, "irradiance").values)
                sum += value;
        }
        return sum / seeds;
    };
    const double reference = total(1024, 2);
    const double bias = total(8, 32) / reference - 1.0;
    RecordProperty("bias_at_8", std::to_string(bias));
    EXPECT_LT(std::abs(bias), 0.01);
}

// Proves that scheduling never shows: equal bits for 1, 2 and all threads, and other bits for
// another seed.
TEST(Render, ThreadCountDoesNotChangeABit) {
    RenderOptions options = small(40);
    options.samples_per_pixel = 4;
    options.threads = 1;
    const Rendered one = render(half_covered(), options);
    for (const int threads : {2, 0}) {
        options.threads = threads;
        const Rendered many = render(half_covered(), options);
        for (std::size_t i = 0; i < one.picture.layers.size(); ++i)
            EXPECT_EQ(one.picture.layers[i].values, many.picture.layers[i].values)
                << one.picture.layers[i].name;
        EXPECT_EQ(one.report.shadow_rays, many.report.shadow_rays);
        EXPECT_EQ(one.report.multiply_adds, many.report.multiply_adds);
    }
    options.seed = 2;
    EXPECT_NE(layer(one.picture, "").values,
              layer(render(half_covered(), options).picture, "").values);
}

/// An uneven lamp of 3 x 2 images in color, low over the floor and tilted, with a post in its
/// light.
Scene uneven_scene() {
    LightField lamp = one_window_lamp(0.02, 1.0F);
    Slab& slab = lamp.slabs[0];
    slab.grid = {3, 2};
    slab.texels = {5, 4};
    slab.channels = 3;
    slab.profile = model::make_profile("bspline");
    slab.coeffs.resize(3 * 6 * 20);
    for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
        slab.coeffs[i] = static_cast<float>((i * 7919) % 101);
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(lamp, "uneven", pose({-0.8, 0.5, 0.6}, {0.9, -0.3, -0.6}))};
    scene.luminaires[0].excludes = {"cover"};
    add_blocker(scene, "post", {0.3, 0.1, 0.25}, {0.2, 0.4});
    add_blocker(scene, "cover", {-0.8, 0.5, 0.5}, {0.1, 0.1});
    return scene;
}

Scene transformed(Scene scene, const glm::dmat4& matrix) {
    for (Instance& instance : scene.instances)
        instance.world_from_mesh = matrix * instance.world_from_mesh;
    for (LuminaireInstance& lamp : scene.luminaires)
        lamp.world_from_luminaire = matrix * lamp.world_from_luminaire;
    for (Camera& camera : scene.cameras)
        camera.world_from_camera = matrix * camera.world_from_camera;
    return scene;
}

// Random numbers do not know the pose, so that even noise is the same but for rays that pass an
// edge within rounding.
constexpr double kPoseTolerance = 2e-5;   // float positions in the slab's frame
constexpr double kFlippedPixels = 0.005;  // share of pixels where a ray's outcome may differ

double share_beyond(const Layer& a, const Layer& b, double tolerance) {
    float largest = 0.0F;
    for (const float value : a.values)
        largest = std::max(largest, value);
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
        beyond +=
            std::abs(a.values[i] - b.values[i]) > static_cast<float>(tolerance) * largest ? 1U : 0U;
    return static_cast<double>(beyond) / static_cast<double>(a.values.size());
}

// Proves: moving, turning or scaling the whole scene, lamps' geometry included, leaves the picture
// as it is (radiance does not change with scale).
TEST(Render, MovingTurningScalingTheSceneLeavesThePicture) {
    const Rendered plain = render(uneven_scene(), small(48));
    const glm::dmat4 one(1.0);
    for (const glm::dmat4& matrix :
         {glm::translate(one, {3, -2, 1}),
          glm::rotate(one, 1.1, glm::normalize(glm::dvec3(1, 2, -1))),
          glm::scale(one, glm::dvec3(1e3)), glm::scale(one, glm::dvec3(1e-3))}) {
        const Rendered moved = render(transformed(uneven_scene(), matrix), small(48));
        EXPECT_LT(share_beyond(layer(plain.picture, ""), layer(moved.picture, ""), kPoseTolerance),
                  kFlippedPixels);
    }
}

// Proves mirrored lamps: the mirrored scene's picture is the mirrored picture. Without shadows,
// since mirrored pixels have other random numbers.
TEST(Render, MirroredSceneGivesTheMirroredPicture) {
    Scene scene = uneven_scene();
    scene.instances.resize(1);
    scene.luminaires[0].excludes.clear();
    constexpr int kSide = 32;
    const Rendered plain = render(scene, small(kSide));
    Scene mirrored = transformed(scene, glm::scale(glm::dmat4(1.0), {-1, 1, 1}));
    mirrored.cameras = scene.cameras;  // on the mirror plane
    Rendered other = render(mirrored, small(kSide));
    Layer flipped = layer(other.picture, "");
    for (std::size_t y = 0; y < kSide; ++y)
        for (std::size_t x = 0; x < kSide; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                flipped.values[3 * (y * kSide + x) + c] =
                    layer(other.picture, "").values[3 * (y * kSide + kSide - 1 - x) + c];
    EXPECT_LT(difference(layer(plain.picture, ""), flipped), kPoseTolerance);
}

// Proves that an excluded mesh casts no shadow in the light of the lamp that names it, by node or
// by mesh, and still does in another's.
TEST(Render, ExcludedMeshCastsNoShadowForItsLampAlone) {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.05, 1.0F), "a", pose({0, 0, 2}, kDown))};
    const Rendered open = render(scene, small());
    add_blocker(scene, "lens", {0, 0, 1.99}, {3, 3});
    scene.cameras = {test::camera_at({0, -3, 1}, {0, 3, -1}, {0, 0, 1}, 0.3)};
    scene.luminaires.push_back(scene.luminaires[0]);
    for (const char* name : {"lens", "lens mesh"}) {
        scene.luminaires[1].excludes = {name};
        const Rendered rendered = render(scene, small());
        EXPECT_EQ(layer(rendered.picture, "lamp.a").values[0], 0.0F);
        EXPECT_NEAR(layer(rendered.picture, "lamp.a_2").values[3 * 136],
                    layer(open.picture, "lamp.a").values[3 * 136],
                    1e-6F * layer(open.picture, "lamp.a").values[3 * 136]);
    }
}

// Proves that a lamp that is off, or dimmed to nothing, is not even opened, and that dim scales
// light.
TEST(Render, LampsThatAreOffCostNothingAndDimScalesLight) {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.05, 1.0F), "lamp", pose({0, 0, 2}, kDown))};
    const Rendered full = render(scene, small());
    scene.luminaires[0].dim = 0.25;
    LuminaireInstance off = scene.luminaires[0];
    off.path = "no such file";
    off.on = false;
    LuminaireInstance dark = off;
    dark.on = true;
    dark.dim = 0.0;
    scene.luminaires.push_back(off);
    scene.luminaires.push_back(dark);
    const Rendered dimmed = render(scene, small());
    EXPECT_EQ(dimmed.report.shadow_rays, full.report.shadow_rays);
    EXPECT_EQ(dimmed.picture.layers.size(), full.picture.layers.size());
    EXPECT_FLOAT_EQ(layer(dimmed.picture, "").values[0], 0.25F * layer(full.picture, "").values[0]);
}

// Proves exact zeros: behind U, and on a surface that faces away from its viewer's side.
TEST(Render, NoLightBehindTheLampOrThroughASurface) {
    Scene scene = floor_scene();
    const LightField lamp = one_window_lamp(0.05, 1.0F);
    for (const glm::dmat4& where : {pose({0, 0, 2}, -kDown), pose({0, 0, -2}, -kDown)}) {
        scene.luminaires = {write_lamp(lamp, "lamp", where)};
        const Rendered rendered = render(scene, small());
        for (const float value : layer(rendered.picture, "irradiance").values)
            EXPECT_EQ(value, 0.0F);
        EXPECT_EQ(rendered.report.shadow_rays, 0U);
    }
}

// Proves that slabs add and share samples by their energy: a lamp of two slabs is two lamps of one.
TEST(Render, LightOfSlabsAndLampsAdds) {
    LightField both = one_window_lamp(0.05, 1.0F);
    both.slabs.push_back(both.slabs[0]);
    both.slabs[1].coeffs = {3.0F};
    both.slabs[1].luminaire_from_slab.translation_m = {0.5, 0, 0.1};
    LightField second = both;
    second.slabs.erase(second.slabs.begin());
    Scene scene = floor_scene();
    const glm::dmat4 place = pose({0, 0, 2}, kDown);
    scene.luminaires = {write_lamp(both, "both", place)};
    const Rendered together = render(scene, small());
    second.slabs[0].luminaire_from_slab = {};
    both.slabs.pop_back();
    scene.luminaires = {write_lamp(both, "first", place),
                        write_lamp(second, "second", glm::translate(place, {0.5, 0, 0.1}))};
    const Rendered apart = render(scene, small());
    EXPECT_LT(difference(layer(together.picture, ""), layer(apart.picture, "")), 2e-6);
    const Layer& sum = layer(apart.picture, "");
    for (std::size_t i = 0; i < sum.values.size(); ++i)
        EXPECT_FLOAT_EQ(sum.values[i], layer(apart.picture, "lamp.first").values[i] +
                                           layer(apart.picture, "lamp.second").values[i]);
}

// Proves that shadow samples are shared among slabs by energy and weighted back: with one of two
// slabs hidden, the other's light is what remains, to within one sample of 64.
TEST(Render, HiddenSlabTakesItsShareOfTheLight) {
    LightField both = one_window_lamp(0.05, 1.0F);
    both.slabs.push_back(both.slabs[0]);
    both.slabs[1].coeffs = {3.0F};
    both.slabs[1].luminaire_from_slab.translation_m = {0.5, 0, 0.1};
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(both, "both", pose({0, 0, 2}, kDown))};
    add_blocker(scene, "cap", {0, 0, 1.99}, {0.4, 0.4});
    const Rendered rendered = render(scene, small());
    // E of a slab is delta^2 C a^2 / (height of U)^2 everywhere on the floor; the second slab's U
    // is 2.0 m high.
    const double expected = kDelta * kDelta * 3.0 * 0.05 * 0.05 / (2.0 * 2.0);
    const double hidden = kDelta * kDelta * 1.0 * 0.05 * 0.05 / (2.1 * 2.1);
    for (std::size_t i = 0; i < 256; ++i) {
        if (layer(rendered.picture, "depth").values[i] < 3.9F)
            continue;  // the cap itself
        EXPECT_NEAR(layer(rendered.picture, "irradiance").values[3 * i], expected,
                    (expected + hidden) / 64.0);
    }
}

// Proves the gloss of a point-like lamp against Phong's formula, and that its noise is reported
// where it is none.
TEST(Render, GlossOfAPointLikeLampIsPhongs) {
    Scene scene = floor_scene();
    scene.materials[0] = {"varnish", glm::vec3(0.3F, 0.5F, 0.7F), 0.4F, 0.6F};
    scene.luminaires = {
        write_lamp(one_window_lamp(1e-4, 1e9F), "point", pose({0.4, 0.2, 2}, kDown))};
    const RenderOptions options = small(9);
    const Rendered rendered = render(scene, options);
    const Reflectance r = reflectance(scene.materials[0]);
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

// Proves the figures of noise on numbers computed by hand: 20 lit pixels of sigma 1 ... 20 %, whose
// 95th percentile is 19 % and half of which are above 10 %; a dark pixel does not count.
TEST(Render, NoiseFiguresAreThoseComputedByHand) {
    Layer radiance{"", {"R", "G", "B"}, {}}, sigma{"sigma", {"Y"}, {}};
    for (int percent = 20; percent >= 1; --percent) {
        radiance.values.insert(radiance.values.end(), 3, 2.0F);
        sigma.values.push_back(2.0F * 0.01F * static_cast<float>(percent));
    }
    radiance.values.insert(radiance.values.end(), 3, 0.0019F);
    sigma.values.push_back(1.0F);
    sigma.values[10] = 0.2001F;  // 10 % and a little
    const Noise noise = summarize_noise(radiance, sigma);
    constexpr double kTolerance = 1e-6;  // float inputs
    EXPECT_NEAR(noise.mean_rel, (0.105 * 20.0 + 0.00005) / 20.0, kTolerance);
    EXPECT_NEAR(noise.p95_rel, 0.19, kTolerance);
    EXPECT_NEAR(noise.share_above_10_percent, 11.0 / 20.0, kTolerance);
    EXPECT_EQ(summarize_noise({"", {}, {0, 0, 0}}, {"", {}, {0}}).mean_rel, 0.0);
}

// Proves sigma_measured in closed form: of one coefficient, sigma over light is its own relative
// sigma and the common scale's in squares, whatever the scale of the scene; lamps of one file add
// as they are.
TEST(Render, MeasuredSigmaIsTheFilesRelativeSigmaTimesDiffuseRadiance) {
    LightField lamp = one_window_lamp(0.05, 2.0F);
    lamp.slabs[0].sigma = {0.06F};
    lamp.scale_sigma_rel = 0.04;
    const double relative = std::hypot(0.03, 0.04);
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(lamp, "measured", pose({0.3, 0.1, 2}, {0.1, 0.2, -1}))};
    scene.luminaires[0].dim = 0.5;
    scene.luminaires.push_back(scene.luminaires[0]);
    for (const double scale : {1.0, 0.01}) {
        const glm::dmat4 matrix = glm::scale(glm::dmat4(1.0), glm::dvec3(scale));
        RenderOptions options = small(5);
        options.samples_per_pixel = 4;
        options.sigma_measured = true;
        const Rendered rendered = render(transformed(scene, matrix), options);
        EXPECT_TRUE(rendered.report.has_sigma_measured);
        for (std::size_t i = 0; i < 25; ++i) {
            const float radiance = layer(rendered.picture, "").values[3 * i + 1];
            EXPECT_GT(radiance, 0.0F);
            EXPECT_NEAR(layer(rendered.picture, "sigma_measured").values[i] / radiance, relative,
                        1e-5 * relative);  // float sums against double
        }
    }
}

// Proves that the layer is not there where nobody asked for it, or where no file knows.
TEST(Render, MeasuredSigmaIsLeftOutWhereNothingIsKnown) {
    LightField lamp = one_window_lamp(0.05, 2.0F);
    Scene scene = floor_scene();
    RenderOptions options = small(4);
    const auto layers = [&] {
        scene.luminaires = {write_lamp(lamp, "perhaps", pose({0, 0, 2}, kDown))};
        return render(scene, options).picture.layers.size();
    };
    const std::size_t without = layers();
    options.sigma_measured = true;
    EXPECT_EQ(layers(), without);
    lamp.slabs[0].sigma = {0.06F};
    EXPECT_EQ(layers(), without + 1);
    options.sigma_measured = false;
    EXPECT_EQ(layers(), without);
}

// Proves that summing light for many hits at once changes no bit of any of them, and that
// multiply-adds are counted where they are done.
TEST(Render, LightSumsOfManyHitsAreThoseOfEach) {
    const Lamps lamps = load_lamps(uneven_scene());
    std::vector<Hit> hits(7);
    for (std::size_t k = 0; k < hits.size(); ++k) {
        hits[k].position_world_m = {0.3 * static_cast<double>(k) - 0.9, 0.2, k == 4 ? 3.0 : 0.0};
        hits[k].shading_normal = {0, 0, 1};
    }
    LightSums all, one;
    sum_light(lamps.lamps[0], hits, all);
    std::uint64_t multiply_adds = 0;
    for (std::size_t k = 0; k < hits.size(); ++k) {
        sum_light(lamps.lamps[0], {&hits[k], 1}, one);
        EXPECT_EQ(all.irradiance[k], one.irradiance[0]) << k;
        EXPECT_EQ(all.total_y[k], one.total_y[0]) << k;
        EXPECT_EQ(k == 4, one.multiply_adds == 0U) << k;  // behind the lamp
        multiply_adds += one.multiply_adds;
    }
    EXPECT_EQ(all.multiply_adds, multiply_adds);
}

// Proves that options out of range and a missing camera are refused by name.
TEST(Render, OptionsOutOfRangeAreRefused) {
    const auto message = [](const Scene& scene, const RenderOptions& options) -> std::string {
        try {
            render(scene, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    };
    RenderOptions options = small();
    options.samples_per_pixel = 5;
    EXPECT_NE(message(floor_scene(), options).find("samples per pixel"), std::string::npos);
    options = small();
    options.visibility_samples = 1;
    EXPECT_NE(message(floor_scene(), options).find("visibility samples"), std::string::npos);
    options = small();
    options.camera = "rear";
    EXPECT_NE(message(floor_scene(), options).find("'rear'"), std::string::npos);
}

}  // namespace
}  // namespace nearfield::render
