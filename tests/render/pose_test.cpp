// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::render {
namespace {

using test::difference;
using test::layer;
using test::pose;
using test::small;
using test::transformed;
using test::uneven_scene;

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
TEST(Pose, MovingTurningScalingTheSceneLeavesThePicture) {
    const Rendered plain = render_cpu(uneven_scene(), small(48));
    const glm::dmat4 one(1.0);
    for (const glm::dmat4& matrix :
         {glm::translate(one, {3, -2, 1}),
          glm::rotate(one, 1.1, glm::normalize(glm::dvec3(1, 2, -1))),
          glm::scale(one, glm::dvec3(1e3)), glm::scale(one, glm::dvec3(1e-3))}) {
        const Rendered moved = render_cpu(transformed(uneven_scene(), matrix), small(48));
        EXPECT_LT(share_beyond(layer(plain.picture, ""), layer(moved.picture, ""), kPoseTolerance),
                  kFlippedPixels);
    }
}

// Proves mirrored lamps: the mirrored scene's picture is the mirrored picture. Without shadows,
// since mirrored pixels have other random numbers.
TEST(Pose, MirroredSceneGivesTheMirroredPicture) {
    Scene scene = uneven_scene();
    scene.instances.resize(1);
    scene.luminaires[0].excludes.clear();
    constexpr int kSide = 32;
    const Rendered plain = render_cpu(scene, small(kSide));
    Scene mirrored = transformed(scene, glm::scale(glm::dmat4(1.0), {-1, 1, 1}));
    mirrored.cameras = scene.cameras;  // on the mirror plane
    Rendered other = render_cpu(mirrored, small(kSide));
    Layer flipped = layer(other.picture, "");
    for (std::size_t y = 0; y < kSide; ++y)
        for (std::size_t x = 0; x < kSide; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                flipped.values[3 * (y * kSide + x) + c] =
                    layer(other.picture, "").values[3 * (y * kSide + kSide - 1 - x) + c];
    EXPECT_LT(difference(layer(plain.picture, ""), flipped), kPoseTolerance);
}

}  // namespace
}  // namespace nearfield::render
