// SPDX-License-Identifier: Apache-2.0
// Proves that no damaged rig crashes its reader or raises anything but Error.
#include "formats/files/error.h"
#include "formats/files/read_file.h"
#include "tests/rig/small_rig.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace nearfield::rig {
namespace {

TEST(RigFuzz, RigsAreReadOrRefused) {
    const std::string path = "fuzzed.json";
    write_rig(test::small_rig(), test::small_maps(), std::nullopt, path);
    const std::string valid = read_file(path);
    std::uint64_t taken = 0, refused = 0;
    for (std::uint64_t seed = 0; seed < nearfield::test::fuzz_count(); ++seed) {
        std::filesystem::remove(path);
        std::ofstream(path, std::ios::binary) << nearfield::test::mutate(valid, seed);
        try {
            read_rig(path);
            read_maps(path);
            ++taken;
        } catch (const Error&) {
            ++refused;
        } catch (const std::exception& error) {
            ADD_FAILURE() << "seed " << seed << " raised " << error.what();
        }
    }
    EXPECT_GT(refused, nearfield::test::fuzz_count() / 10);
    EXPECT_GT(taken, 0U);
}

}  // namespace
}  // namespace nearfield::rig
