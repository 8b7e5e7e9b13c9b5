// SPDX-License-Identifier: Apache-2.0
// An array of projectors is the light field far away, and is not near it; its pictures lie where
// renderers look for them, by those renderers' own formulas, written here from their sources.
#include "formats/proxies/projectors.h"

#include "formats/files/image.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "formats/proxies/projector_scene.h"
#include "tests/support/lamps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace nearfield {
namespace {

using proxies::Projector;
using proxies::Renderer;

// Smooth, without symmetry, in a pose of its own.
LightField smooth_lamp(Weighting weighting, glm::ivec2 grid = {3, 2}) {
    Slab slab;
    slab.delta_m = 0.4;
    slab.weighting = weighting;
    slab.luminaire_from_slab = {support::rotation_about(glm::normalize(glm::dvec3(1, 2, 3)), 0.4),
                                {0.1, 0.2, -0.3}};
    slab.grid = grid;
    slab.pitch_m = {0.03, 0.025};
    slab.u_center_m = {0.01, -0.02};
    slab.texels = {48, 40};
    slab.s_max_m = {0.3, 0.25};
    slab.s_min_m = -slab.s_max_m;
    slab.profile = model::make_profile("bspline");
    for (int m = 0; m < slab.image_count(); ++m)
        for (int j = 0; j < slab.texels.y; ++j)
            for (int i = 0; i < slab.texels.x; ++i) {
                const glm::dvec2 s = slab.s_min_m + (glm::dvec2(i, j) + 0.5) * slab.texel_m();
                const glm::dvec2 wide = (s - glm::dvec2(0.05 + 0.02 * m, -0.02)) / 0.12;
                slab.coeffs.push_back(static_cast<float>(std::exp(-glm::dot(wide, wide))));
            }
    LightField lamp;
    lamp.slabs = {slab};
    return lamp;
}

// Through the middle of a projector's pixel.
model::Receiver receiver_at(const Projector& projector, glm::ivec2 pixel, double distance_m) {
    const Rigid& pose = projector.luminaire_from_projector;
    const glm::dvec2 tangent =
        projector.tangent * (2.0 * (glm::dvec2(pixel) + 0.5) / glm::dvec2(projector.size_px) - 1.0);
    return {
        pose.rotation * (distance_m * glm::normalize(glm::dvec3(tangent, 1))) + pose.translation_m,
        pose.rotation * glm::normalize(glm::dvec3(0.2, -0.1, -1))};
}

double error_at(const LightField& lamp,
                const std::vector<Projector>& projectors,
                const model::Receiver& receiver) {
    const double truth = model::luminance(model::irradiance(lamp, receiver));
    return std::abs(proxies::irradiance(projectors, receiver) / truth - 1);
}

class Projectors : public testing::TestWithParam<Weighting> {};

// One image, in its pixels' middles: what is left far away is the parallax between U and S, the
// planes' distance over the receiver's, and float.
TEST_P(Projectors, AreTheFarFieldInPixelsMiddles) {
    const LightField lamp = smooth_lamp(GetParam(), {1, 1});
    const std::vector<Projector> projectors = proxies::projectors_of(lamp);
    ASSERT_EQ(projectors.size(), 1U);
    const glm::ivec2 middle = projectors[0].size_px / 2;
    for (const glm::ivec2 pixel :
         {middle, middle + glm::ivec2(6, -4), middle + glm::ivec2(-3, 7)}) {
        EXPECT_LT(error_at(lamp, projectors, receiver_at(projectors[0], pixel, 1000)), 2e-3);
        EXPECT_GT(error_at(lamp, projectors, receiver_at(projectors[0], pixel, 0.05)), 0.05);
    }
}

// Between middles a pixel errs by at most half of its width times the slope of the light, which of
// exp(-(x / w)^2) at x is 2 x / w^2: 14 / m at 0.1 m for w = 0.12 m, along x and y each.
TEST_P(Projectors, ErrByPixelsFarAway) {
    const LightField lamp = smooth_lamp(GetParam());
    const std::vector<Projector> projectors = proxies::projectors_of(lamp);
    EXPECT_EQ(projectors.size(), 6U);
    const double most = 14 * lamp.slabs[0].texel_m().x / 2 * 2;
    for (const glm::ivec2 from_middle : {glm::ivec2(0), glm::ivec2(6, 3), glm::ivec2(9, -8)})
        EXPECT_LT(
            error_at(lamp, projectors,
                     receiver_at(projectors[0], projectors[0].size_px / 2 + from_middle, 100)),
            most);
}

INSTANTIATE_TEST_SUITE_P(OfBothWeightings,
                         Projectors,
                         testing::Values(Weighting::Irradiance, Weighting::Radiance));

// Mitsuba 3's projector at a local point: its pixel by the mapping of its perspective camera (u = 0
// at +x, v = 0 at +y), and E = pi scale texture / (z^2 cos) at normal incidence.
double mitsuba_lx(const Projector& projector, const Picture& picture, glm::dvec3 p) {
    const double aspect =
        static_cast<double>(projector.size_px.x) / static_cast<double>(projector.size_px.y);
    const double u = 0.5 * (1 - p.x / p.z / projector.tangent.x);
    const double v = 0.5 * (1 - p.y / p.z / projector.tangent.x * aspect);
    const int column = static_cast<int>(u * picture.size_px.x);
    const int row = static_cast<int>(v * picture.size_px.y);
    const double texture = static_cast<double>(
        picture.layers[0].values[static_cast<std::size_t>(3 * (row * picture.size_px.x + column))]);
    const double scale = 1 / std::numbers::pi;
    return std::numbers::pi * scale * texture / (p.z * p.z * (p.z / glm::length(p)));
}

// pbrt-v4's projection light: screen window -1 ... 1 along the shorter side, y flipped, I =
// texture.
double pbrt_lx(const Projector& projector, const Picture& picture, glm::dvec3 p) {
    const double least = std::min(projector.tangent.x, projector.tangent.y);
    const double aspect =
        static_cast<double>(projector.size_px.x) / static_cast<double>(projector.size_px.y);
    const glm::dvec2 bounds = aspect > 1 ? glm::dvec2(aspect, 1) : glm::dvec2(1, 1 / aspect);
    const glm::dvec2 screen = glm::dvec2(p.x, -p.y) / p.z / least;
    const glm::dvec2 uv = 0.5 * (screen / bounds + 1.0);
    const int column = static_cast<int>(uv.x * picture.size_px.x);
    const int row = static_cast<int>(uv.y * picture.size_px.y);
    return static_cast<double>(
               picture.layers[0]
                   .values[static_cast<std::size_t>(3 * (row * picture.size_px.x + column))]) /
           glm::dot(p, p);
}

// Square pixels are what both renderers assume of a picture's sides.
TEST(ProjectorPictures, LieWhereRenderersLook) {
    const LightField lamp = smooth_lamp(Weighting::Irradiance);
    for (const Projector& projector : proxies::projectors_of(lamp)) {
        EXPECT_NEAR(projector.tangent.x / projector.tangent.y,
                    static_cast<double>(projector.size_px.x) / projector.size_px.y, 1e-9);
        proxies::write_projector_picture(projector, Renderer::Mitsuba3, "mitsuba.exr");
        proxies::write_projector_picture(projector, Renderer::Pbrt4, "pbrt.exr");
        const Picture mitsuba = read_picture("mitsuba.exr"), pbrt = read_picture("pbrt.exr");
        for (const glm::dvec2 tangent : {glm::dvec2(0.21, 0.13), glm::dvec2(-0.3, 0.37)}) {
            const glm::dvec3 p(2.0 * tangent, 2.0);
            const Rigid& pose = projector.luminaire_from_projector;
            const double ours = proxies::irradiance(
                {projector},
                {pose.rotation * p + pose.translation_m, pose.rotation * -glm::normalize(p)});
            ASSERT_GT(ours, 0);
            EXPECT_NEAR(mitsuba_lx(projector, mitsuba, p), ours, 1e-5 * ours);
            // Its pixel's intensity stands for all of the pixel.
            EXPECT_NEAR(pbrt_lx(projector, pbrt, p), ours, 0.05 * ours);
        }
    }
}

TEST(ProjectorScene, NamesEveryPictureWithItsPose) {
    const LightField lamp = smooth_lamp(Weighting::Irradiance);
    const std::vector<Projector> projectors = proxies::projectors_of(lamp);
    const std::vector<std::string> names(projectors.size(), "p.exr");
    for (const Renderer renderer : {Renderer::Mitsuba3, Renderer::Pbrt4}) {
        const std::string text = proxies::projector_scene(projectors, names, renderer, "lamp.exr");
        std::size_t found = 0;
        for (std::size_t at = text.find("p.exr"); at != std::string::npos;
             at = text.find("p.exr", at + 1))
            ++found;
        EXPECT_EQ(found, projectors.size() + 1);  // lamp.exr
        EXPECT_THAT(text, testing::HasSubstr("fov"));
    }
}

}  // namespace
}  // namespace nearfield
