// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"
#include "formats/photometry/tm33.h"
#include "tests/photometry/lamp_files.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

using photometry::Coordinates;

std::string type_c() {
    test::Lm63File file = test::skew_lm63(Coordinates::C, 30);
    file.tilt = "TILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8";
    file.opening = "-0.1 -0.2 0.3";
    return to_text(file);
}

std::string type_b() {
    return to_text(test::skew_lm63(Coordinates::B, 30));
}

std::string edition_1991() {
    test::Lm63File file = test::skew_lm63(Coordinates::A, 30);
    file.first_line = "IESNA91";
    return to_text(file);
}

std::string eulumdat() {
    return to_text(test::skew_ldt(30));
}

std::string eulumdat_symmetric() {
    test::LdtFile file = test::skew_ldt(30);
    file.symmetry = 3;
    file.intensities.resize(7 * file.angles.size());
    return to_text(file);
}

std::string tm33() {
    test::write_text("whole.ies", type_c());
    return photometry::to_tm33(photometry::read_photometry("whole.ies"));
}

class DamagedPhotometry : public testing::TestWithParam<std::string (*)()> {};

// Proves that damaged files give a photometry that keeps the rules or an Error: no other exception,
// no crash. Says nothing about whether the table of a file whose damage is plausible is right.
TEST_P(DamagedPhotometry, GivesATableOrAnError) {
    const std::string whole = GetParam()();
    ASSERT_GT(photometry::flux_lm(
                  photometry::read_photometry(test::write_text("fuzz.photometry", whole))),
              0);
    std::uint64_t refused = 0;
    for (std::uint64_t seed = 0; seed < test::fuzz_count(); ++seed) {
        test::write_text("fuzz.photometry", test::mutate(whole, seed));
        try {
            const photometry::Photometry lamp = photometry::read_photometry("fuzz.photometry");
            ASSERT_NO_THROW(check(lamp, "")) << "seed " << seed;
            ASSERT_GE(photometry::flux_lm(lamp), 0) << "seed " << seed;
            ASSERT_GE(photometry::intensity_cd(lamp, glm::dvec3(0.1, 0.2, 0.9)), 0);
            ASSERT_LE(lamp.intensity_cd.size(), 4 * whole.size() + 4096) << "seed " << seed;
        } catch (const Error& error) {
            ++refused;
            ASSERT_FALSE(error.where.empty()) << "seed " << seed;
        } catch (const std::exception& error) {
            FAIL() << "seed " << seed << ": " << error.what();
        }
    }
    EXPECT_GT(refused, test::fuzz_count() / 10);
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryFormat,
    DamagedPhotometry,
    testing::Values(type_c, type_b, edition_1991, eulumdat, eulumdat_symmetric, tm33));

}  // namespace
}  // namespace nearfield
