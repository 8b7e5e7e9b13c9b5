// SPDX-License-Identifier: Apache-2.0
#include "render/needs.h"

#include "render/cpu/render.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/support/random.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace nearfield::render {
namespace {

using support::Random;
using test::add_blocker;
using test::floor_scene;
using test::kDown;
using test::layer;
using test::one_window_lamp;
using test::pose;
using test::small;
using test::transformed;
using test::write_lamp;

Needs needs(const Scene& scene) {
    return needs_of(scene, load_lamps(scene), {});
}

/// A lamp of one channel, 0.1 m wide, over a gray floor.
Scene lit_floor() {
    Scene scene = floor_scene();
    scene.luminaires = {write_lamp(one_window_lamp(0.1, 1.0F), "lamp", pose({0, 0, 2}, kDown))};
    return scene;
}

/// A vertical rectangle: its middle, and the direction that it faces.
void add_wall(Scene& scene, const std::string& name, glm::dvec3 center, glm::dvec3 normal) {
    add_blocker(scene, name, {0, 0, 0}, {4, 4});
    scene.instances.back().world_from_mesh = pose(center, normal);
}

/// Walls that stand on the floor's edges.
void add_corner(Scene& scene) {
    add_wall(scene, "left wall", {-2, 0, 2}, {1, 0, 0});
    add_wall(scene, "back wall", {0, 2, 2}, {0, -1, 0});
}

// Proves that what cannot throw shadows does not call for them: a floor alone, a room's corner
// however it lies in the world, another lamp's shutter, things behind the lamp or that its light
// passes through.
TEST(Needs, NoShadowsWhereNothingCanStandBetween) {
    Scene scene = lit_floor();
    EXPECT_FALSE(needs(scene).shadows.is_called_for);
    add_corner(scene);
    EXPECT_FALSE(needs(scene).shadows.is_called_for);
    for (const double angle_rad : {0.3, 1.1, 2.5}) {
        glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), {31, -17, 5});
        matrix = glm::rotate(matrix, angle_rad, glm::normalize(glm::dvec3(3, 1, -2)));
        EXPECT_FALSE(needs(transformed(scene, matrix)).shadows.is_called_for) << angle_rad;
    }
    add_blocker(scene, "lamp shade", {0, 0, 2.2}, {0.3, 0.3});
    EXPECT_FALSE(needs(scene).shadows.is_called_for);
    add_blocker(scene, "lens", {0, 0, 1.95}, {0.3, 0.3});
    EXPECT_TRUE(needs(scene).shadows.is_called_for);
    scene.luminaires[0].excludes = {"lens"};
    EXPECT_FALSE(needs(scene).shadows.is_called_for);
}

// Proves that what may throw shadows is found and named: a post, a wall or
// floor whose plane cuts the lamp, a surface of more planes than are looked at.
TEST(Needs, ShadowsWhereSomethingMayStandBetween) {
    Scene scene = lit_floor();
    add_corner(scene);
    add_blocker(scene, "post_3", {0.3, 0.1, 0.5}, {0.2, 0.4});
    const Needs of_post = needs(scene);
    EXPECT_TRUE(of_post.shadows.is_called_for);
    EXPECT_TRUE(of_post.lamps[0].shadows.is_called_for);
    EXPECT_EQ(of_post.shadows.reason, "'post_3' may stand between lamp 'lamp' and 'floor'");

    Scene cut = lit_floor();
    add_wall(cut, "fin", {0, 0, 0}, {1, 0, 0});
    EXPECT_TRUE(needs(cut).shadows.is_called_for);

    // Half of the lamp is above the floor.
    Scene sunk = lit_floor();
    sunk.luminaires[0].world_from_luminaire = pose({-1, 0, 0}, {1, 0, 0});
    EXPECT_TRUE(needs(sunk).shadows.is_called_for);

    // A bowl, open towards the lamp, of many planes that all have it inside: none of them throws a
    // shadow, but they are too many.
    for (const unsigned sides : {12U, 100U}) {
        Scene bowl = lit_floor();
        Mesh& mesh = bowl.meshes[0];
        mesh.positions_m = {{0, 0, -1}};
        mesh.triangles.clear();
        for (unsigned k = 0; k < sides; ++k) {
            const float angle = 6.2831853F * static_cast<float>(k) / static_cast<float>(sides);
            mesh.positions_m.emplace_back(std::cos(angle), std::sin(angle), 0.0F);
            mesh.triangles.emplace_back(0, 1 + k, 1 + (k + 1) % sides);
        }
        bowl.luminaires[0].world_from_luminaire = pose({0, 0, 0.1}, kDown);
        EXPECT_EQ(needs(bowl).shadows.is_called_for, sides == 100U);
    }
}

// Proves the answer "no" against rays: in rooms of random walls and posts, lit from random places,
// nothing changes when shadows are forced on, and not all answers are the same. Rooms are turned at
// random, so that their corners meet to rounding only.
TEST(Needs, WhereShadowsAreNotCalledForRaysFindNone) {
    Random random{5};
    int called_for = 0, not_called_for = 0;
    for (int trial = 0; trial < 150; ++trial) {
        Scene scene = lit_floor();
        if (random.uniform() < 0.5)
            add_corner(scene);
        if (random.uniform() < 0.3)
            add_blocker(scene, "post",
                        {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(0, 3)},
                        {0.5, 0.5});
        if (random.uniform() < 0.3)
            add_wall(scene, "wall", {random.uniform(-2, 4), 0, 2}, {1, 0.2, 0});
        const glm::dvec3 from(random.uniform(-3, 2), random.uniform(-2, 3), random.uniform(-1, 3));
        const glm::dvec3 towards(random.uniform(-1, 1), random.uniform(-1, 1), 0);
        scene.luminaires[0].world_from_luminaire = pose(from, towards - from);
        scene = transformed(scene, glm::rotate(glm::dmat4(1.0), random.uniform(0, 3),
                                               glm::normalize(glm::dvec3(1, 2, 3))));
        if (needs(scene).shadows.is_called_for) {
            ++called_for;
            continue;
        }
        RenderOptions options = small(8);
        const Rendered planned = render_cpu(scene, options);
        options.effects.shadows = Switch::On;
        const Rendered forced = render_cpu(scene, options);
        const Layer& one = layer(planned.picture, "irradiance");
        const Layer& other = layer(forced.picture, "irradiance");
        bool is_lit = false;
        for (std::size_t i = 0; i < one.values.size(); ++i) {
            // The ratio of equal sums is 1.
            EXPECT_FLOAT_EQ(one.values[i], other.values[i]) << trial;
            is_lit |= one.values[i] > 0.0F;
        }
        not_called_for += is_lit ? 1 : 0;
    }
    EXPECT_GT(called_for, 20);
    EXPECT_GT(not_called_for, 20);
}

// Proves that lamps that light nothing are told from those that do, and that they cost nothing:
// dark ones are not even opened.
TEST(Needs, LampsThatLightNothingAreLeftOut) {
    Scene scene = lit_floor();
    scene.luminaires.push_back(scene.luminaires[0]);
    scene.luminaires[1].name = "up";
    scene.luminaires[1].world_from_luminaire = pose({0, 0, 1}, -kDown);
    for (const char* name : {"dimmed", "off"}) {
        scene.luminaires.push_back(scene.luminaires[0]);
        scene.luminaires.back().name = name;
        scene.luminaires.back().path = "no such file";
    }
    scene.luminaires[2].dim = 0.0;
    scene.luminaires[3].on = false;
    const Needs of_all = needs(scene);
    ASSERT_EQ(of_all.unlit.size(), 2U);
    EXPECT_EQ(of_all.unlit[0].reason, "dimmed to 0");
    EXPECT_EQ(of_all.unlit[1].reason, "off");
    ASSERT_EQ(of_all.lamps.size(), 2U);
    EXPECT_TRUE(of_all.lamps[0].light.is_called_for);
    EXPECT_FALSE(of_all.lamps[1].light.is_called_for);

    const Rendered both = render_cpu(scene, small());
    scene.luminaires.resize(1);
    const Rendered alone = render_cpu(scene, small());
    EXPECT_EQ(both.report.multiply_adds, alone.report.multiply_adds);
    EXPECT_EQ(layer(both.picture, "").values, layer(alone.picture, "").values);
    for (const float value : layer(both.picture, "lamp.up").values)
        EXPECT_EQ(value, 0.0F);
}

// Proves what calls for color and gloss, and that only materials in use count.
TEST(Needs, ColorAndGlossComeFromLampsAndMaterialsInUse) {
    Scene scene = lit_floor();
    scene.materials.push_back({"unused", {0.2F, 0.3F, 0.4F}, 1.0F, 0.2F});
    EXPECT_FALSE(needs(scene).color.is_called_for);
    EXPECT_FALSE(needs(scene).gloss.is_called_for);
    scene.materials[0] = {"tin", glm::vec3(0.5F), 1.0F, 0.2F};
    EXPECT_FALSE(needs(scene).color.is_called_for);
    EXPECT_EQ(needs(scene).gloss.reason, "'floor' is of 'tin', which has a lobe");
    scene.materials[0] = {"brick", {0.5F, 0.2F, 0.1F}, 0.0F, 1.0F};
    EXPECT_FALSE(needs(scene).gloss.is_called_for);
    EXPECT_EQ(needs(scene).color.reason, "material 'brick' is not gray");
    EXPECT_EQ(needs(test::uneven_scene()).color.reason, "lamp 'uneven' has three channels");
}

}  // namespace
}  // namespace nearfield::render
