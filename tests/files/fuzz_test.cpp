// SPDX-License-Identifier: Apache-2.0
// Proves that no damaged file crashes a reader, raises anything but Error, or makes it allocate
// what the file's size cannot justify. Under AddressSanitizer it proves more: no read or write out
// of bounds. It does not prove that every damage is noticed: EXR has no checksums.
#include "formats/files/error.h"
#include "formats/files/image.h"
#include "formats/files/luminaire.h"
#include "formats/files/points.h"
#include "tests/files/allocations.h"
#include "tests/files/sample_lightfield.h"
#include "tests/support/mutate.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <functional>

namespace nearfield::test {
namespace {

void write_bytes(const std::string& bytes, const std::string& path) {
    // A new file each time: file systems flush one that is truncated and rewritten, which takes
    // milliseconds.
    std::remove(path.c_str());
    std::ofstream(path, std::ios::binary) << bytes;
}

struct Outcome {
    std::uint64_t read = 0, refused = 0;
};

/// Tries fuzz_count() mutations of a valid file on a reader.
Outcome fuzz(const std::string& valid_path,
             const std::string& mutated_path,
             const std::function<void(const std::string&)>& read) {
    const std::string valid = read_bytes(valid_path);
    // Deflate unpacks to at most 1032 times; small buffers (numbers as JSON, messages) come on top.
    constexpr std::size_t kExpansion = 1032, kSmall = 1 << 16;
    Outcome outcome;
    for (std::uint64_t seed = 0; seed < fuzz_count(); ++seed) {
        const std::string mutated = mutate(valid, seed);
        write_bytes(mutated, mutated_path);
        reset_largest_allocation();
        try {
            read(mutated_path);
            ++outcome.read;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(mutated_path), std::string::npos)
                << "the message names no file: " << error.what();
            ++outcome.refused;
        } catch (const std::exception& error) {
            ADD_FAILURE() << "seed " << seed << " raised " << error.what();
        }
        EXPECT_LE(largest_allocation(), kExpansion * mutated.size() + kSmall) << "seed " << seed;
    }
    return outcome;
}

// Most mutations must be noticed, some must be harmless: else the test would try nothing.
void expect_both(const Outcome& outcome) {
    EXPECT_GT(outcome.refused, fuzz_count() / 10);
    EXPECT_GT(outcome.read, fuzz_count() / 100);
}

TEST(Fuzz, LightFieldsAreReadOrRefused) {
    LightField lightfield;
    lightfield.slabs.push_back(sample_slab({{2, 1}, {3, 2}, 3, true}));
    write_lightfield(lightfield, std::nullopt, "fuzz.lightfield.exr");
    expect_both(fuzz("fuzz.lightfield.exr", "mutated.lightfield.exr", [](const auto& path) {
        check(read_lightfield(path), path);  // whatever is read obeys the rules
    }));
}

TEST(Fuzz, LuminairesAreReadOrRefused) {
    write_luminaire(sample_luminaire(), RunRecord{"2026-01-01T00:00:00Z", 1, 2, 3},
                    "fuzz.luminaire.exr");
    expect_both(fuzz("fuzz.luminaire.exr", "mutated.luminaire.exr",
                     [](const auto& path) { check(read_luminaire(path).lightfield, path); }));
}

TEST(Fuzz, PicturesAreReadOrRefused) {
    Picture picture;
    picture.size_px = {5, 20};
    picture.layers = {{"", {"R", "G", "B"}, std::vector<float>(300, 0.5F)},
                      {"depth", {"Z"}, std::vector<float>(100, 2.0F)}};
    write_picture(picture, std::nullopt, "fuzz.exr");
    expect_both(fuzz("fuzz.exr", "mutated.exr", [](const auto& path) { read_picture(path); }));
}

TEST(Fuzz, PointListsAreReadOrRefused) {
    write_bytes("x_m,y_m,z_m,nx,ny,nz\n0,0.5,10,0,0,-1\n-1e-3,+2,3.25,1,1,1\n", "fuzz.csv");
    expect_both(fuzz("fuzz.csv", "mutated.csv", [](const auto& path) {
        for (const glm::dvec3& normal : read_points(path).normals)
            ASSERT_NEAR(glm::length(normal), 1.0, 1e-12);
    }));
}

}  // namespace
}  // namespace nearfield::test
