// SPDX-License-Identifier: Apache-2.0
// LM-63: what each edition says comes out, and what it does not allow is refused with its line.
#include "formats/files/error.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/lm63_opening.h"
#include "formats/photometry/photometric_file.h"
#include "tests/photometry/lamp_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

using photometry::Coordinates;
using photometry::Photometry;
using photometry::Shape;

Photometry read(const test::Lm63File& file) {
    return photometry::read_photometry(test::write_text("lamp.ies", to_text(file)));
}

// Two angles, one plane: 5 cd down, 3 cd across.
test::Lm63File small_file() {
    test::Lm63File file;
    file.angles = {0, 90};
    file.planes = {0};
    file.intensities = {5, 3};
    return file;
}

TEST(Lm63, FirstLineTellsTheEdition) {
    for (const auto& [line, format] : {std::pair{"IESNA91", "LM-63-1991"},
                                       {"IESNA:LM-63-1995", "LM-63-1995"},
                                       {"IESNA:LM-63-2002", "LM-63-2002"},
                                       {"IES:LM-63-2019", "LM-63-2019"},
                                       {"a label", "LM-63-1986"}}) {
        test::Lm63File file = small_file();
        file.first_line = line;
        EXPECT_EQ(read(file).format, format);
    }
}

TEST(Lm63, AByteOrderMarkIsNoLabel) {
    const std::string text = "\xEF\xBB\xBF" + to_text(small_file());
    EXPECT_EQ(photometry::read_photometry(test::write_text("mark.ies", text)).format, "LM-63-2002");
}

TEST(Lm63, LabelsKeepTheirLines) {
    test::Lm63File file = small_file();
    file.labels = {"[TEST]17", "[OTHER] one", "[MORE] two", "no keyword"};
    const Photometry lamp = read(file);
    EXPECT_EQ(photometry::label(lamp, "TEST"), "17");
    EXPECT_EQ(photometry::label(lamp, "OTHER"), "one\ntwo");
    EXPECT_EQ(photometry::label(lamp, ""), "no keyword");
}

TEST(Lm63, FactorsMultiplyAsTheirEditionSays) {
    test::Lm63File file = small_file();
    file.multiplier = "2";
    file.factors = "0.5 0.1 10";
    EXPECT_DOUBLE_EQ(read(file).intensity_cd[0], 5);  // 2002: the third is for the future
    file.first_line = "IESNA91";
    EXPECT_DOUBLE_EQ(read(file).intensity_cd[0], 0.5);
}

TEST(Lm63, LumensTellAbsoluteFromRelative) {
    test::Lm63File file = small_file();
    file.lamps = "3 700";
    EXPECT_FALSE(read(file).is_absolute);
    EXPECT_EQ(read(file).lamps[0].flux_lm, 2100);
    file.lamps = "1 -1";
    EXPECT_TRUE(read(file).is_absolute);
}

TEST(Lm63, FeetBecomeMeters) {
    test::Lm63File file = small_file();
    file.opening = "1 2 0";
    EXPECT_EQ(read(file).opening.size_m, glm::dvec3(2, 1, 0));  // the length is along x
    file.unit = "1";
    EXPECT_EQ(read(file).opening.size_m, glm::dvec3(2 * 0.3048, 0.3048, 0));
}

struct OpeningCase {
    int year;
    glm::dvec3 width_length_height;
    Shape shape;
    glm::dvec3 size_m;
};

TEST(Lm63, SignsTellTheOpening) {
    for (const OpeningCase& c : std::vector<OpeningCase>{
             {1991, {0, 0, 0}, Shape::Point, {0, 0, 0}},
             {1991, {2, 3, 0}, Shape::Rectangle, {3, 2, 0}},
             {1991, {-2, 0, 0}, Shape::Ellipse, {2, 2, 0}},
             {1991, {-2, 3, 4}, Shape::Ellipsoid, {3, 2, 4}},
             {1995, {-2, 0, -2}, Shape::Ellipsoid, {2, 2, 2}},
             {1995, {-2, 0, 4}, Shape::Ellipse, {2, 2, 4}},
             {1995, {0, 3, -2}, Shape::CylinderX, {3, 2, 2}},
             {1995, {3, 0, -2}, Shape::CylinderY, {2, 3, 2}},
             {1995, {-2, 3, 4}, Shape::Ellipse, {3, 2, 4}},
             {1995, {3, -2, 4}, Shape::Ellipse, {2, 3, 4}},
             {1995, {-2, 3, -4}, Shape::Ellipsoid, {3, 2, 4}},
             {1995, {-2, -2, 0}, Shape::Ellipse, {2, 2, 0}},  // written as 2002 has it
             {2002, {-2, 0, 0}, Shape::Ellipse, {2, 2, 0}},   // written as 1995 has it
             {2002, {-2, -2, 0}, Shape::Ellipse, {2, 2, 0}},
             {2002, {-2, -3, 4}, Shape::Ellipse, {3, 2, 4}},
             {2002, {-2, -3, -4}, Shape::Ellipsoid, {3, 2, 4}},
             {2002, {-2, 3, -2}, Shape::CylinderX, {3, 2, 2}},
             {2019, {3, -2, -2}, Shape::CylinderY, {2, 3, 2}},
             {2019, {-2, 0, -3}, Shape::UprightEllipse, {0, 2, 3}},
         }) {
        const glm::dvec3& s = c.width_length_height;
        const auto opening = photometry::opening_of_signs(c.year, s.x, s.y, s.z);
        ASSERT_TRUE(opening) << c.year << " " << s.x << " " << s.y << " " << s.z;
        EXPECT_EQ(opening->shape, c.shape) << c.year << " " << s.x << " " << s.y << " " << s.z;
        EXPECT_EQ(opening->size_m, c.size_m) << c.year << " " << s.x << " " << s.y << " " << s.z;
        const glm::dvec3 signs = photometry::signs_of_opening(*opening);
        const auto again = photometry::opening_of_signs(2002, signs.x, signs.y, signs.z);
        ASSERT_TRUE(again);
        EXPECT_EQ(again->shape, opening->shape);
        EXPECT_EQ(again->size_m, opening->size_m);
    }
    for (const int year : {1986, 1995, 2019}) {
        EXPECT_FALSE(photometry::opening_of_signs(year, 0, -2, 0));
        EXPECT_FALSE(photometry::opening_of_signs(year, 0, 0, -2));
        EXPECT_FALSE(photometry::opening_of_signs(year, 2, 3, -4));
    }
}

// Planes 0 ... 90, 0 ... 180, 90 ... 270: what is left out mirrors what is there.
TEST(Lm63, LastPlaneTellsTheSymmetry) {
    test::Lm63File file = small_file();
    file.planes = {0, 30, 90};
    file.intensities = {5, 1, 5, 2, 5, 3};
    Photometry lamp = read(file);
    EXPECT_EQ(lamp.planes_deg, (std::vector<double>{0, 30, 90, 150, 180, 210, 270, 330, 360}));
    for (const double plane : {30, 150, 210, 330})
        EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{plane, 90}), 2);
    file.planes = {0, 30, 180};
    lamp = read(file);
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{330, 90}), 2);
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{180, 90}), 3);
    file.planes = {90, 120, 270};
    lamp = read(file);
    // C180 is not there, and so C0 is between C270 and C60.
    EXPECT_EQ(lamp.planes_deg, (std::vector<double>{0, 60, 90, 120, 270, 360}));
    EXPECT_NEAR(photometry::intensity_cd(lamp, photometry::Angles{0, 90}), 3 - 90.0 / 150, 1e-12);
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{60, 90}), 2);
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{90, 90}), 1);
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{270, 90}), 3);
}

TEST(Lm63, HalvesOfTypesAAndBMirrorToNegativeAngles) {
    test::Lm63File file = small_file();
    file.planes = {0, 30, 90};
    file.intensities = {5, 1, 5, 2, 5, 3};
    for (const char* type : {"2", "3"}) {
        file.type = type;
        const Photometry lamp = read(file);
        EXPECT_EQ(lamp.planes_deg, (std::vector<double>{-90, -30, 0, 30, 90}));
        EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{-30, 90}), 2);
    }
}

TEST(Lm63, TiltIsReadFromTheFileOrFromOneBesideIt) {
    test::Lm63File file = small_file();
    file.tilt = "TILT=INCLUDE\r\n2\r\n3\r\n0 45 90\r\n1 0.9 0.8";
    const auto expect = [](const Photometry& lamp) {
        ASSERT_TRUE(lamp.tilt);
        EXPECT_EQ(lamp.tilt->lamp_geometry, 2);
        EXPECT_EQ(lamp.tilt->angles_deg, (std::vector<double>{0, 45, 90}));
        EXPECT_EQ(lamp.tilt->factors, (std::vector<double>{1, 0.9, 0.8}));
        EXPECT_EQ(lamp.intensity_cd[0], 5);
    };
    expect(read(file));
    test::write_text("lamp.tlt", "2\n3\n0 45 90\n1 0.9 0.8\n");
    file.tilt = "TILT=lamp.tlt";
    expect(read(file));
}

TEST(Lm63, ACircleWithoutItsLastPlaneIsClosedAndSaidSo) {
    test::Lm63File file = small_file();
    file.planes = {0, 120, 240};
    file.intensities = {5, 1, 5, 2, 5, 3};
    const Photometry lamp = read(file);
    EXPECT_EQ(lamp.planes_deg, (std::vector<double>{0, 120, 240, 360}));
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{360, 90}), 1);
    EXPECT_THAT(lamp.notes, testing::ElementsAre(testing::HasSubstr("360")));
}

struct Refusal {
    const char* what;
    void (*damage)(test::Lm63File&);
    int line;  // counted from 1; first, two labels, TILT, lamps, factors, angles, planes, rows
    const char* expected;
    const char* got;
};

class Lm63Refuses : public testing::TestWithParam<Refusal> {};

TEST_P(Lm63Refuses, WithLineExpectedAndGot) {
    test::Lm63File file = small_file();
    GetParam().damage(file);
    try {
        read(file);
        FAIL() << GetParam().what << " was read";
    } catch (const Error& error) {
        EXPECT_THAT(error.what_, testing::HasSubstr(GetParam().what));
        EXPECT_EQ(error.where, "lamp.ies, line " + std::to_string(GetParam().line));
        EXPECT_THAT(error.expected, testing::HasSubstr(GetParam().expected));
        EXPECT_THAT(error.got, testing::HasSubstr(GetParam().got));
    }
}

using F = test::Lm63File;
INSTANTIATE_TEST_SUITE_P(
    EveryField,
    Lm63Refuses,
    testing::Values(
        Refusal{"edition", [](F& f) { f.first_line = "IESNA:LM-63-2042"; }, 1, "2019", "2042"},
        Refusal{"tilt", [](F& f) { f.tilt = "TILT=../x"; }, 4, "same folder", "../x"},
        Refusal{"lamp to luminaire", [](F& f) { f.tilt = "TILT=INCLUDE\n4\n"; }, 5, "1 ... 3", "4"},
        Refusal{"number of lamps", [](F& f) { f.lamps = "1.5 1"; }, 5, "whole", "1.5"},
        Refusal{"number of lamps", [](F& f) { f.lamps = "0 1"; }, 5, "1 ...", "0"},
        Refusal{"lumens", [](F& f) { f.lamps = "1 -2"; }, 5, "-1", "-2"},
        Refusal{"multiplier", [](F& f) { f.multiplier = "0"; }, 5, "> 0", "0"},
        Refusal{"photometric type", [](F& f) { f.type = "4"; }, 5, "1 ... 3", "4"},
        Refusal{"unit", [](F& f) { f.unit = "m"; }, 5, "a number", "'m'"},
        Refusal{"opening", [](F& f) { f.opening = "1 2 -3"; }, 5, "edition", "height -3 m"},
        Refusal{"ballast", [](F& f) { f.factors = "-1 1 1"; }, 6, "> 0", "-1"},
        Refusal{"watts", [](F& f) { f.factors = "1 1 nan"; }, 6, "a number", "nan"},
        Refusal{"vertical angles",
                [](F& f) {
                    f.angles = {90, 0};
                },
                7, "ascending", "0 as number 2"},
        Refusal{"vertical angles",
                [](F& f) {
                    f.angles = {0, 181};
                },
                7, "0 ... 180", "181"},
        Refusal{"horizontal angles", [](F& f) { f.planes = {361}; }, 8, "0 ... 360", "361"},
        Refusal{"horizontal angles", [](F& f) { f.planes = {45}; }, 8, "0 ... 360", "45"},
        Refusal{"intensity 2 of 2", [](F& f) { f.intensities[1] = -3; }, 9, ">= 0", "-3"},
        Refusal{"longer",
                [](F& f) {
                    f.intensities.insert(f.intensities.end(), {7, 7});
                },
                10, "the end", "'7'"},
        Refusal{"intensity 2 of 4",
                [](F& f) {
                    f.planes = {0, 90};
                    f.intensities = {1, 1e300 * 1e300};
                },
                9, "a number", "inf"}));

TEST(Lm63, ACutFileIsRefusedAtItsEnd) {
    const std::string whole = to_text(test::skew_lm63(Coordinates::C, 30));
    try {
        photometry::read_photometry(
            test::write_text("cut.ies", whole.substr(0, whole.size() - 40)));
        FAIL() << "was read";
    } catch (const Error& error) {
        EXPECT_THAT(error.got, testing::AnyOf("the end of the file", testing::HasSubstr("'")));
        EXPECT_EQ(error.where, "cut.ies, line 21");
    }
}

}  // namespace
}  // namespace nearfield
