// SPDX-License-Identifier: Apache-2.0
// TM-33 files as others write them: both editions, any order, symmetries left out; what is refused,
// and at which line.
#include "formats/photometry/tm33.h"

#include "formats/files/error.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"
#include "tests/photometry/lamp_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace nearfield {
namespace {

using photometry::Coordinates;
using photometry::Photometry;
using photometry::Shape;
using testing::HasSubstr;

// A plane of a lamp of 100 cd all around in three angles; a sample a line, from line 9 on.
constexpr const char* kEdition2018 = R"(<?xml version="1.0"?>
<tns:LuminaireOpticalData xmlns:tns="http://www.ies.org/tm-33" version="1.0">
<Header><Manufacturer>nobody</Manufacturer></Header>
<Luminaire><Dimensions><Length>300</Length><Width>200</Width><Height>0</Height></Dimensions>
<Shape>Rectangular</Shape></Luminaire>
<Emitter><Quantity>2</Quantity><RatedLumens>700</RatedLumens><InputWattage>10</InputWattage>
<LuminousData><LuminousIntensity>
<AbsolutePhotometry>true</AbsolutePhotometry><NumberHorz>1</NumberHorz>
<IntData h="0" v="180">100</IntData>
<IntData h="0" v="0">100</IntData>
<IntData h="0" v="90">100.0</IntData>
</LuminousIntensity></LuminousData></Emitter></tns:LuminaireOpticalData>
)";

constexpr const char* kEdition2023 = R"(<IESTM33-22><Version>1.1</Version><Header/>
<Emitter><LuminousData><PhotometryType>CIE _ C</PhotometryType><SymmType>Symm _ Quad</SymmType>
<Multiplier>2</Multiplier>
<IntensityData horz="0" vert="0">5</IntensityData><IntensityData horz="0" vert="90">6</IntensityData>
<IntensityData horz="90" vert="0">5</IntensityData><IntensityData horz="90" vert="90">8</IntensityData>
</LuminousData></Emitter></IESTM33-22>)";

Photometry read(const std::string& text) {
    return photometry::read_photometry(test::write_text("lamp.xml", text));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(Tm33, ReadsTheEditionOf2018) {
    const Photometry lamp = read(kEdition2018);
    EXPECT_EQ(lamp.format, "TM-33-18");
    EXPECT_EQ(lamp.angles_deg, (std::vector<double>{0, 90, 180}));
    EXPECT_NEAR(photometry::flux_lm(lamp), 400 * std::numbers::pi, 1e-9);
    EXPECT_TRUE(lamp.is_absolute);
    EXPECT_EQ(lamp.lamps[0].count, 2);
    EXPECT_EQ(lamp.lamps[0].flux_lm, 1400);
    EXPECT_EQ(lamp.opening.shape, Shape::Rectangle);
    EXPECT_EQ(lamp.opening.size_m, glm::dvec3(0.3, 0.2, 0));
    EXPECT_EQ(photometry::label(lamp, "MANUFAC"), "nobody");
    EXPECT_EQ(lamp.notes.size(), 1U);  // whose size it is
}

TEST(Tm33, ReadsTheEditionOf2023WithSymmetryAndMultiplier) {
    const Photometry lamp = read(kEdition2023);
    EXPECT_EQ(lamp.format, "TM-33-23");
    EXPECT_EQ(lamp.planes_deg, (std::vector<double>{0, 90, 180, 270, 360}));
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{270, 90}), 16);
    EXPECT_EQ(photometry::intensity_cd(lamp, photometry::Angles{180, 45}), 11);
}

// The same lamp without symmetry as LM-63 and through TM-33: one table in every type.
TEST(Tm33, KeepsALampWithoutSymmetry) {
    for (const Coordinates coordinates : {Coordinates::A, Coordinates::B, Coordinates::C}) {
        const Photometry lamp = photometry::read_photometry(
            test::write_text("skew.ies", to_text(test::skew_lm63(coordinates, 15))));
        write_photometry(lamp, photometry::FileFormat::Tm33, "skew.xml");
        const Photometry again = photometry::read_photometry("skew.xml");
        EXPECT_EQ(again.coordinates, coordinates);
        EXPECT_EQ(again.intensity_cd, lamp.intensity_cd);
        EXPECT_EQ(photometry::label(again, "MANUFAC"), "nobody");
    }
}

TEST(Tm33, RefusesWithTheLine) {
    const auto refusal = [](const std::string& text) -> std::string {
        try {
            read(text);
        } catch (const Error& error) {
            return error.what();
        }
        return "read";
    };
    const std::string good = kEdition2018;
    EXPECT_THAT(refusal(replaced(good, "v=\"0\">100", "v=\"0\">1OO")), HasSubstr("line 10"));
    EXPECT_THAT(refusal(replaced(good, "v=\"0\">100", "v=\"0\">-1")), HasSubstr("line 10"));
    EXPECT_THAT(refusal(replaced(good, "v=\"0\"", "w=\"0\"")), HasSubstr("no such attribute"));
    EXPECT_THAT(refusal(replaced(good, "v=\"0\"", "v=\"90\"")), HasSubstr("not full"));
    EXPECT_THAT(refusal(replaced(good, "<NumberHorz>1", "<NumberHorz>2")), HasSubstr("line 8"));
    EXPECT_THAT(refusal(replaced(good, "</LuminousIntensity>", "")), HasSubstr("line 12"));
    EXPECT_THAT(refusal(replaced(good, "v=\"180\"", "v=\"181\"")), HasSubstr("0 ... 180"));
    EXPECT_THAT(refusal(replaced(good, "<AbsolutePhotometry>true", "<AbsolutePhotometry>false")),
                "read");
    EXPECT_THAT(refusal(replaced(kEdition2023, "Symm _ Quad", "Symm _ Full")),
                HasSubstr("symmetry"));
    EXPECT_THAT(refusal(replaced(kEdition2023, "CIE _ C", "CIE _ D")), HasSubstr("type"));
    EXPECT_THAT(refusal("<html/>"), HasSubstr("LuminaireOpticalData"));
    EXPECT_THAT(refusal(replaced(good, "</Emitter>",
                                 "</Emitter><Emitter><LuminousData><IntData h=\"0\" v=\"0\">1"
                                 "</IntData></LuminousData></Emitter>")),
                HasSubstr("several emitters"));
}

}  // namespace
}  // namespace nearfield
