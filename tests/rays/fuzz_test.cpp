// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/rays/tm25.h"
#include "tests/rays/ray_file.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

namespace nearfield {
namespace {

// A file with every kind of item, so that damage reaches every branch of the reader.
std::string whole_file() {
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

// Proves that damaged files give rays or an Error: no other exception, no crash, no allocation that
// fails. Says nothing about whether the rays of a file whose damage is plausible are right.
TEST(ReadTm25, AnswersDamagedFilesWithRaysOrAnError) {
    const std::string whole = whole_file();
    ASSERT_EQ(rays::read_tm25(test::write_bytes("fuzz.tm25ray", whole)).rays.size(), 100U);
    std::uint64_t refused = 0;
    for (std::uint64_t seed = 0; seed < test::fuzz_count(); ++seed) {
        test::write_bytes("fuzz.tm25ray", test::mutate(whole, seed));
        try {
            const rays::RaySet set = rays::read_tm25("fuzz.tm25ray");
            ASSERT_LE(set.rays.size() * 28, whole.size() + 4096) << "seed " << seed;
        } catch (const Error& error) {
            ++refused;
            ASSERT_FALSE(error.where.empty()) << "seed " << seed;
        } catch (const std::exception& error) {
            FAIL() << "seed " << seed << ": " << error.what();
        }
    }
    EXPECT_GT(refused, test::fuzz_count() / 10);
}

}  // namespace
}  // namespace nearfield
