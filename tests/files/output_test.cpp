// SPDX-License-Identifier: Apache-2.0
// Proves that writers leave either the old file or the new one, and that pictures, point lists,
// hashes and run records are what they say.
#include "formats/files/atomic_file.h"
#include "formats/files/image.h"
#include "formats/files/luminaire.h"
#include "formats/files/points.h"
#include "tests/files/sample_lightfield.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>

namespace nearfield::test {
namespace {

using testing::HasSubstr;

std::size_t file_count(const std::string& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

/// Files may not grow beyond a size while it lives: what a full disk looks like.
class FullDisk {
  public:
    explicit FullDisk(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);  // write() is to fail instead
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;

  private:
    rlimit before_{};
};

TEST(AtomicFile, AFailingWriteLeavesTheOldFileAndNothingElse) {
    std::filesystem::remove_all("full");
    std::filesystem::create_directory("full");
    const std::string path = "full/lamp.luminaire.exr";
    write_luminaire(sample_luminaire(), std::nullopt, path);
    const std::string old = read_bytes(path);
    // Somewhere in the header, in the chunk tables, in the data.
    for (const rlim_t bytes : {10, 500, 4000, 9000}) {
        ASSERT_LT(bytes, old.size());
        const FullDisk disk(bytes);
        EXPECT_THAT(message_of([&] { write_luminaire(sample_luminaire(), std::nullopt, path); }),
                    HasSubstr("File too large"));
    }
    EXPECT_EQ(read_bytes(path), old);
    EXPECT_EQ(file_count("full"), 1U);
}

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
    std::filesystem::remove_all("atomic");
    std::filesystem::create_directory("atomic");
    {
        AtomicFile abandoned("atomic/text");
        abandoned.write_at("abc", 3, 0);
        EXPECT_FALSE(std::filesystem::exists("atomic/text"));
    }
    EXPECT_EQ(file_count("atomic"), 0U);
    write_file("abc", "atomic/text");
    EXPECT_EQ(read_bytes("atomic/text"), "abc");
    EXPECT_EQ(file_count("atomic"), 1U);
}

TEST(AtomicFile, RefusesMissingFoldersAndDevices) {
    EXPECT_THAT(message_of([] { write_file("", "no_such_folder/file"); }),
                HasSubstr("no_such_folder/file: cannot create file"));
    EXPECT_THAT(message_of([] { write_file("", "/dev/null"); }), HasSubstr("regular file"));
}

Picture sample_picture() {
    Picture picture;
    picture.size_px = {7, 37};  // more than one block of 16 scanlines
    const std::size_t pixels = std::size_t{7} * 37;
    std::vector<float> colors(3 * pixels), depth(pixels);
    for (std::size_t k = 0; k < colors.size(); ++k)
        colors[k] = 0.25F * static_cast<float>(k);
    for (std::size_t k = 0; k < depth.size(); ++k)
        depth[k] = -static_cast<float>(k);
    depth[5] = std::numeric_limits<float>::infinity();  // what the sky is
    picture.layers = {{"", {"R", "G", "B"}, colors},
                      {"depth", {"Z"}, depth},
                      {"lamp.left", {"R", "G", "B"}, colors}};
    picture.provenance.program = "nearfield test";
    return picture;
}

TEST(Picture, KeepsItsLayersThroughAFile) {
    const Picture written = sample_picture();
    write_picture(written, std::nullopt, "layers.exr");
    const Picture read = read_picture("layers.exr");
    EXPECT_EQ(read.size_px, written.size_px);
    EXPECT_EQ(read.provenance.program, written.provenance.program);
    ASSERT_EQ(read.layers.size(), written.layers.size());
    for (std::size_t k = 0; k < read.layers.size(); ++k) {
        EXPECT_EQ(read.layers[k].name, written.layers[k].name);
        EXPECT_EQ(read.layers[k].channels, written.layers[k].channels);
        EXPECT_EQ(read.layers[k].values, written.layers[k].values);
    }
}

TEST(Picture, RefusesLayersOfAnotherSizeAndFilesOfSeveralParts) {
    Picture picture = sample_picture();
    picture.layers[1].values.pop_back();
    EXPECT_THAT(message_of([&] { write_picture(picture, std::nullopt, "bad.exr"); }),
                HasSubstr("layer 'depth': bad picture: expected 259 values, got 258"));
    write_luminaire(sample_luminaire(), std::nullopt, "parts.luminaire.exr");
    EXPECT_THAT(message_of([] { read_picture("parts.luminaire.exr"); }), HasSubstr("one part"));
}

TEST(Png, HasTheSignatureAndSizeOfAPng) {
    write_png(std::vector<unsigned char>(std::size_t{3} * 4 * 2, 128), {4, 2}, "gray.png");
    const std::string bytes = read_bytes("gray.png");
    EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1A\n");
    EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\0\4\0\0\0\2", 8));
    EXPECT_THAT(message_of([] {
                    write_png({1, 2}, {1, 1}, "bad.png");
                }),
                HasSubstr("expected 3 bytes, got 2"));
}

TEST(Provenance, HashesAsXxh128sumDoes) {
    write_file("", "empty");
    EXPECT_EQ(hash_file("empty"), "99aa06d3014798d86001c324468d497f");  // xxh128sum 0.8.1
    write_file("nearfield\n", "text");
    EXPECT_EQ(hash_file("text"), "c272840e4bb6144410f66b5ac54dc2ae");
    EXPECT_EQ(describe_input("./text").name, "text");
    EXPECT_THAT(message_of([] { hash_file("no_such_file"); }), HasSubstr("no_such_file"));
}

TEST(Provenance, RunRecordsSayDateTimeAndMemory) {
    const RunRecord run = finish_run(now_s() - 2.0, 3);
    EXPECT_THAT(run.date_utc, testing::MatchesRegex("20..-..-..T..:..:..Z"));
    EXPECT_NEAR(run.time_s, 2.0, 1.0);  // a loaded machine is slow, not wrong
    EXPECT_GT(run.peak_memory_mib, 1.0);
    EXPECT_EQ(run.threads, 3);
    EXPECT_THAT(program_version(), testing::MatchesRegex("nearfield [0-9]+\\.[0-9]+\\.[0-9]+"));
}

PointList points_of(const std::string& text) {
    std::filesystem::remove("points.csv");
    write_file(text, "points.csv");
    return read_points("points.csv");
}

TEST(Points, AreReadInAnyColumnOrderWithTheirText) {
    const PointList points = points_of(
        "\xEF\xBB\xBFname, nz,ny,nx,z_m,y_m,x_m\r\n"
        "a,-2,0,0, 3.50 ,+2,1e0\r\n"
        "\r\n"
        "b,1e-300,1e-300,0,6,5,4");
    ASSERT_EQ(points.positions_m.size(), 2U);
    EXPECT_EQ(points.positions_m[0], glm::dvec3(1, 2, 3.5));
    EXPECT_EQ(points.positions_m[1], glm::dvec3(4, 5, 6));
    EXPECT_EQ(points.normals[0], glm::dvec3(0, 0, -1));
    EXPECT_NEAR(points.normals[1].y, std::sqrt(0.5), 1e-15);
    EXPECT_EQ(points.lines_text[0], "1e0,+2,3.50,0,0,-2");
}

TEST(Points, AreRefusedWithLineAndColumn) {
    const std::string header = "x_m,y_m,z_m,nx,ny,nz\n0,0,0,0,0,1\n";
    const auto refusal = [](const std::string& text) {
        return message_of([&] { points_of(text); });
    };
    EXPECT_THAT(refusal(""), HasSubstr("points.csv: empty file"));
    EXPECT_THAT(refusal("x_m,y_m,z_m,nx,ny\n"), HasSubstr("0 times nz"));
    EXPECT_THAT(refusal("x_m,x_m,y_m,z_m,nx,ny,nz\n"), HasSubstr("2 times x_m"));
    EXPECT_EQ(refusal(header + "1,2,x,0,0,1\n"),
              "points.csv, line 3, column z_m: bad number: expected a finite number, got 'x'");
    for (const char* bad : {"", "nan", "inf", "1e999", "1 2", "0x10", "1.5m"})
        EXPECT_THAT(refusal(header + "1," + bad + ",3,0,0,1\n"), HasSubstr("line 3, column y_m"));
    EXPECT_THAT(refusal(header + "1,2,3,0,0\n"), HasSubstr("line 3, column nz"));
    EXPECT_THAT(refusal(header + "1,2,3,0,0,-0.0\n"), HasSubstr("bad normal"));
}

}  // namespace
}  // namespace nearfield::test
