// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/rays/color.h"
#include "formats/rays/ray_file.h"
#include "tests/rays/ray_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace nearfield {
namespace {

using test::RayFile;

RayFile three_rays() {
    RayFile file;
    file.rows = {{1, 2, 3, 0, 0, 1, 10}, {-1, 0, 0.5F, 0.6F, 0, 0.8F, 20}, {0, 0, 0, 0, -1, 0, 30}};
    file.ray_count = 3;
    return file;
}

rays::RaySet read(const std::string& bytes, const rays::ReadOptions& options = {}) {
    return rays::read_rays(test::write_bytes("rays.tm25ray", bytes), options);
}

// Reads bytes that must be refused; returns the Error.
Error refused(const std::string& bytes, const std::string& name = "bad.tm25ray") {
    try {
        rays::read_rays(test::write_bytes(name, bytes));
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << name << " was not refused";
    return {"", ""};
}

// Proves that positions (mm to m), directions and flux come out as they went in.
TEST(ReadTm25, HoldsTheRaysOfTheFile) {
    const rays::RaySet set = read(to_bytes(three_rays()));
    ASSERT_EQ(set.rays.size(), 3U);
    EXPECT_EQ(set.quantity, Quantity::Photometric);
    EXPECT_FLOAT_EQ(set.rays[1].position_m.z, 0.0005F);
    EXPECT_FLOAT_EQ(set.rays[1].direction.x, 0.6F);
    EXPECT_EQ(set.rays[2].flux, 30.0F);
    EXPECT_EQ(set.flux_of_rays, 60.0);
    EXPECT_TRUE(set.colors.empty());
    EXPECT_TRUE(set.notes.empty());
}

// Proves that rays are scaled to the header's total, that it is said, and that it can be turned
// off.
TEST(ReadTm25, ScalesToTheHeadersFluxUnlessToldNotTo) {
    RayFile file = three_rays();
    file.luminous_flux_lm = 6;
    rays::RaySet set = read(to_bytes(file));
    EXPECT_FLOAT_EQ(set.rays[2].flux, 3.0F);
    EXPECT_EQ(set.notes.size(), 1U);
    rays::ReadOptions keep;
    keep.keep_ray_flux = true;
    set = read(to_bytes(file), keep);
    EXPECT_EQ(set.rays[2].flux, 30.0F);
    EXPECT_EQ(set.notes.size(), 1U);
}

// Proves that a header without a total (NaN, as the standard has it for unknown) changes nothing.
TEST(ReadTm25, KeepsTheRaysFluxWhereTheHeaderStatesNone) {
    RayFile file = three_rays();
    file.luminous_flux_lm = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(rays::flux(read(to_bytes(file))), 60.0);
}

// Proves that a truncated file is refused with the byte where it ends and the first ray that is not
// whole.
TEST(ReadTm25, RefusesTruncationNamingByteAndRay) {
    const std::string bytes = to_bytes(three_rays());
    const Error error = refused(bytes.substr(0, bytes.size() - 10));
    EXPECT_EQ(error.where, "bad.tm25ray, byte 36362, ray 2");
    for (const std::size_t size : {0, 3, 7, 100, 300, 36287, 36289})
        EXPECT_NE(refused(bytes.substr(0, size)).where.find("byte"), std::string::npos) << size;
}

TEST(ReadTm25, RefusesOtherVersionsFlagsAndTrailingBytes) {
    RayFile file = three_rays();
    file.version = 2020;
    EXPECT_EQ(refused(to_bytes(file)).got, "2020");
    file = three_rays();
    file.flags[2] = 7;
    EXPECT_EQ(refused(to_bytes(file)).got, "7");
    file = three_rays();
    file.flags[4] = 0;
    EXPECT_NE(refused(to_bytes(file)).what_.find("without flux"), std::string::npos);
    EXPECT_NE(refused(to_bytes(three_rays()) + "x").what_.find("longer"), std::string::npos);
}

// Proves that NaN, infinity, directions of no length and negative flux are refused with the ray.
TEST(ReadTm25, RefusesRaysThatAreNoRays) {
    const auto with = [](std::size_t item, float value) {
        RayFile file = three_rays();
        file.rows[1][item] = value;
        return to_bytes(file);
    };
    for (const std::size_t item : {0, 3, 6})
        for (const float bad :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
            EXPECT_EQ(refused(with(item, bad)).where, "bad.tm25ray, byte 36316, ray 1");
    EXPECT_NE(refused(with(6, -1)).what_.find("negative flux"), std::string::npos);
    RayFile file = three_rays();
    file.rows[1][3] = file.rows[1][5] = 0;
    EXPECT_NE(refused(to_bytes(file)).what_.find("without direction"), std::string::npos);
}

// Proves that counts beyond the file's size are refused before memory is asked for: 2^60 rays would
// throw bad_alloc.
TEST(ReadTm25, RefusesCountsThatTheFilesSizeDoesNotJustify) {
    RayFile file = three_rays();
    for (const std::uint64_t count :
         {std::uint64_t{4}, std::uint64_t{1} << 60U, ~std::uint64_t{0}}) {
        file.ray_count = count;
        EXPECT_NE(refused(to_bytes(file)).what_.find("truncated"), std::string::npos);
    }
    file.ray_count = 0;
    EXPECT_NE(refused(to_bytes(file)).what_.find("without rays"), std::string::npos);
    for (const std::size_t field : {76U, 80U, 84U}) {
        std::string bytes = to_bytes(three_rays());
        bytes.replace(field, 4, "\xFF\xFF\xFF\x7F");
        refused(bytes);
        bytes.replace(field, 4, "\xFF\xFF\xFF\xFF");
        refused(bytes);
    }
}

// Proves that radiant flux at a wavelength becomes luminous flux and a color, and that it can stay
// radiant.
TEST(ReadTm25, TurnsRadiantFluxWithWavelengthsIntoLumens) {
    RayFile file = three_rays();
    file.flags = {1, 1, 1, 1, 0, 0, 0, 0};
    file.spectral_data = 2;
    for (auto& row : file.rows)
        row.push_back(555);
    const rays::RaySet set = read(to_bytes(file));
    EXPECT_EQ(set.quantity, Quantity::Photometric);
    // The analytic fit's error at the peak of V is below 1 %.
    EXPECT_NEAR(rays::flux(set), 60 * rays::kPeakEfficacyLmPerW, 0.01 * 60 * 683);
    ASSERT_EQ(set.colors.size(), 3U);
    EXPECT_EQ(set.desaturated, 3U);
    rays::ReadOptions keep;
    keep.keep_radiometric = true;
    const rays::RaySet watts = read(to_bytes(file), keep);
    EXPECT_EQ(watts.quantity, Quantity::Radiometric);
    EXPECT_EQ(rays::flux(watts), 60.0);
    EXPECT_TRUE(watts.colors.empty());
}

// Proves that a file's one table gives all rays one color, tristimulus values each its own, in the
// right columns.
TEST(ReadTm25, GivesRaysTheColorOfTablesAndTristimulus) {
    RayFile file = three_rays();
    file.spectral_data = 3;
    file.tables = {{{600, 1}, {620, 1}, {640, 0}}};
    rays::RaySet set = read(to_bytes(file));
    ASSERT_EQ(set.colors.size(), 1U);
    EXPECT_GT(set.colors[0].r, set.colors[0].g);
    EXPECT_EQ(rays::flux(set), 60.0);

    file = three_rays();
    file.flags[6] = 1;
    for (auto& row : file.rows) {
        row.push_back(0.95046F * row[6]);  // D65
        row.push_back(1.08906F * row[6]);
    }
    set = read(to_bytes(file));
    ASSERT_EQ(set.colors.size(), 3U);
    EXPECT_NEAR(set.colors[0].r, 1.0, 1e-3);  // the white's digits
    EXPECT_NEAR(set.colors[0].b, 1.0, 1e-3);
}

// Proves that a color keeps Y = 1 and has no negative channel, for every wavelength.
TEST(Color, HasUnitLuminanceAndNoNegativeChannel) {
    for (double l = 400; l <= 700; l += 5) {
        const rays::UnitColor color = rays::unit_color(rays::color_matching(l));
        EXPECT_NEAR(0.2126 * color.rgb.r + 0.7152 * color.rgb.g + 0.0722 * color.rgb.b, 1.0, 1e-12);
        EXPECT_GE(std::min({color.rgb.r, color.rgb.g, color.rgb.b}), 0.0);
        EXPECT_TRUE(color.desaturated);
    }
}

TEST(Color, GoesToXyzAndBack) {
    for (const glm::dvec3 rgb : {glm::dvec3(1), {2, 0.7, 0.1}, {0.1, 1.1, 3}}) {
        const glm::dvec3 unit = rgb / (0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b);
        const rays::UnitColor back = rays::unit_color(rays::xyz_of(unit));
        EXPECT_LT(glm::length(back.rgb - unit), 1e-6);  // the matrix' digits
        EXPECT_FALSE(back.desaturated);
    }
}

// Proves the fit of the color matching functions against CIE 1931 values (CIE 015, 2 degrees).
TEST(Color, MatchesTheStandardObserver) {
    // Stated largest error of the fit, Wyman et al. 2013, with the peaks at 1.06, 1.0 and 1.78.
    constexpr double kFitError = 0.03;
    const struct {
        double nm, x, y, z;
    } table[] = {{450, 0.3362, 0.0380, 1.77211},
                 {520, 0.06327, 0.7100, 0.07825},
                 {555, 0.5121, 1.0000, 0.00575},
                 {600, 1.0622, 0.6310, 0.0008}};
    for (const auto& row : table) {
        const glm::dvec3 c = rays::color_matching(row.nm);
        EXPECT_NEAR(c.x, row.x, kFitError);
        EXPECT_NEAR(c.y, row.y, kFitError);
        EXPECT_NEAR(c.z, row.z, kFitError);
    }
}

// Reads a file of another maker, where they are at hand, and compares with what is known of them.
TEST(ReadTm25, ReadsTheSharedFiles) {
    const std::filesystem::path folder =
        std::filesystem::path(NEARFIELD_SOURCE_DIR) / "../shared/data/rays";
    if (!std::filesystem::exists(folder))
        GTEST_SKIP() << "optional folder " << folder << " is not there";
    const rays::RaySet simulated =
        rays::read_rays((folder / "lighttools_sim/Cyl10k.1.tm25ray").string());
    EXPECT_EQ(simulated.rays.size(), 10000U);
    EXPECT_NEAR(simulated.flux_of_rays, 10000.0, 0.01);
    EXPECT_NEAR(rays::flux(simulated), 1.0, 1e-6);
}

}  // namespace
}  // namespace nearfield
