// SPDX-License-Identifier: Apache-2.0
// A light field of a photometry has its intensity, and its illuminance is that of an opening whose
// points all shine as the lamp does, integrated here by the definition.
#include "formats/photometry/to_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"
#include "tests/photometry/lamp_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace nearfield {
namespace {

using photometry::Coordinates;
using photometry::Photometry;
using photometry::Shape;

Photometry skew_lamp(Coordinates coordinates, Shape shape) {
    Photometry lamp = photometry::read_photometry(
        test::write_text("skew.ies", to_text(test::skew_lm63(coordinates, 2))));
    lamp.opening = {shape, {0.3, 0.2, 0.25}, {}};
    return lamp;
}

// Directions within the half angle, in the luminaire's frame.
std::vector<glm::dvec3> directions() {
    std::vector<glm::dvec3> list;
    for (const double x : {-1.2, -0.3, 0.0, 0.7})
        for (const double y : {-0.9, 0.1, 1.3})
            list.push_back(glm::normalize(glm::dvec3(x, y, 1)));
    return list;
}

double seen_cd(const Photometry& lamp, const glm::dvec3& d_luminaire) {
    return photometry::intensity_cd(
        lamp, glm::transpose(luminaire_from_photometry(lamp.coordinates)) * d_luminaire);
}

// C is constant on a texel of width p, where I cos^3 has a slope: what is left of that sawtooth in
// a mean over a window of width w of S is at most slope p^2 / (8 w), along x and y each. In
// tangents the slope of log (I cos^3) is at most 1.5 + |grad I| / I = 1.5 + 115 / 75 here.
double most_error(const Slab& slab, glm::dvec2 window_m) {
    constexpr double kSlope = 3;
    const glm::dvec2 p_m = slab.texel_m();
    return kSlope / slab.delta_m / 8 * (p_m.x * p_m.x / window_m.x + p_m.y * p_m.y / window_m.y);
}

double worst_intensity_error(const Photometry& lamp, const LightField& field) {
    double worst = 0;
    for (const glm::dvec3& d : directions())
        worst = std::max(worst, std::abs(model::intensity(field, d).y / seen_cd(lamp, d) - 1));
    return worst;
}

// E = int I(d) / A max(0, -n.d) / r^2 over the opening, by midpoints.
double opening_lx(const Photometry& lamp, const Slab& slab, const model::Receiver& receiver) {
    const glm::dvec2 size_m = slab.pitch_m * glm::dvec2(slab.grid);
    constexpr int kNodes = 200;
    double sum = 0;
    int count = 0;
    for (int i = 0; i < kNodes; ++i)
        for (int j = 0; j < kNodes; ++j) {
            const glm::dvec2 at = (glm::dvec2(i, j) + 0.5) / double(kNodes) - 0.5;
            if (lamp.opening.shape == Shape::Ellipsoid && glm::length(at) > 0.5)
                continue;
            const glm::dvec3 ray = receiver.position_m - glm::dvec3(at * size_m, -slab.delta_m);
            const glm::dvec3 d = glm::normalize(ray);
            ++count;
            sum += seen_cd(lamp, d) * std::max(0.0, -glm::dot(receiver.normal, d)) /
                   glm::dot(ray, ray);
        }
    return sum / count;
}

class FarField : public testing::TestWithParam<Coordinates> {};

TEST_P(FarField, IntensityIsThePhotometrys) {
    const Photometry lamp = skew_lamp(GetParam(), Shape::Rectangle);
    const auto error_of = [&](int texels) {
        photometry::LightFieldOptions options;
        options.slabs = 1;
        options.texels = texels;
        const LightField field = photometry::to_lightfield(lamp, options).lightfield;
        const Slab& slab = field.slabs[0];
        const double worst = worst_intensity_error(lamp, field);
        RecordProperty("worst_" + std::to_string(texels), std::to_string(worst));
        EXPECT_LT(worst, most_error(slab, slab.pitch_m * glm::dvec2(slab.grid)));
        return worst;
    };
    EXPECT_LT(error_of(256), error_of(64) / 4);
}

// Near and far, before and behind S: through a point, the opening's window on S is the opening
// times |distance from S| / distance.
TEST_P(FarField, IlluminanceIsThatOfTheOpening) {
    for (const Shape shape : {Shape::Rectangle, Shape::Ellipsoid}) {
        const Photometry lamp = skew_lamp(GetParam(), shape);
        photometry::LightFieldOptions options;
        options.slabs = 1;
        options.texels = 128;
        options.cells = 8;  // an ellipse's edge is as coarse as a cell
        const LightField field = photometry::to_lightfield(lamp, options).lightfield;
        const Slab& slab = field.slabs[0];
        const glm::dvec3 normal = glm::normalize(glm::dvec3(0.2, -0.1, -1));
        for (const double distance_m : {0.6, 1.5, 20.0})
            for (const glm::dvec2 tangent : {glm::dvec2(0, 0), glm::dvec2(0.5, -0.8)}) {
                const double from_s_m = distance_m - slab.delta_m;
                const model::Receiver receiver{{distance_m * tangent, from_s_m}, normal};
                const double expected = opening_lx(lamp, slab, receiver);
                const glm::dvec2 window_m =
                    std::abs(from_s_m) / distance_m * slab.pitch_m * glm::dvec2(slab.grid);
                EXPECT_NEAR(model::irradiance(field, receiver).y, expected,
                            most_error(slab, window_m) * expected)
                    << distance_m << " m, tangent " << tangent.x;
            }
    }
}

INSTANTIATE_TEST_SUITE_P(OfEveryType,
                         FarField,
                         testing::Values(Coordinates::C, Coordinates::B, Coordinates::A));

// The flux within |t_x|, |t_y| < tan 60, by midpoints in the tangent plane: dw = cos^3 dt.
TEST(FarLightField, KeepsTheFluxWithinTheHalfAngle) {
    const Photometry lamp = skew_lamp(Coordinates::C, Shape::Ellipse);
    photometry::LightFieldOptions options;
    options.slabs = 1;
    options.half_angle_deg = 60;
    options.delta_sides = 1000;  // so that the opening's size hardly widens S
    options.texels = 128;
    const auto far = photometry::to_lightfield(lamp, options);
    constexpr int kNodes = 400;
    const double most = std::tan(std::numbers::pi / 3), step = 2 * most / kNodes;
    double expected = 0;
    for (int i = 0; i < kNodes; ++i)
        for (int j = 0; j < kNodes; ++j) {
            const glm::dvec3 d =
                glm::normalize(glm::dvec3((i + 0.5) * step - most, (j + 0.5) * step - most, 1));
            expected += step * step * d.z * d.z * d.z * seen_cd(lamp, d);
        }
    EXPECT_NEAR(far.lightfield_lm, expected, 1e-3 * expected);
    EXPECT_DOUBLE_EQ(far.photometry_lm, photometry::flux_lm(lamp));
}

// A lamp that shines all around, without symmetry: with six slabs nothing is lost, and what slabs
// share adds up, in their middles, between two and in corners.
TEST_P(FarField, SixSlabsHoldAllLight) {
    const Photometry lamp = skew_lamp(GetParam(), Shape::Rectangle);
    photometry::LightFieldOptions options;
    options.texels = 128;
    const auto far = photometry::to_lightfield(lamp, options);
    ASSERT_EQ(far.lightfield.slabs.size(), 6U);  // chosen: five would lose a sixth
    EXPECT_GT(far.least_lost_deg, far.most_lost_deg);
    EXPECT_NEAR(far.lightfield_lm, far.photometry_lm, 1e-3 * far.photometry_lm);
    for (const glm::dvec3& d :
         {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0.1), glm::dvec3(-1, 0.2, 0), glm::dvec3(0, 1, 0.2),
          glm::dvec3(0.1, -1, 0), glm::dvec3(0.1, 0.2, -1), glm::dvec3(1, 0.95, 0.1),
          glm::dvec3(1, -1, 1), glm::dvec3(-1, -0.97, -1), glm::dvec3(0.3, 1, -1.02)}) {
        const glm::dvec3 direction = glm::normalize(d);
        const double expected = seen_cd(lamp, direction);
        EXPECT_NEAR(model::intensity(far.lightfield, direction).y, expected, 0.01 * expected)
            << d.x << " " << d.y << " " << d.z;
    }
}

TEST(FarLightField, FiveSlabsLoseWhatGoesBackwards) {
    const Photometry lamp = skew_lamp(Coordinates::C, Shape::Rectangle);
    photometry::LightFieldOptions options;
    options.texels = 64;
    options.slabs = 5;
    const auto far = photometry::to_lightfield(lamp, options);
    EXPECT_NEAR(far.least_lost_deg, 180 - std::atan(std::sqrt(2)) * 180 / std::numbers::pi, 1);
    EXPECT_NEAR(far.most_lost_deg, 180, 1);
    EXPECT_LT(far.lightfield_lm, 0.9 * far.photometry_lm);
}

// A headlamp of type A: forwards, right and up of the photometry are +z, -x and +y of the
// luminaire.
TEST(FarLightField, TurnsTypeAsBeamForwards) {
    const glm::dmat3 turn = photometry::luminaire_from_photometry(Coordinates::A);
    const auto at = [&](double h_deg, double v_deg) {
        return turn * photometry::direction_of(Coordinates::A, {h_deg, v_deg});
    };
    EXPECT_LT(glm::length(at(0, 0) - glm::dvec3(0, 0, 1)), 1e-15);
    EXPECT_LT(glm::length(at(90, 0) - glm::dvec3(-1, 0, 0)), 1e-15);
    EXPECT_LT(glm::length(at(0, 90) - glm::dvec3(0, 1, 0)), 1e-15);
    EXPECT_NEAR(glm::determinant(turn), 1, 1e-15);
}

TEST(FarLightField, APointAsksForASize) {
    Photometry lamp = skew_lamp(Coordinates::C, Shape::Point);
    lamp.opening.size_m = {0, 0, 0};
    EXPECT_THROW(photometry::to_lightfield(lamp), Error);
    photometry::LightFieldOptions options;
    options.slabs = 1;
    options.opening_m = {0.1, 0.1};
    options.texels = 16;
    EXPECT_GT(photometry::to_lightfield(lamp, options).lightfield_lm, 0);
    options.half_angle_deg = 90;
    EXPECT_THROW(photometry::to_lightfield(lamp, options), Error);
}

}  // namespace
}  // namespace nearfield
