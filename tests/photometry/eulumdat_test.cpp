// SPDX-License-Identifier: Apache-2.0
// EULUMDAT: all symmetries, lamps and sizes come out, and damage is refused with its line.
#include "formats/files/error.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"
#include "tests/photometry/lamp_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nearfield {
namespace {

using photometry::Photometry;
using photometry::Shape;

Photometry read(const test::LdtFile& file, int lamp_set = 0) {
    return photometry::read_photometry(test::write_text("lamp.ldt", to_text(file)), {lamp_set});
}

// Four planes; a plane's intensity across is its place in the file, from 1.
test::LdtFile small_file(int symmetry, int planes_held) {
    test::LdtFile file;
    file.symmetry = symmetry;
    file.planes = test::steps(0, 315, 45);
    file.angles = {0, 90};
    for (int k = 0; k < planes_held; ++k)
        file.intensities.insert(file.intensities.end(), {9, 1.0 + k});
    return file;
}

std::vector<double> across(const Photometry& lamp) {
    std::vector<double> values;
    for (const double plane : test::steps(0, 360, 45))
        values.push_back(photometry::intensity_cd(lamp, photometry::Angles{plane, 90}));
    return values;
}

TEST(Eulumdat, SymmetryTellsWhichPlanesAreHeld) {
    EXPECT_THAT(across(read(small_file(0, 8))), testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 1));
    EXPECT_THAT(across(read(small_file(1, 1))), testing::ElementsAre(1, 1, 1, 1, 1, 1, 1, 1, 1));
    EXPECT_THAT(across(read(small_file(2, 5))), testing::ElementsAre(1, 2, 3, 4, 5, 4, 3, 2, 1));
    // C270, C315, C0, C45, C90 are held.
    EXPECT_THAT(across(read(small_file(3, 5))), testing::ElementsAre(3, 4, 5, 4, 3, 2, 1, 2, 3));
    EXPECT_THAT(across(read(small_file(4, 3))), testing::ElementsAre(1, 2, 3, 2, 1, 2, 3, 2, 1));
}

TEST(Eulumdat, LampsScaleTheTable) {
    test::LdtFile file = small_file(1, 1);
    file.lamp_sets = "2\n1\nLED\n500\n4000\n80\n10\n2\nLED\n3000\n4000\n80\n20\n";
    file.conversion = "2";
    EXPECT_DOUBLE_EQ(read(file).intensity_cd[0], 9);
    const Photometry second = read(file, 1);
    EXPECT_DOUBLE_EQ(second.intensity_cd[0], 54);
    EXPECT_EQ(second.lamps.size(), 2U);
    EXPECT_EQ(second.lamps[1].count, 2);
    EXPECT_EQ(second.lamps[1].input_w, 20);
    EXPECT_FALSE(second.is_absolute);
    file.lamp_sets = "1\n-1\nLED\n1000\n4000\n80\n10\n";
    EXPECT_TRUE(read(file).is_absolute);
}

// Lengths lie along C90-C270.
TEST(Eulumdat, SizesBecomeMeters) {
    test::LdtFile file = small_file(1, 1);
    file.sizes = "1200\n300\n80\n1100\n250\n10\n20\n30\n40\n";
    Photometry lamp = read(file);
    EXPECT_LT(glm::length(lamp.housing_m - glm::dvec3(0.3, 1.2, 0.08)), 1e-15);
    EXPECT_EQ(lamp.opening.shape, Shape::Rectangle);
    EXPECT_LT(glm::length(lamp.opening.size_m - glm::dvec3(0.25, 1.1, 0.04)), 1e-15);
    EXPECT_DOUBLE_EQ(lamp.opening.sides_m[2], 0.03);
    file.sizes = "120\n0\n80\n110\n0\n\n\n\n\n";
    lamp = read(file);
    EXPECT_EQ(lamp.opening.shape, Shape::Ellipse);
    EXPECT_LT(glm::length(lamp.opening.size_m - glm::dvec3(0.11, 0.11, 0)), 1e-15);
}

TEST(Eulumdat, ReadsLabelsUtilancesAndDecimalCommas) {
    test::LdtFile file = small_file(1, 1);
    file.conversion = "1,5";
    const Photometry lamp = read(file);
    EXPECT_EQ(photometry::label(lamp, "LUMINAIRE"), "a lamp");
    EXPECT_EQ(photometry::label(lamp, "TEST"), "17");
    EXPECT_DOUBLE_EQ(lamp.utilances[9], 0.9);
    EXPECT_DOUBLE_EQ(lamp.intensity_cd[0], 13.5);
}

struct Refusal {
    int line;  // counted from 1, which is replaced, and named unless `named` is another
    const char* text;
    const char* what;
    const char* got;
    int named = 0;
};

class EulumdatRefuses : public testing::TestWithParam<Refusal> {};

TEST_P(EulumdatRefuses, WithLineExpectedAndGot) {
    std::string text = to_text(small_file(4, 3));
    std::size_t at = 0;
    for (int k = 1; k < GetParam().line; ++k)
        at = text.find('\n', at) + 1;
    text.replace(at, text.find('\n', at) - at, GetParam().text);
    try {
        photometry::read_photometry(test::write_text("bad.ldt", text));
        FAIL() << GetParam().what << " was read";
    } catch (const Error& error) {
        const int line = GetParam().named > 0 ? GetParam().named : GetParam().line;
        EXPECT_THAT(error.what_, testing::HasSubstr(GetParam().what));
        EXPECT_EQ(error.where, "bad.ldt, line " + std::to_string(line));
        EXPECT_THAT(error.got, testing::HasSubstr(GetParam().got));
        EXPECT_FALSE(error.expected.empty());
    }
}

// Lines: 26 ... 32 lamps, 33 ... 42 utilances, 43 ... 50 planes, 51 and 52 angles, 53 ... 58 table.
INSTANTIATE_TEST_SUITE_P(EveryField,
                         EulumdatRefuses,
                         testing::Values(Refusal{2, "4", "type indicator", "4"},
                                         Refusal{3, "5", "symmetry indicator", "5"},
                                         Refusal{4, "6", "number of C planes", "6"},
                                         Refusal{5, "x", "distance of C planes", "'x'"},
                                         Refusal{6, "1", "number of intensities", "1"},
                                         Refusal{13, "-1", "length of luminaire", "-1"},
                                         Refusal{21, "a", "height of luminous area", "'a'"},
                                         Refusal{24, "-2", "conversion factor", "-2"},
                                         Refusal{26, "0", "number of lamp sets", "0"},
                                         Refusal{27, "1.5", "number of lamps", "1.5"},
                                         Refusal{29, "0", "lamps", "0 lm", 32},
                                         Refusal{33, "-1", "direct ratio", "-1"},
                                         Refusal{44, "0", "C plane", "0 after 0"},
                                         Refusal{45, "91", "C planes", "C91", 50},
                                         Refusal{50, "361", "C plane", "361"},
                                         Refusal{51, "-1", "gamma", "-1"},
                                         Refusal{52, "0", "gamma", "0 after 0"},
                                         Refusal{54, "-1", "intensity", "-1"},
                                         Refusal{58, "1\n2", "end", "'2'", 59},
                                         Refusal{58, "", "intensity", "''"}));

TEST(Eulumdat, ACutFileIsRefusedAtItsEnd) {
    const std::string whole = to_text(small_file(0, 8));
    try {
        photometry::read_photometry(test::write_text("cut.ldt", whole.substr(0, whole.size() - 4)));
        FAIL() << "was read";
    } catch (const Error& error) {
        EXPECT_EQ(error.got, "the end of the file");
        EXPECT_EQ(error.where, "cut.ldt, line 67");
    }
}

TEST(Eulumdat, AnotherTextIsNeitherFormat) {
    try {
        photometry::read_photometry(test::write_text("letter.ldt", "Dear Sir,\nI write\n"));
        FAIL() << "was read";
    } catch (const Error& error) {
        EXPECT_EQ(error.what_, "not a photometric file");
        EXPECT_EQ(error.got, "'Dear Sir,'");
    }
}

}  // namespace
}  // namespace nearfield
