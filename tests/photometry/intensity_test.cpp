// SPDX-License-Identifier: Apache-2.0
// Directions, lookups, flux and peak, on a lamp whose closed form has no symmetry.
#include "formats/photometry/intensity.h"

#include "formats/photometry/photometric_file.h"
#include "tests/photometry/lamp_files.h"
#include "tests/support/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace nearfield {
namespace {

using photometry::Angles;
using photometry::Coordinates;
using photometry::Photometry;

class Lookup : public testing::TestWithParam<Coordinates> {
  protected:
    static Photometry skew_lamp(double step_deg) {
        return photometry::read_photometry(
            test::write_text("skew.ies", to_text(test::skew_lm63(GetParam(), step_deg))));
    }
};

// The photometry's frame has +z down, +x east; right-handed, hence +y south.
glm::dvec3 frame_from(const glm::dvec3& east_north_up) {
    return {east_north_up.x, -east_north_up.y, -east_north_up.z};
}

TEST_P(Lookup, AnglesPointWhereTheStandardSays) {
    for (double plane = -80; plane <= 350; plane += 35)
        for (double angle = -85; angle <= 175; angle += 20) {
            const glm::dvec3 expected = frame_from(test::east_north_up(GetParam(), plane, angle));
            const glm::dvec3 d = photometry::direction_of(GetParam(), {plane, angle});
            EXPECT_LT(glm::length(d - expected), 1e-15) << plane << " " << angle;
            const Angles back = photometry::angles_of(GetParam(), 3.0 * d);
            EXPECT_LT(glm::length(photometry::direction_of(GetParam(), back) - d), 1e-15);
        }
}

// Bilinear interpolation over steps h errs by at most h^2 / 8 times each second derivative, at most
// 100 (0.3 + 0.2 + 0.4 + 4 * 0.25 / 2) here; the two angles add.
TEST_P(Lookup, FindsTheLampInEveryDirection) {
    constexpr double kStep_deg = 2;
    const Photometry lamp = skew_lamp(kStep_deg);
    const double h = kStep_deg * std::numbers::pi / 180;
    const double most = 2 * h * h / 8 * 140;
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    double worst = 0;
    for (int k = 0; k < 2000; ++k) {
        const glm::dvec3 d =
            glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
        worst = std::max(
            worst, std::abs(photometry::intensity_cd(lamp, frame_from(d)) - test::skew_lamp_cd(d)));
    }
    RecordProperty("worst_cd", std::to_string(worst));
    EXPECT_LT(worst, most);
}

// The error of the interpolant's flux falls with the step's square, and so its extrapolation to
// step 0 is better by two orders.
TEST_P(Lookup, FluxIsTheClosedForm) {
    const double expected = test::kSkewLampOverPi_lm * std::numbers::pi;
    const double coarse = photometry::flux_lm(skew_lamp(6)),
                 fine = photometry::flux_lm(skew_lamp(3));
    EXPECT_NEAR(fine, expected, 2e-3 * expected);
    EXPECT_NEAR((4 * fine - coarse) / 3, expected, 1e-5 * expected);
}

INSTANTIATE_TEST_SUITE_P(OfEveryType,
                         Lookup,
                         testing::Values(Coordinates::C, Coordinates::B, Coordinates::A));

TEST(Flux, DownwardsEndsInsideACell) {
    test::Lm63File file = test::skew_lm63(Coordinates::C, 4);  // 88, 92: none at 90
    const Photometry lamp =
        photometry::read_photometry(test::write_text("skew.ies", to_text(file)));
    const double expected = test::kSkewLampDownOverPi_lm * std::numbers::pi;
    EXPECT_NEAR(photometry::flux_lm(lamp, 90), expected, 2e-3 * expected);
    EXPECT_DOUBLE_EQ(photometry::flux_lm(lamp, 180), photometry::flux_lm(lamp));
}

// Solid angle by plane and angle, sr per square degree, from differences of directions.
double solid_angle_per_deg2(Coordinates coordinates, Angles at) {
    constexpr double kStep_deg = 1e-3;
    const auto slope = [&](double plane_deg, double angle_deg) {
        return (photometry::direction_of(coordinates,
                                         {at.plane_deg + plane_deg, at.angle_deg + angle_deg}) -
                photometry::direction_of(coordinates,
                                         {at.plane_deg - plane_deg, at.angle_deg - angle_deg})) /
               (2 * kStep_deg);
    };
    return glm::length(glm::cross(slope(kStep_deg, 0), slope(0, kStep_deg)));
}

// The interpolant's integral over one cell of the table by Gauss' rule.
double cell_lm(const Photometry& lamp, std::size_t p, std::size_t a) {
    static const support::GaussRule gauss = support::gauss_rule(12);
    const double plane_step = lamp.planes_deg[p + 1] - lamp.planes_deg[p];
    const double angle_step = lamp.angles_deg[a + 1] - lamp.angles_deg[a];
    double sum = 0;
    for (std::size_t i = 0; i < gauss.node.size(); ++i)
        for (std::size_t j = 0; j < gauss.node.size(); ++j) {
            const Angles at{lamp.planes_deg[p] + gauss.node[i] * plane_step,
                            lamp.angles_deg[a] + gauss.node[j] * angle_step};
            sum += gauss.weight[i] * gauss.weight[j] * plane_step * angle_step *
                   solid_angle_per_deg2(lamp.coordinates, at) * photometry::intensity_cd(lamp, at);
        }
    return sum;
}

// Random tables with uneven angles.
TEST(Flux, IsTheInterpolantsIntegral) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const Coordinates coordinates : {Coordinates::C, Coordinates::B, Coordinates::A}) {
        Photometry lamp;
        lamp.coordinates = coordinates;
        lamp.planes_deg = coordinates == Coordinates::C   ? std::vector<double>{0, 31, 170, 360}
                          : coordinates == Coordinates::B ? std::vector<double>{-90, -20, 5, 77}
                                                          : std::vector<double>{-150, 3, 4, 90};
        lamp.angles_deg = coordinates == Coordinates::C ? std::vector<double>{0, 1, 60, 111}
                                                        : std::vector<double>{-90, -60, 0, 2};
        for (int k = 0; k < 16; ++k)
            lamp.intensity_cd.push_back(uniform(random));
        double expected = 0;
        for (std::size_t p = 0; p < 3; ++p)
            for (std::size_t a = 0; a < 3; ++a)
                expected += cell_lm(lamp, p, a);
        // Floored by the differences: (1e-3 degrees)^2 / 6 = 5e-11.
        EXPECT_NEAR(photometry::flux_lm(lamp), expected, 1e-9 * expected);
    }
}

TEST(Peak, IsTheLargestEntry) {
    Photometry lamp;
    lamp.planes_deg = {0, 90, 360};
    lamp.angles_deg = {0, 45};
    lamp.intensity_cd = {1, 2, 3, 7, 5, 6};
    const photometry::Peak peak = photometry::peak(lamp);
    EXPECT_EQ(peak.intensity_cd, 7);
    EXPECT_EQ(peak.angles.plane_deg, 90);
    EXPECT_EQ(peak.angles.angle_deg, 45);
}

TEST(Lookup, IsDarkWhereTheFileHasNoAnglesAndTurnsAround) {
    Photometry lamp;
    lamp.planes_deg = {0, 180, 360};
    lamp.angles_deg = {0, 90};
    lamp.intensity_cd = {4, 4, 4, 8, 4, 6};
    EXPECT_EQ(photometry::intensity_cd(lamp, Angles{0, 90.01}), 0);
    EXPECT_EQ(photometry::intensity_cd(lamp, Angles{-180, 90}), 8);
    EXPECT_EQ(photometry::intensity_cd(lamp, Angles{540, 90}), 8);
    EXPECT_EQ(photometry::intensity_cd(lamp, Angles{90, 45}), 5);
    EXPECT_EQ(photometry::intensity_cd(lamp, Angles{360, 90}), 6);
}

}  // namespace
}  // namespace nearfield
