// SPDX-License-Identifier: Apache-2.0
// Edits and their history: values alone.
#include "app/viewer/document.h"

#include "app/viewer/history.h"
#include "app/viewer/pose.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace nearfield::viewer {
namespace {

Document two_lamps() {
    Scene scene;
    for (const double x : {0.6, -0.6}) {
        LuminaireInstance lamp;
        lamp.name = x > 0 ? "left" : "right";
        lamp.path = "lamp.lightfield.exr";
        lamp.world_from_luminaire = glm::translate(glm::dmat4(1.0), glm::dvec3(x, 0.65, 3.0));
        scene.luminaires.push_back(lamp);
    }
    return document_of(scene, "scene.gltf");
}

glm::dvec3 place(const Document& document, std::size_t k) {
    return glm::dvec3(document.lamps[k].luminaire.world_from_luminaire[3]);
}

void expect_near(glm::dvec3 a, glm::dvec3 b, double within = 1e-12) {
    EXPECT_LT(glm::length(a - b), within)
        << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

double distance(const glm::dmat4& a, const glm::dmat4& b) {
    double sum = 0.0;
    for (int c = 0; c < 4; ++c)
        sum += glm::length(a[c] - b[c]);
    return sum;
}

TEST(ViewerDocument, EditsLeaveTheOldDocumentAsItWas) {
    const Document before = two_lamps();
    const Document after = edited(before, SetDim{before.lamps[0].id, 0.25});
    EXPECT_EQ(before.lamps[0].luminaire.dim, 1.0);
    EXPECT_EQ(after.lamps[0].luminaire.dim, 0.25);
    EXPECT_EQ(after.lamps[1].luminaire.dim, 1.0);
    EXPECT_EQ(after.scene, before.scene);  // shared: geometry is not copied
}

TEST(ViewerDocument, WhatAFileCouldNotHoldChangesNothing) {
    const Document document = two_lamps();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(edited(document, SetDim{0, -0.1}).lamps[0].luminaire.dim, 1.0);
    EXPECT_EQ(edited(document, SetDim{0, nan}).lamps[0].luminaire.dim, 1.0);
    EXPECT_EQ(edited(document, SetTint{0, {1.0F, 1.5F, 0.0F}}).lamps[0].luminaire.tint,
              glm::vec3(1.0F));
    expect_near(place(edited(document, SetPose{0, glm::dmat4(nan)}), 0), {0.6, 0.65, 3.0});
    expect_near(place(edited(document, SetPose{0, glm::dmat4(0.0)}), 0), {0.6, 0.65, 3.0});
    EXPECT_EQ(edited(document, SetDim{77, 0.5}).lamps[0].luminaire.dim, 1.0);
}

// A car's lamps: what one does, the other does in the mirror.
TEST(ViewerDocument, PartnersMoveMirrored) {
    Document document = edited(two_lamps(), MakePartners{0, 1});
    glm::dmat4 pose = document.lamps[0].luminaire.world_from_luminaire;
    pose = glm::rotate(pose, 0.2, glm::dvec3(0, 1, 0));
    pose[3] += glm::dvec4(0.1, 0.2, -0.3, 0.0);
    document = edited(document, SetPose{0, pose});
    expect_near(place(document, 1), {-0.7, 0.85, 2.7});
    const glm::dvec3 ahead(document.lamps[0].luminaire.world_from_luminaire[2]),
        others(document.lamps[1].luminaire.world_from_luminaire[2]);
    expect_near(others, {-ahead.x, ahead.y, ahead.z});
    // Neither of the two was mirrored itself; both still are no mirror images.
    EXPECT_GT(glm::determinant(glm::dmat3(document.lamps[1].luminaire.world_from_luminaire)), 0.0);
    document = edited(document, PartPartners{1});
    document = edited(document, SetPose{0, glm::dmat4(1.0)});
    expect_near(place(document, 1), {-0.7, 0.85, 2.7});
}

TEST(ViewerDocument, MirrorImagesAreMirrored) {
    const Document document = edited(two_lamps(), AddMirrorImage{0, {0, 0, 0}, {1, 0, 0}});
    ASSERT_EQ(document.lamps.size(), 3U);
    expect_near(place(document, 2), {-0.6, 0.65, 3.0});
    EXPECT_LT(glm::determinant(glm::dmat3(document.lamps[2].luminaire.world_from_luminaire)), 0.0);
    EXPECT_EQ(document.lamps[2].luminaire.name, "left 2");
    // Mirrored twice is as before.
    const glm::dmat4 mirror = mirror_matrix({0.3, 0.1, 2.0}, {0.6, 0.0, 0.8});
    EXPECT_LT(distance(mirror * mirror, glm::dmat4(1.0)), 1e-12);
}

TEST(ViewerDocument, AimPutsTheAxisThroughThePoint) {
    const glm::dvec3 at(1.0, -0.5, 9.0);
    const Document document = edited(two_lamps(), Aim{1, at});
    const glm::dmat4& pose = document.lamps[1].luminaire.world_from_luminaire;
    expect_near(glm::normalize(at - glm::dvec3(pose[3])), glm::dvec3(pose[2]));
    expect_near(place(document, 1), {-0.6, 0.65, 3.0});
}

TEST(ViewerPose, NumbersAreThePose) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int k = 0; k < 1000; ++k) {
        PoseNumbers numbers{{any(random), any(random), any(random)},
                            180.0 * any(random),
                            89.0 * any(random),
                            180.0 * any(random),
                            std::exp(any(random)),
                            any(random) < 0.0};
        const glm::dmat4 pose = pose_of(numbers);
        EXPECT_LT(distance(pose_of(numbers_of(pose)), pose), 1e-9);
        EXPECT_NEAR(numbers_of(pose).roll_deg, numbers.roll_deg, 1e-7);
        EXPECT_EQ(numbers_of(pose).is_mirrored, numbers.is_mirrored);
    }
    // Straight up, where yaw and roll are one.
    const glm::dmat4 up = pose_of({{0, 0, 0}, 30.0, 90.0, 10.0, 1.0, false});
    EXPECT_LT(distance(pose_of(numbers_of(up)), up), 1e-6);
}

TEST(ViewerHistory, AGestureIsUndoneAsOne) {
    History history{two_lamps(), {}, {}, 0};
    for (const double dim : {0.9, 0.8, 0.7})
        edit(history, SetDim{0, dim}, 5);
    edit(history, SetOn{1, false});
    ASSERT_TRUE(undo(history));
    EXPECT_TRUE(history.now.lamps[1].luminaire.on);
    EXPECT_EQ(history.now.lamps[0].luminaire.dim, 0.7);
    ASSERT_TRUE(undo(history));
    EXPECT_EQ(history.now.lamps[0].luminaire.dim, 1.0);
    EXPECT_FALSE(undo(history));
    ASSERT_TRUE(redo(history));
    ASSERT_TRUE(redo(history));
    EXPECT_FALSE(history.now.lamps[1].luminaire.on);
    EXPECT_EQ(history.now.lamps[0].luminaire.dim, 0.7);
    EXPECT_FALSE(redo(history));
}

// Lights are known by ids: one that was undone must not come back as another lamp's.
TEST(ViewerHistory, IdsAreNeverGivenTwice) {
    History history{two_lamps(), {}, {}, 0};
    edit(history, Duplicate{0, {1, 0, 0}});
    const int first = history.now.lamps.back().id;
    undo(history);
    edit(history, Duplicate{1, {2, 0, 0}});
    EXPECT_NE(history.now.lamps.back().id, first);
}

}  // namespace
}  // namespace nearfield::viewer
