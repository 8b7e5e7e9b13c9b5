// SPDX-License-Identifier: Apache-2.0
// The lens' formulas against OpenCV's, their inverse, and where that ends.
#include "formats/rig/lens.h"

#include "tests/calibrate/simulated.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include <cmath>
#include <string>

namespace nearfield::rig {
namespace {

using test::simulated_lens;

constexpr LensModel kModels[] = {LensModel::Brown5, LensModel::Brown8, LensModel::Fisheye};

glm::dvec2 opencv_px(const Lens& lens, glm::dvec3 p) {
    const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px - 0.5, 0, lens.fy_px, lens.cy_px - 0.5, 0, 0,
                             1);
    const std::vector<cv::Point3d> points = {{p.x, p.y, p.z}};
    std::vector<cv::Point2d> seen;
    const cv::Vec3d none(0, 0, 0);
    if (lens.model == LensModel::Fisheye)
        cv::fisheye::projectPoints(points, seen, none, none, matrix, lens.distortion);
    else
        cv::projectPoints(points, none, none, matrix, lens.distortion, seen);
    return glm::dvec2(seen[0].x, seen[0].y) + 0.5;
}

TEST(Lens, ProjectsAsOpenCvDoesHalfAPixelOff) {
    for (const LensModel model : kModels) {
        const Lens lens = simulated_lens(model);
        support::Random random{3};
        for (int i = 0; i < 2000; ++i) {
            const double z = random.uniform(0.2, 3.0);
            const glm::dvec3 p(z * random.uniform(-0.5, 0.5), z * random.uniform(-0.5, 0.5), z);
            const auto at = project_px(lens, p);
            ASSERT_TRUE(at);
            EXPECT_LT(glm::length(*at - opencv_px(lens, p)), 1e-10);  // rounding of 800 px
        }
    }
}

TEST(Lens, RayIsTheInverseOfProjection) {
    for (const LensModel model : kModels) {
        const Lens lens = simulated_lens(model);
        for (double y = 0.0; y <= 512.0; y += 16.0) {
            for (double x = 0.0; x <= 512.0; x += 16.0) {
                const auto ray = ray_camera(lens, {x, y});
                ASSERT_TRUE(ray) << x << " " << y;
                EXPECT_EQ(ray->z, 1.0);
                EXPECT_LT(glm::length(*project_px(lens, *ray) - glm::dvec2(x, y)), 1e-10);
            }
        }
        const auto axis = ray_camera(lens, {lens.cx_px, lens.cy_px});
        EXPECT_LT(glm::length(glm::dvec2(*axis)), 1e-15);
    }
}

TEST(Lens, FisheyeSeesFarToTheSide) {
    Lens lens = simulated_lens(LensModel::Fisheye);
    lens.fx_px = lens.fy_px = 170;
    for (const double angle : {0.1, 0.7, 1.2, 1.5, 1.56}) {
        const glm::dvec3 p(std::sin(angle) * 0.6, std::sin(angle) * 0.8, std::cos(angle));
        const auto ray = ray_camera(lens, *project_px(lens, p));
        ASSERT_TRUE(ray) << angle;
        EXPECT_LT(glm::length(glm::normalize(*ray) - p), 1e-12) << angle;
    }
    EXPECT_FALSE(ray_camera(lens, {255.0, 700.0})) << "beyond 90 degrees";
}

TEST(Lens, NothingIsSeenBehind) {
    for (const LensModel model : kModels) {
        EXPECT_FALSE(project_px(simulated_lens(model), {0.1, 0.1, 0.0}));
        EXPECT_FALSE(project_px(simulated_lens(model), {0.1, 0.1, -1.0}));
    }
}

// r (1 - 0.4 r^2) rises to 0.6086 at r = 0.9129 and falls again: beyond, there is no ray, and just
// below, there are two; the one before the fold is meant.
TEST(Lens, NoRayBehindTheFold) {
    Lens lens = simulated_lens(LensModel::Brown5);
    lens.cx_px = lens.cy_px = 0.0;
    lens.fx_px = lens.fy_px = 1000.0;
    lens.distortion = {-0.4, 0, 0, 0, 0};
    for (const double r : {0.2, 0.6, 0.85, 0.9, 0.912}) {
        const double seen_px = 1000.0 * r * (1.0 - 0.4 * r * r);
        const auto ray = ray_camera(lens, {0.6 * seen_px, 0.8 * seen_px});
        ASSERT_TRUE(ray) << r;
        EXPECT_NEAR(glm::length(glm::dvec2(*ray)), r, 1e-9) << r;
    }
    for (const double seen_px : {608.7, 620.0, 700.0, 2000.0})
        EXPECT_FALSE(ray_camera(lens, {0.6 * seen_px, 0.8 * seen_px})) << seen_px;
    // Here the polynomial rises again after its fold: what it shows there is no picture.
    lens.distortion = {-0.8, 0.25, 0, 0, 0};
    EXPECT_TRUE(ray_camera(lens, {400.0, 0.0}));
    EXPECT_FALSE(ray_camera(lens, {900.0, 0.0}));
    EXPECT_FALSE(ray_camera(lens, {2000.0, 0.0}));
}

}  // namespace
}  // namespace nearfield::rig
