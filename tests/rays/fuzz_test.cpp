// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/rays/ray_file.h"
#include "tests/rays/ray_file.h"
#include "tests/rays/vendor_files.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

// Files with every kind of item, so that damage reaches every branch of the readers.
std::string tm25_file() {
    test::RayFile file;
    file.flags = {1, 1, 1, 1, 1, 1, 0, 1};
    file.spectral_data = 4;
    file.luminous_flux_lm = 5;
    file.tables = {{{450, 1}, {520, 2}, {600, 1}}, {{555, 1}}};
    for (int r = 0; r < 100; ++r) {
        const auto x = static_cast<float>(r);
        file.rows.push_back(
            {x, 1, 2, 0, 0.6F, 0.8F, 1, 500, 3, 0, 0, 0, 1, 0, 0, static_cast<float>(1 + r % 2)});
    }
    file.ray_count = file.rows.size();
    return to_bytes(file);
}

test::Rows many_rows() {
    test::Rows rows;
    for (int r = 0; r < 100; ++r)
        rows.push_back({static_cast<float>(r), 1, 2, 0, 0.6F, 0.8F, 1, 0.5F});
    return rows;
}

std::string zemax_file() {
    test::ZemaxFile file;
    file.ray_format = 2;
    file.source_flux = 3;
    file.rows = many_rows();
    return to_bytes(file);
}

std::string lighttools_file() {
    test::LightToolsFile file;
    file.is_luminous = 0;
    file.color = 2;
    file.flux = 3;
    file.rows = many_rows();
    return to_bytes(file);
}

std::string speos_file() {
    test::SpeosFile file;
    file.rows = many_rows();
    for (auto& row : file.rows)
        row[6] = 500;
    return to_bytes(file);
}

std::string text_rows() {
    std::string text;
    for (int r = 0; r < 100; ++r)
        text += std::to_string(r) + " 1 2 0 .6 8e-1 1 0.5\n";
    return text;
}

std::string zemax_text() {
    return "100 4 0 0 0 0 0 0\n" + text_rows();
}

std::string lighttools_text() {
    return "# LightTools 8.7.0\nlt_datatype: radiant_flux\nlt_color_info: wavelength\n"
           "lt_length_units: millimeters\nlt_data_origin: 0 0 0\nlt_radiant_flux: 1\n"
           "lt_startofdata\n" +
           text_rows() + "lt_endofdata\n";
}

class DamagedRays : public testing::TestWithParam<std::string (*)()> {};

// Proves that damaged files give rays or an Error: no other exception, no crash, no allocation that
// fails. Says nothing about whether the rays of a file whose damage is plausible are right.
TEST_P(DamagedRays, GiveRaysOrAnError) {
    const std::string whole = GetParam()();
    ASSERT_EQ(rays::read_rays(test::write_bytes("fuzz.rays", whole)).rays.size(), 100U);
    std::uint64_t refused = 0;
    for (std::uint64_t seed = 0; seed < test::fuzz_count(); ++seed) {
        test::write_bytes("fuzz.rays", test::mutate(whole, seed));
        try {
            const rays::RaySet set = rays::read_rays("fuzz.rays");
            ASSERT_LE(set.rays.size() * 12, whole.size() + 4096) << "seed " << seed;
            for (const rays::Ray& ray : set.rays)
                for (int k = 0; k < 3; ++k)
                    ASSERT_TRUE(std::isfinite(ray.position_m[k])) << "seed " << seed;
        } catch (const Error& error) {
            ++refused;
            ASSERT_FALSE(error.where.empty()) << "seed " << seed;
        } catch (const std::exception& error) {
            FAIL() << "seed " << seed << ": " << error.what();
        }
    }
    EXPECT_GT(refused, test::fuzz_count() / 10);
}

INSTANTIATE_TEST_SUITE_P(OfEveryFormat,
                         DamagedRays,
                         testing::Values(tm25_file,
                                         zemax_file,
                                         lighttools_file,
                                         speos_file,
                                         zemax_text,
                                         lighttools_text));

}  // namespace
}  // namespace nearfield
