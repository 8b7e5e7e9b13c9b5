// SPDX-License-Identifier: Apache-2.0
// What is written is read back: tables, symmetries, openings and what is said beside.
#include "formats/files/error.h"
#include "formats/photometry/photometric_file.h"
#include "formats/photometry/symmetry.h"
#include "tests/photometry/lamp_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nearfield {
namespace {

using photometry::Coordinates;
using photometry::FileFormat;
using photometry::Photometry;
using photometry::Shape;
using photometry::Symmetry;

Photometry through(const Photometry& lamp, FileFormat format) {
    photometry::write_photometry(lamp, format, "again.txt");
    return photometry::read_photometry("again.txt");
}

// EULUMDAT holds candela for 1000 lm: a division and a multiplication lose a last bit each.
void expect_same_table(const Photometry& a, const Photometry& b) {
    EXPECT_EQ(a.coordinates, b.coordinates);
    ASSERT_EQ(a.planes_deg.size(), b.planes_deg.size());
    for (std::size_t p = 0; p < a.planes_deg.size(); ++p)
        EXPECT_NEAR(a.planes_deg[p], b.planes_deg[p], 1e-12);
    ASSERT_EQ(a.angles_deg, b.angles_deg);
    for (std::size_t k = 0; k < a.intensity_cd.size(); ++k)
        ASSERT_NEAR(a.intensity_cd[k], b.intensity_cd[k], 1e-15 * a.intensity_cd[k]) << k;
}

// A random table with the symmetry, in steps of 22.5 degrees.
Photometry random_lamp(Symmetry symmetry, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1000);
    Photometry lamp;
    const auto [first, last] = symmetry == Symmetry::Axial      ? std::pair{0.0, 0.0}
                               : symmetry == Symmetry::AcrossC0 ? std::pair{0.0, 180.0}
                               : symmetry == Symmetry::AcrossC90
                                   ? std::pair{90.0, 270.0}
                                   : std::pair{0.0, symmetry == Symmetry::Quadrants ? 90.0 : 360.0};
    lamp.planes_deg = test::steps(first, last, 22.5);
    lamp.angles_deg = {0, 10.25, 33, 90};
    for (std::size_t k = 0; k < lamp.planes_deg.size() * lamp.angles_deg.size(); ++k)
        lamp.intensity_cd.push_back(uniform(random));
    if (symmetry == Symmetry::None)
        for (std::size_t a = 0; a < lamp.angles_deg.size(); ++a)
            lamp.at(lamp.planes_deg.size() - 1, a) = lamp.at(0, a);
    unfold(lamp, symmetry);
    lamp.lamps = {{2, 1234.5, "LED", "", "", 17.5}};
    lamp.labels = {{"TEST", "1"},    {"TESTLAB", "x"}, {"ISSUEDATE", "today"},
                   {"MANUFAC", "y"}, {"LAMP", "LED"},  {"OTHER", "one\ntwo"}};
    return lamp;
}

class RoundTrip : public testing::TestWithParam<Symmetry> {};

TEST_P(RoundTrip, KeepsTableAndSymmetry) {
    const Photometry lamp = random_lamp(GetParam(), 3);
    EXPECT_EQ(symmetry_of(lamp), GetParam());
    for (const FileFormat format : {FileFormat::Lm63, FileFormat::Eulumdat, FileFormat::Tm33}) {
        const Photometry again = through(lamp, format);
        expect_same_table(lamp, again);
        EXPECT_EQ(symmetry_of(again), GetParam());
        EXPECT_EQ(again.lamps[0].flux_lm, 1234.5);
        EXPECT_EQ(again.lamps[0].count, 2);
        EXPECT_EQ(again.lamps[0].type, "LED");
        EXPECT_EQ(again.lamps[0].input_w, 17.5);
        EXPECT_FALSE(again.is_absolute);
    }
    EXPECT_EQ(through(lamp, FileFormat::Lm63).labels, lamp.labels);
}

INSTANTIATE_TEST_SUITE_P(OfEverySymmetry,
                         RoundTrip,
                         testing::Values(Symmetry::None,
                                         Symmetry::Axial,
                                         Symmetry::AcrossC0,
                                         Symmetry::AcrossC90,
                                         Symmetry::Quadrants));

TEST(RoundTrip, SymmetryLeavesPlanesOut) {
    const auto rows = [](Symmetry symmetry) {
        const Photometry lamp = random_lamp(symmetry, 5);
        return planes_kept(lamp, symmetry).size();
    };
    EXPECT_EQ(rows(Symmetry::None), 17U);
    EXPECT_EQ(rows(Symmetry::AcrossC0), 9U);
    EXPECT_EQ(rows(Symmetry::AcrossC90), 9U);
    EXPECT_EQ(rows(Symmetry::Quadrants), 5U);
    EXPECT_EQ(rows(Symmetry::Axial), 1U);
}

TEST(RoundTrip, KeepsTypesAAndBInLm63AndTm33) {
    for (const Coordinates coordinates : {Coordinates::A, Coordinates::B}) {
        const Photometry lamp = photometry::read_photometry(
            test::write_text("skew.ies", to_text(test::skew_lm63(coordinates, 15))));
        expect_same_table(lamp, through(lamp, FileFormat::Lm63));
        expect_same_table(lamp, through(lamp, FileFormat::Tm33));
        EXPECT_THROW(through(lamp, FileFormat::Eulumdat), Error);
    }
}

TEST(RoundTrip, KeepsOpeningsTiltAndAbsoluteLight) {
    Photometry lamp = random_lamp(Symmetry::None, 9);
    lamp.is_absolute = true;
    lamp.tilt = photometry::Tilt{3, {0, 90}, {1, 0.7}};
    for (const Shape shape :
         {Shape::Rectangle, Shape::Ellipse, Shape::CylinderX, Shape::CylinderY, Shape::Ellipsoid}) {
        lamp.opening = {shape, {0.3, 0.2, 0.1}, {}};
        const Photometry in_xml = through(lamp, FileFormat::Tm33);
        EXPECT_EQ(in_xml.opening.shape, shape);
        EXPECT_LT(glm::length(in_xml.opening.size_m - lamp.opening.size_m), 1e-15);
        EXPECT_TRUE(in_xml.is_absolute);
        const Photometry again = through(lamp, FileFormat::Lm63);
        EXPECT_EQ(again.opening.shape, shape);
        EXPECT_EQ(again.opening.size_m, lamp.opening.size_m);
        EXPECT_TRUE(again.is_absolute);
        ASSERT_TRUE(again.tilt);
        EXPECT_EQ(again.tilt->factors, lamp.tilt->factors);
    }
    lamp.opening = {Shape::Rectangle, {0.3, 0.2, 0.1}, {0.1, 0.05, 0.02, 0}};
    lamp.housing_m = {0.5, 0.4, 0.2};
    lamp.tilt_when_measured_deg = 15;
    lamp.utilances[3] = 0.77;
    const Photometry again = through(lamp, FileFormat::Eulumdat);
    EXPECT_TRUE(again.is_absolute);
    EXPECT_EQ(again.opening.shape, Shape::Rectangle);
    EXPECT_LT(glm::length(again.opening.size_m - lamp.opening.size_m), 1e-15);
    EXPECT_LT(glm::length(again.housing_m - lamp.housing_m), 1e-15);
    EXPECT_DOUBLE_EQ(again.opening.sides_m[1], 0.05);
    EXPECT_EQ(again.tilt_when_measured_deg, 15);
    EXPECT_EQ(again.utilances, lamp.utilances);
}

TEST(RoundTrip, WhatAFormatCannotTellIsRefused) {
    Photometry lamp = random_lamp(Symmetry::None, 11);
    lamp.at(0, 2) += 1;  // C0 and C360 differ
    expect_same_table(lamp, through(lamp, FileFormat::Lm63));
    EXPECT_THROW(through(lamp, FileFormat::Eulumdat), Error);
    lamp.coordinates = Coordinates::A;
    lamp.planes_deg = {0, 90};
    lamp.intensity_cd.resize(8);
    EXPECT_THROW(through(lamp, FileFormat::Lm63), Error);
}

}  // namespace
}  // namespace nearfield
