// SPDX-License-Identifier: Apache-2.0
// Proves that every field and value of light fields and luminaires survives a file, bit for bit. It
// does not prove that other programs understand the file: python_reader_test.cpp does.
#include "formats/files/error.h"
#include "formats/files/image.h"
#include "formats/files/lightfield.h"
#include "formats/files/luminaire.h"
#include "tests/files/sample_lightfield.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

namespace nearfield::test {
namespace {

void expect_equal(const Slab& a, const Slab& b) {
    EXPECT_EQ(a.luminaire_from_slab.rotation, b.luminaire_from_slab.rotation);
    EXPECT_EQ(a.luminaire_from_slab.translation_m, b.luminaire_from_slab.translation_m);
    EXPECT_EQ(a.delta_m, b.delta_m);
    EXPECT_EQ(a.grid, b.grid);
    EXPECT_EQ(a.pitch_m, b.pitch_m);
    EXPECT_EQ(a.u_center_m, b.u_center_m);
    EXPECT_EQ(a.texels, b.texels);
    EXPECT_EQ(a.s_min_m, b.s_min_m);
    EXPECT_EQ(a.s_max_m, b.s_max_m);
    EXPECT_EQ(a.profile.name, b.profile.name);
    EXPECT_EQ(a.profile.cells, b.profile.cells);
    EXPECT_EQ(a.weighting, b.weighting);
    EXPECT_EQ(a.channels, b.channels);
    EXPECT_EQ(a.coeffs, b.coeffs);
    EXPECT_EQ(a.sigma, b.sigma);
    EXPECT_EQ(a.replicates, b.replicates);
}

void expect_equal(const LightField& a, const LightField& b) {
    EXPECT_EQ(a.quantity, b.quantity);
    EXPECT_EQ(a.scale_sigma_rel, b.scale_sigma_rel);
    EXPECT_EQ(a.provenance.program, b.provenance.program);
    EXPECT_EQ(a.provenance.command, b.provenance.command);
    EXPECT_EQ(a.provenance.options, b.provenance.options);
    EXPECT_EQ(a.provenance.figures, b.provenance.figures);
    ASSERT_EQ(a.provenance.inputs.size(), b.provenance.inputs.size());
    for (std::size_t k = 0; k < a.provenance.inputs.size(); ++k) {
        EXPECT_EQ(a.provenance.inputs[k].name, b.provenance.inputs[k].name);
        EXPECT_EQ(a.provenance.inputs[k].xxh128, b.provenance.inputs[k].xxh128);
    }
    ASSERT_EQ(a.slabs.size(), b.slabs.size());
    for (std::size_t k = 0; k < a.slabs.size(); ++k)
        expect_equal(a.slabs[k], b.slabs[k]);
}

void expect_equal(const SlabTables& a, const SlabTables& b) {
    EXPECT_EQ(a.total, b.total);
    EXPECT_EQ(a.median_s_m, b.median_s_m);
    EXPECT_EQ(a.sat_hi, b.sat_hi);
    EXPECT_EQ(a.sat_lo, b.sat_lo);
    EXPECT_EQ(a.marginal_cdf, b.marginal_cdf);
    EXPECT_EQ(a.conditional_cdf, b.conditional_cdf);
    EXPECT_EQ(a.cells, b.cells);
    EXPECT_EQ(a.cell_reference_s_m, b.cell_reference_s_m);
    EXPECT_EQ(a.cell_total, b.cell_total);
    ASSERT_EQ(a.mips.size(), b.mips.size());
    for (std::size_t k = 0; k < a.mips.size(); ++k) {
        EXPECT_EQ(a.mips[k].texels, b.mips[k].texels);
        EXPECT_EQ(a.mips[k].coeffs, b.mips[k].coeffs);
    }
}

TEST(LightFieldFile, KeepsEveryFieldOfSeveralDifferentSlabs) {
    const LightField written = sample_lightfield();
    write_lightfield(written, RunRecord{"2026-01-01T00:00:00Z", 1.5, 20, 2},
                     "several.lightfield.exr");
    expect_equal(read_lightfield("several.lightfield.exr"), written);
    EXPECT_EQ(read_kind("several.lightfield.exr").kind, "lightfield");
    EXPECT_EQ(read_kind("several.lightfield.exr").format_version, kFormatVersion);
}

TEST(LightFieldFile, KeepsReplicatesInBothKindsOfFile) {
    Luminaire written = sample_luminaire();
    for (Slab& slab : written.lightfield.slabs)
        for (int r = 0; r < 12; ++r) {
            slab.replicates.push_back(slab.coeffs);
            slab.replicates.back()[static_cast<std::size_t>(r)] += 0.5F;
        }
    write_lightfield(written.lightfield, std::nullopt, "replicates.lightfield.exr");
    expect_equal(read_lightfield("replicates.lightfield.exr"), written.lightfield);
    write_luminaire(written, std::nullopt, "replicates.luminaire.exr");
    expect_equal(read_luminaire("replicates.luminaire.exr").lightfield, written.lightfield);
    written.lightfield.slabs[1].replicates.pop_back();
    EXPECT_THROW(write_lightfield(written.lightfield, std::nullopt, "odd.lightfield.exr"), Error);
}

TEST(LightFieldFile, KeepsShapesFromOneTexelToManyImages) {
    for (const SampleShape& shape :
         {SampleShape{{1, 1}, {1, 1}, 1, false}, SampleShape{{1, 1}, {1, 1}, 3, true},
          SampleShape{{7, 5}, {1, 9}, 3, false}, SampleShape{{2, 9}, {33, 1}, 1, true},
          SampleShape{{11, 9}, {17, 31}, 3, true}}) {
        LightField written;
        written.slabs.push_back(sample_slab(shape));
        write_lightfield(written, std::nullopt, "shape.lightfield.exr");
        expect_equal(read_lightfield("shape.lightfield.exr"), written);
    }
}

TEST(LightFieldFile, IsTheSameByteForByteWithoutARunRecord) {
    write_lightfield(sample_lightfield(), std::nullopt, "first.lightfield.exr");
    write_lightfield(sample_lightfield(), std::nullopt, "second.lightfield.exr");
    EXPECT_EQ(read_bytes("first.lightfield.exr"), read_bytes("second.lightfield.exr"));
}

// Proves that pictures come back bit by bit, those of noise too, which compression only makes
// larger: from less than a chunk's rows to several.
TEST(PictureFile, KeepsWhatDoesNotCompress) {
    for (const glm::ivec2 size_px : {glm::ivec2(1, 1), {5, 3}, {16, 8}, {33, 40}}) {
        Picture written;
        written.size_px = size_px;
        written.layers = {{"", {"R", "G", "B"}, {}}};
        std::mt19937_64 random(1);
        for (int k = 0; k < 3 * size_px.x * size_px.y; ++k)  // 23 random bits each
            written.layers[0].values.push_back(
                std::ldexp(static_cast<float>(random() >> 41U), static_cast<int>(random() % 60U)));
        write_picture(written, std::nullopt, "noise.exr");
        const Picture read = read_picture("noise.exr");
        ASSERT_EQ(read.layers.size(), 1U);
        EXPECT_EQ(read.layers[0].values, written.layers[0].values) << size_px.x;
    }
}

TEST(LuminaireFile, KeepsEveryTable) {
    const Luminaire written = sample_luminaire();
    write_luminaire(written, std::nullopt, "packed.luminaire.exr");
    const Luminaire read = read_luminaire("packed.luminaire.exr");
    expect_equal(read.lightfield, written.lightfield);
    ASSERT_EQ(read.tables.size(), written.tables.size());
    for (std::size_t k = 0; k < read.tables.size(); ++k)
        expect_equal(read.tables[k], written.tables[k]);
    EXPECT_EQ(read_kind("packed.luminaire.exr").kind, "luminaire");
}

TEST(LuminaireFile, GivesItsLightFieldToReadersThatKnowNoTables) {
    const Luminaire written = sample_luminaire();
    write_luminaire(written, std::nullopt, "inside.luminaire.exr");
    expect_equal(read_lightfield("inside.luminaire.exr"), written.lightfield);
}

TEST(LuminaireFile, MayBePackedLean) {
    Luminaire written = sample_luminaire();
    write_luminaire(written, std::nullopt, "full.luminaire.exr");
    written.tables.clear();
    write_luminaire(written, std::nullopt, "lean.luminaire.exr");
    const Luminaire read = read_luminaire("lean.luminaire.exr");
    expect_equal(read.lightfield, written.lightfield);
    EXPECT_TRUE(read.tables.empty());
    EXPECT_LT(std::filesystem::file_size("lean.luminaire.exr"),
              std::filesystem::file_size("full.luminaire.exr"));
}

}  // namespace
}  // namespace nearfield::test
