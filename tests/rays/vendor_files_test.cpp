// SPDX-License-Identifier: Apache-2.0
#include "tests/rays/vendor_files.h"

#include "formats/files/error.h"
#include "formats/rays/color.h"
#include "formats/rays/ray_file.h"
#include "tests/rays/ray_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

using testing::HasSubstr;

rays::RaySet read(const std::string& bytes, const rays::ReadOptions& options = {}) {
    return rays::read_rays(test::write_bytes("vendor.bin", bytes), options);
}

Error refused(const std::string& bytes) {
    try {
        read(bytes);
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "not refused";
    return {"", ""};
}

// Positions in metres whatever the file's unit, unit directions, and the file's flux.
void expect_three_rays(const rays::RaySet& set, double m_per_unit) {
    const test::Rows rows = test::three_rows();
    ASSERT_EQ(set.rays.size(), 3U);
    for (std::size_t r = 0; r < 3; ++r) {
        const glm::vec3 position(rows[r][0], rows[r][1], rows[r][2]);
        EXPECT_LT(glm::length(set.rays[r].position_m - static_cast<float>(m_per_unit) * position),
                  1e-6F * static_cast<float>(m_per_unit));
        EXPECT_FLOAT_EQ(set.rays[r].direction.x, rows[r][3]);
        EXPECT_FLOAT_EQ(set.rays[r].flux, rows[r][6]);
    }
}

test::Rows with_wavelength(float wavelength) {
    test::Rows rows = test::three_rows();
    for (auto& row : rows)
        row.push_back(wavelength);
    return rows;
}

TEST(ZemaxFile, HoldsItsRaysInEveryUnit) {
    const double units[] = {1, 0.0254, 0.01, 0.3048, 0.001};
    for (int unit = 0; unit < 5; ++unit) {
        test::ZemaxFile file;
        file.unit = unit;
        file.flux_type = 1;
        file.rows = test::three_rows();
        const rays::RaySet set = read(to_bytes(file));
        EXPECT_EQ(set.format, "Zemax");
        EXPECT_EQ(set.quantity, Quantity::Photometric);
        expect_three_rays(set, units[unit]);
    }
}

TEST(ZemaxFile, ScalesToTheSourcesFlux) {
    test::ZemaxFile file;
    file.rows = test::three_rows();
    file.source_flux = 12;
    const rays::RaySet set = read(to_bytes(file));
    EXPECT_EQ(set.quantity, Quantity::Radiometric);
    EXPECT_NEAR(rays::flux(set), 12, 1e-6);
    EXPECT_EQ(set.flux_of_rays, 6);
    EXPECT_EQ(set.notes.size(), 1U);
}

// 6 W stated 12 W, all at 555 nm, in both kinds of file: by the header's wavelength and by each
// ray's.
TEST(ZemaxFile, TurnsWattsIntoLumensByItsWavelengths) {
    test::ZemaxFile flux_only, spectral;
    flux_only.wavelength_um = 0.555F;
    flux_only.rows = test::three_rows();
    spectral.ray_format = 2;
    spectral.rows = with_wavelength(0.555F);
    for (test::ZemaxFile file : {flux_only, spectral}) {
        file.source_flux = 12;
        const rays::RaySet set = read(to_bytes(file));
        EXPECT_EQ(set.quantity, Quantity::Photometric);
        // The fit of V is within 1 % at its peak.
        EXPECT_NEAR(rays::flux(set), 12 * rays::kPeakEfficacyLmPerW, 0.01 * 12 * 683);
        EXPECT_EQ(set.colors.size(), file.ray_format == 2 ? 3U : 1U);
        rays::ReadOptions keep;
        keep.keep_radiometric = true;
        EXPECT_NEAR(rays::flux(read(to_bytes(file), keep)), 12, 1e-6);
    }
}

TEST(ZemaxFile, RefusesWhatItCannotBe) {
    test::ZemaxFile file;
    file.rows = test::three_rows();
    const std::string whole = to_bytes(file);
    EXPECT_EQ(refused(whole.substr(0, whole.size() - 1)).where, "vendor.bin, byte 291, ray 2");
    EXPECT_THAT(refused(whole + "x").where, HasSubstr("byte 292"));
    EXPECT_THAT(refused(whole.substr(0, 100)).where, HasSubstr("byte 100"));
    file.ray_count = 0xFFFFFFFF;
    EXPECT_THAT(refused(to_bytes(file)).what_, HasSubstr("truncated"));
    file.ray_count = 0;
    file.unit = 5;
    EXPECT_THAT(refused(to_bytes(file)).where, HasSubstr("byte 136"));
    file.unit = 4;
    file.ray_format = 1;
    EXPECT_THAT(refused(to_bytes(file)).where, HasSubstr("byte 192"));
    file.ray_format = 0;
    file.flux_type = 2;
    EXPECT_THAT(refused(to_bytes(file)).where, HasSubstr("byte 196"));
    file.flux_type = 0;
    file.rows[1][6] = NAN;
    EXPECT_EQ(refused(to_bytes(file)).where, "vendor.bin, byte 236, ray 1");
}

const char* const kZemaxText =
    "3 0 0 0 0 0 0\r\n1 2 3 0 0 1 1\n\n-1 0 .5 +0.6 0 8e-1 2\n0\t0 0 0 -1 0 3\n";

TEST(ZemaxText, HoldsItsRays) {
    const rays::RaySet set = read(kZemaxText);
    EXPECT_EQ(set.format, "Zemax (text)");
    expect_three_rays(set, 1);
    const rays::RaySet spectral = read("1 4\n1 2 3 0 0 1 1 0.555");
    EXPECT_NEAR(rays::flux(spectral), 683, 7);
}

TEST(ZemaxText, RefusesWhatItCannotBe) {
    const std::string whole = kZemaxText;
    EXPECT_EQ(refused(whole.substr(0, 44)).where, "vendor.bin, byte 30, ray 1");
    EXPECT_EQ(refused(whole.substr(0, 30)).where, "vendor.bin, byte 30, ray 1");
    EXPECT_EQ(refused(whole + "9\n").what_, "ray file is longer than its rays");
    EXPECT_THAT(refused("3 7\n1 2 3 0 0 1 1\n").what_, HasSubstr("unit"));
    EXPECT_THAT(refused("2 4\n1 2 3 0 0 1 1\n1 2 3 0 0 x 1\n").got, HasSubstr("1 2 3 0 0 x 1"));
    EXPECT_THAT(refused("2 4\n1 2 3 0 0 1 1\n1 2 3 0 0 nan 1\n").where,
                HasSubstr("byte 18, ray 1"));
    EXPECT_THAT(refused("0 4\n").what_, HasSubstr("without rays"));
}

TEST(LightToolsFile, HoldsItsRaysOriginAndFlux) {
    test::LightToolsFile file;
    file.rows = test::three_rows();
    for (const std::uint32_t version : {2U, 3U}) {
        file.version = version;
        const rays::RaySet set = read(to_bytes(file));
        EXPECT_EQ(set.format, "LightTools");
        EXPECT_EQ(set.quantity, Quantity::Photometric);
        expect_three_rays(set, 1e-3);
    }
    file.unit = 2;  // cm
    file.origin = {10, 0, 0};
    file.flux = 3;
    const rays::RaySet set = read(to_bytes(file));
    EXPECT_FLOAT_EQ(set.rays[0].position_m.x, 0.11F);
    EXPECT_NEAR(rays::flux(set), 3, 1e-6);
    file.is_luminous = 0;
    file.color = 2;
    file.rows = with_wavelength(555);
    EXPECT_NEAR(rays::flux(read(to_bytes(file))), 3 * 683, 21);
}

TEST(LightToolsFile, RefusesWhatItCannotBe) {
    test::LightToolsFile file;
    file.rows = test::three_rows();
    const std::string whole = to_bytes(file);
    const Error cut = refused(whole.substr(0, whole.size() - 10));
    EXPECT_EQ(cut.where, "vendor.bin, byte 125, ray 2");
    EXPECT_EQ(cut.got, "2 whole rays and 25 bytes");
    EXPECT_THAT(refused(whole.substr(0, 20)).where, HasSubstr("byte 20"));
    file.end = "";
    EXPECT_THAT(refused(to_bytes(file)).what_, HasSubstr("truncated"));
    file.end = "LTRFEND";
    file.far_field = 1;
    EXPECT_THAT(refused(to_bytes(file)).where, HasSubstr("byte 16"));
    file.far_field = 0;
    file.color = 1;
    EXPECT_THAT(refused(to_bytes(file)).where, HasSubstr("byte 20"));
    file.color = 0;
    file.version = 4;
    EXPECT_THAT(refused(to_bytes(file)).where, HasSubstr("byte 4"));
    file.version = 2;
    file.origin[1] = NAN;
    EXPECT_THAT(refused(to_bytes(file)).what_, HasSubstr("origin"));
}

std::string lighttools_text() {
    return "# LightTools 8.7.0\nlt_rdf_version: 2.0\nlt_datatype: luminous_flux\n"
           "lt_far_field_data: no\nlt_color_info: none\nlt_length_units: millimeters\n"
           "lt_data_origin: 0 0 0\nlt_radiant_flux: 12\nlt_startofdata\n"
           "1 2 3 0 0 1 1\n-1 0 0.5 0.6 1.2e-316 0.8 2\n0 0 0 0 -1 0 3\nlt_endofdata";
}

TEST(LightToolsText, HoldsItsRays) {
    rays::ReadOptions keep;
    keep.keep_ray_flux = true;
    const rays::RaySet set = read(lighttools_text(), keep);
    EXPECT_EQ(set.format, "LightTools (text)");
    expect_three_rays(set, 1e-3);
    EXPECT_NEAR(rays::flux(read(lighttools_text())), 12, 1e-6);
}

TEST(LightToolsText, RefusesWhatItCannotBe) {
    const std::string whole = lighttools_text();
    const Error cut = refused(whole.substr(0, whole.size() - 13));
    EXPECT_THAT(cut.where, HasSubstr("ray 3"));
    EXPECT_THAT(cut.expected, HasSubstr("lt_endofdata"));
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = whole;
        return text.replace(text.find(from), from.size(), to);
    };
    EXPECT_THAT(refused(with("millimeters", "parsecs")).what_, HasSubstr("lt_length_units"));
    EXPECT_THAT(refused(with("none", "cie")).what_, HasSubstr("lt_color_info"));
    EXPECT_THAT(refused(with("lt_startofdata\n", "")).what_, HasSubstr("without rays"));
    EXPECT_THAT(refused(with("0.6", "0.6 7")).expected, "7 numbers");
    EXPECT_THAT(refused(whole + "\nmore").what_, HasSubstr("longer"));
}

TEST(SpeosFile, HoldsItsRaysByShareAndWavelength) {
    test::SpeosFile file;
    file.rows = with_wavelength(1);
    for (auto& row : file.rows) {  // wavelength before share
        row[7] = row[6];
        row[6] = 555;
    }
    file.radiant_flux_w = 12;
    const rays::RaySet set = read(to_bytes(file));
    EXPECT_EQ(set.format, "Speos");
    ASSERT_EQ(set.rays.size(), 3U);
    EXPECT_NEAR(rays::flux(set), 12 * 683, 82);
    EXPECT_NEAR(set.rays[2].flux / set.rays[0].flux, 3, 1e-5);
    file.luminous_flux_lm = 8000;
    EXPECT_NEAR(rays::flux(read(to_bytes(file))), 8000, 0.01);
    const std::string whole = to_bytes(file);
    EXPECT_EQ(refused(whole.substr(0, whole.size() - 4)).where, "vendor.bin, byte 120, ray 2");
}

// What is none of the formats, and what is like one but cannot be it.
TEST(RayFormat, IsToldByContent) {
    EXPECT_THAT(refused("").what_, HasSubstr("truncated"));
    EXPECT_THAT(refused("a text about rays\n").what_, HasSubstr("not a ray file"));
    EXPECT_THAT(refused(std::string(4000, '\0')).what_, HasSubstr("not a ray file"));
    EXPECT_THAT(refused(std::string(4000, '\xFF')).what_, HasSubstr("not a ray file"));
    EXPECT_THAT(refused("1.5 2 3\n").what_, HasSubstr("not a ray file"));
}

}  // namespace
}  // namespace nearfield
