// SPDX-License-Identifier: Apache-2.0
// Files that nobody of this project made, where they are at hand: every one is read, or refused for
// a true reason, and what is known of them comes out.
#include "formats/files/error.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

namespace nearfield {
namespace {

using photometry::Angles;
using photometry::Coordinates;
using photometry::Photometry;

class SharedPhotometry : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(folder_))
            GTEST_SKIP() << "optional folder " << folder_ << " is not there";
    }
    Photometry read(const std::string& name) const {
        return photometry::read_photometry((folder_ / name).string());
    }
    const std::filesystem::path folder_ =
        std::filesystem::path(NEARFIELD_SOURCE_DIR) / "../shared/data/photometry";
};

TEST_F(SharedPhotometry, AllAreReadOrRefusedForATrueReason) {
    int read_well = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
        if (!entry.is_regular_file())
            continue;
        try {
            EXPECT_GT(photometry::flux_lm(photometry::read_photometry(entry.path().string())), 0);
            ++read_well;
        } catch (const Error& error) {
            ADD_FAILURE() << error.what();
        }
    }
    EXPECT_EQ(read_well, 43);
}

TEST_F(SharedPhotometry, TheStreetLampHasItsFlux) {
    const Photometry lamp = read("measured/HellaEcoLight_2070lm_LDT.ies");
    EXPECT_EQ(lamp.format, "LM-63-1991");
    EXPECT_EQ(lamp.planes_deg.size(), 361U);
    EXPECT_NEAR(photometry::flux_lm(lamp), 2074.5, 0.05);
    EXPECT_EQ(lamp.notes.size(), 2U);  // no plane of 360 degrees, vertical angles end at 130
}

// The stated flux is that of the trapezoid rule on I cos H; the interpolant's own is 0.3 % less,
// since I falls between angles 5 to 10 degrees apart. Were V the latitude, both would be 32,200 lm:
// the planes of -90 and 90 degrees, each of one intensity alone, show that H is.
TEST_F(SharedPhotometry, TheTypeBFloodlightHasItsFluxAndPeak) {
    const Photometry lamp = read("measured/RAB_2.2.ies");
    ASSERT_EQ(lamp.coordinates, Coordinates::B);
    EXPECT_TRUE(lamp.is_absolute);
    EXPECT_NEAR(photometry::peak(lamp).intensity_cd, 12718, 0.5);
    const std::size_t last = lamp.planes_deg.size() - 1;
    double trapezoid_lm = 0;
    for (std::size_t p = 0; p < last; ++p)
        for (std::size_t a = 0; a + 1 < lamp.angles_deg.size(); ++a)
            for (std::size_t k = 0; k < 4; ++k)
                trapezoid_lm += std::pow(std::numbers::pi / 180, 2) / 4 *
                                (lamp.planes_deg[p + 1] - lamp.planes_deg[p]) *
                                (lamp.angles_deg[a + 1] - lamp.angles_deg[a]) *
                                lamp.at(p + k / 2, a + k % 2) *
                                std::cos(lamp.planes_deg[p + k / 2] * std::numbers::pi / 180);
    RecordProperty("flux_lm", std::to_string(photometry::flux_lm(lamp)));
    EXPECT_NEAR(trapezoid_lm, 30127, 1);
    EXPECT_NEAR(photometry::flux_lm(lamp), trapezoid_lm, 0.004 * trapezoid_lm);
    for (std::size_t a = 1; a < lamp.angles_deg.size(); ++a) {
        EXPECT_EQ(lamp.at(0, a), lamp.at(0, 0));
        EXPECT_EQ(lamp.at(last, a), lamp.at(last, 0));
    }
}

// One lamp in CIE's axes (C90 to the street) and in IESNA's (0 to the street).
TEST_F(SharedPhotometry, TheStreetLampOfTwoAxesIsOneAfterAQuarterTurn) {
    const std::string name =
        "measured/S01.01.02.354_MAXWELL-8-T4 LUXEON 5050 Square with glass-MEASURED_";
    const Photometry cie = read(name + "CIE.IES"), iesna = read(name + "IESNA.ies");
    EXPECT_NEAR(photometry::flux_lm(cie), 999.9, 0.05);
    EXPECT_NEAR(photometry::flux_lm(iesna), 999.9, 0.05);
    double unturned = 0;
    for (double plane = 0; plane < 360; plane += 5)
        for (double gamma = 0; gamma <= 90; gamma += 1) {
            const double there = photometry::intensity_cd(iesna, Angles{plane, gamma});
            EXPECT_NEAR(photometry::intensity_cd(cie, Angles{plane + 90, gamma}), there, 1e-9);
            unturned = std::max(
                unturned, std::abs(photometry::intensity_cd(cie, Angles{plane, gamma}) - there));
        }
    EXPECT_GT(unturned, 100);
}

TEST_F(SharedPhotometry, ThePairOfFormatsAgrees) {
    const Photometry ies = read("vendor_ldt/luxpy_test_lid_file.ies");
    const Photometry ldt = read("vendor_ldt/luxpy_test_lid_file.ldt");
    ASSERT_EQ(ies.planes_deg, ldt.planes_deg);
    ASSERT_EQ(ies.angles_deg, ldt.angles_deg);
    for (std::size_t k = 0; k < ies.intensity_cd.size(); ++k)
        ASSERT_NEAR(ies.intensity_cd[k], ldt.intensity_cd[k], 1e-9);
    EXPECT_LT(glm::length(ies.opening.size_m - glm::dvec3(1.966, 0.08, 0)), 1e-12);
    EXPECT_LT(glm::length(ldt.opening.size_m - ies.opening.size_m), 1e-12);
    EXPECT_NEAR(photometry::flux_lm(ldt), 0.88 * 6000, 1);  // the light output ratio stated
}

// 155,000 lm of lamps with a light output ratio of 99.9 %.
TEST_F(SharedPhotometry, TheFloodlightOf10DegreesHasItsFluxAndPeak) {
    const Photometry lamp = read("vendor_ldt/4058075580664_FL_MAX_LUM_1200W_757_SYM_10_WAL.ldt");
    EXPECT_EQ(lamp.lamps[0].flux_lm, 155000);
    RecordProperty("flux_lm", std::to_string(photometry::flux_lm(lamp)));
    RecordProperty("peak_cd", std::to_string(photometry::peak(lamp).intensity_cd));
    EXPECT_NEAR(photometry::flux_lm(lamp), 155000, 0.01 * 155000);
    EXPECT_NEAR(photometry::peak(lamp).intensity_cd, 2.24e6, 0.005e6);
}

}  // namespace
}  // namespace nearfield
