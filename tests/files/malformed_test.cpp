// SPDX-License-Identifier: Apache-2.0
// Proves that broken light fields are refused with file, place, expected and got, when reading and
// when writing.
#include "formats/files/exr_file.h"
#include "formats/files/luminaire.h"
#include "formats/files/metadata.h"
#include "tests/files/sample_lightfield.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

namespace nearfield::test {
namespace {

using testing::HasSubstr;

std::string message_of_reading(const std::string& path) {
    return message_of([&] { read_lightfield(path); });
}

/// A light field of one slab written by hand: any description, any part.
struct RawFile {
    LightField lightfield;
    nlohmann::ordered_json description;
    std::vector<exr::Atlas<const float>> atlases;

    RawFile() {
        lightfield.slabs.push_back(sample_slab({{3, 2}, {5, 4}, 1, true}));
        const Slab& slab = lightfield.slabs[0];
        description = nlohmann::ordered_json::parse(
            describe(lightfield, {"lightfield", kFormatVersion}, false));
        add("slab0.coeffs", slab.grid, slab.texels, slab.coeffs);
        add("slab0.sigma", slab.grid, slab.texels, slab.sigma);
    }
    void add(const std::string& part,
             glm::ivec2 grid,
             glm::ivec2 image,
             const std::vector<float>& values) {
        atlases.push_back({part, grid, image, {exr::upright("Y", values.data(), image)}});
    }
    std::string message() const {
        exr::write(atlases, exr::Compression::Zip, {{kLuminaireAttribute, description.dump()}},
                   "raw.lightfield.exr");
        return message_of_reading("raw.lightfield.exr");
    }
};

TEST(MalformedLightField, HandMadeFileIsValidUnlessBroken) {
    EXPECT_EQ(RawFile().message(), "");
}

TEST(MalformedLightField, TruncatedAnywhereIsRefused) {
    write_lightfield(sample_lightfield(), std::nullopt, "whole.lightfield.exr");
    const std::string whole = read_bytes("whole.lightfield.exr");
    for (std::size_t size = 0; size < whole.size(); size += 1 + size / 100) {
        std::ofstream("cut.lightfield.exr", std::ios::binary) << whole.substr(0, size);
        EXPECT_THAT(message_of_reading("cut.lightfield.exr"), HasSubstr("cut.lightfield.exr"))
            << "after " << size << " bytes of " << whole.size();
        std::filesystem::remove("cut.lightfield.exr");
    }
}

TEST(MalformedLightField, MissingFileFolderAndPlainExrAreRefused) {
    EXPECT_THAT(message_of_reading("no_such_file.exr"), HasSubstr("No such file"));
    EXPECT_THAT(message_of_reading("."), HasSubstr("expected a regular file"));
    RawFile raw;
    exr::write(raw.atlases, exr::Compression::None, {}, "plain.exr");
    EXPECT_THAT(message_of_reading("plain.exr"), HasSubstr("nearfield.luminaire"));
}

TEST(MalformedLightField, NewerMissingOrForeignVersionsAreRefused) {
    RawFile raw;
    raw.description["format_version"] = kFormatVersion + 1;
    EXPECT_EQ(raw.message(),
              "raw.lightfield.exr, nearfield.luminaire.format_version: file is newer than this "
              "program: expected at most 1, got 2");
    raw.description["format_version"] = 0;
    EXPECT_THAT(raw.message(), HasSubstr("format_version"));
    raw.description["format_version"] = 1.5;
    EXPECT_THAT(raw.message(), HasSubstr("expected an integer"));
    raw.description.erase("format_version");
    EXPECT_THAT(raw.message(), HasSubstr("key 'format_version'"));
    raw.description["kind"] = "lamp";
    EXPECT_THAT(raw.message(), HasSubstr("expected lightfield or luminaire, got 'lamp'"));
}

TEST(MalformedLightField, EveryKeyIsRequiredAndTyped) {
    const RawFile valid;
    const auto expect_refused = [&](const std::string& pointer) {
        const nlohmann::ordered_json::json_pointer place(pointer);
        RawFile missing;
        missing.description.at(place.parent_pointer()).erase(place.back());
        EXPECT_THAT(missing.message(), HasSubstr("key '" + place.back() + "'"));
        RawFile wrong;
        wrong.description[place] = nlohmann::ordered_json::object({{"a", 1}});
        EXPECT_THAT(wrong.message(), HasSubstr(place.back() + ": "));
    };
    for (const auto& [key, value] : valid.description.items())
        expect_refused("/" + key);
    for (const auto& [key, value] : valid.description["slabs"][0].items())
        if (key != "coeffs_unit")  // for people
            expect_refused("/slabs/0/" + key);
    expect_refused("/slabs/0/luminaire_from_slab/rotation");
    expect_refused("/slabs/0/luminaire_from_slab/translation_m");
}

TEST(MalformedLightField, ImpossibleGeometryIsRefused) {
    const auto expect_refused = [](const std::string& key, const nlohmann::json& value) {
        RawFile raw;
        raw.description["slabs"][0][key] = value;
        EXPECT_THAT(raw.message(), HasSubstr("slabs[0]." + key)) << value;
    };
    expect_refused("delta_m", 0);
    expect_refused("delta_m", -1);
    expect_refused("pitch_m", {0, 1});
    expect_refused("pitch_m", {1, 1, 1});
    expect_refused("s_max_m", {-1, 1});
    expect_refused("grid", {0, 1});
    expect_refused("grid", {1 << 30, 1});
    expect_refused("texels", {1, -1});
    expect_refused("texels", {1e300, 1});
    expect_refused("profile_cells", nlohmann::json::array());
    expect_refused("profile_cells", {{1, 2}});
    expect_refused("channels", {"R", "G"});
    RawFile mirrored;
    mirrored.description["slabs"][0]["luminaire_from_slab"]["rotation"] = {1, 0, 0, 0, 1,
                                                                           0, 0, 0, -1};
    EXPECT_THAT(mirrored.message(), HasSubstr("proper rotation"));
    RawFile none;
    none.description["slabs"] = nlohmann::json::array();
    EXPECT_THAT(none.message(), HasSubstr("1 to 1024 slabs"));
}

TEST(MalformedLightField, PartsThatContradictTheDescriptionAreRefused) {
    RawFile raw;
    raw.description["slabs"][0]["grid"] = {2, 3};
    EXPECT_THAT(raw.message(), HasSubstr("part slab0.coeffs: wrong size: expected 10 x 12"));
    raw = RawFile();
    raw.atlases[0].planes[0].channel = "Z";
    EXPECT_THAT(raw.message(), HasSubstr("part slab0.coeffs: wrong channels: expected Y, got Z"));
    raw = RawFile();
    raw.atlases.pop_back();
    EXPECT_THAT(raw.message(), HasSubstr("part slab0.sigma: missing part"));
    raw = RawFile();
    raw.description["slabs"].push_back(raw.description["slabs"][0]);
    EXPECT_THAT(raw.message(), HasSubstr("part slab1.coeffs: missing part"));
}

TEST(MalformedLightField, BadCoefficientsAreRefusedWithTheirTexel) {
    for (const auto& [value, text] : {std::pair{-1.0F, "-1"},
                                      {std::numeric_limits<float>::quiet_NaN(), "nan"},
                                      {std::numeric_limits<float>::infinity(), "inf"}}) {
        RawFile raw;
        // Image 4 is row 1, column 1; texel (3, 2) of 5 x 4.
        Slab& slab = raw.lightfield.slabs[0];
        slab.coeffs[4 * 20 + 2 * 5 + 3] = value;
        raw.atlases[0].planes[0].data = slab.coeffs.data();
        raw.atlases[1].planes[0].data = slab.sigma.data();
        EXPECT_EQ(
            raw.message(),
            std::string("raw.lightfield.exr, part slab0.coeffs, image 4, texel (3, 2), channel "
                        "Y: bad value: expected finite and >= 0, got ") +
                text);
        EXPECT_EQ(message_of([&] { check(raw.lightfield, "lamp"); }),
                  std::string("lamp, slabs[0].coeffs, image 4, texel (3, 2), channel Y: bad value: "
                              "expected finite and >= 0, got ") +
                      text);
    }
}

TEST(MalformedLightField, SizesThatTheFileCannotHoldAreRefused) {
    // A file of one texel whose metadata and headers are made to promise 14 GB.
    LightField huge;
    huge.slabs.push_back(sample_slab({{1, 1}, {1, 1}, 1, false}));
    huge.slabs[0].texels = {60000, 60000};
    const std::vector<float> texel(1);
    exr::write({{"slab0.coeffs", {1, 1}, {1, 1}, {exr::upright("Y", texel.data(), {1, 1})}}},
               exr::Compression::Zip,
               {{kLuminaireAttribute, describe(huge, {"lightfield", kFormatVersion}, false)}},
               "huge.exr");
    std::string bytes = read_bytes("huge.exr");
    const auto patch = [&](const std::string& attribute, std::size_t skip, std::uint32_t value) {
        const std::size_t at = bytes.find(attribute) + attribute.size() + skip;
        for (std::size_t k = 0; k < 4; ++k)
            bytes[at + k] = static_cast<char>(value >> (8 * k));
    };
    // Four bytes of length, then the window's corners and the tile's sizes.
    const std::string window("dataWindow\0box2i\0", 17), tiles("tiles\0tiledesc\0", 15);
    patch(window, 12, 59999);
    patch(window, 16, 59999);
    patch(tiles, 4, 60000);
    patch(tiles, 8, 60000);
    std::ofstream("huge.exr", std::ios::binary) << bytes;
    EXPECT_THAT(message_of_reading("huge.exr"),
                HasSubstr("part slab0.coeffs: file is too small for its header"));
}

TEST(MalformedLuminaire, TablesOfAnotherShapeAreNotWritten) {
    const auto expect_refused = [](const char* name,
                                   const std::function<void(SlabTables&)>& spoil) {
        Luminaire luminaire = sample_luminaire();
        spoil(luminaire.tables[1]);
        EXPECT_THAT(
            message_of([&] { write_luminaire(luminaire, std::nullopt, "bad.luminaire.exr"); }),
            HasSubstr(std::string("slabs[1].") + name));
        EXPECT_FALSE(std::filesystem::exists("bad.luminaire.exr"));
    };
    expect_refused("total", [](SlabTables& t) { t.total.pop_back(); });
    expect_refused("sat_lo", [](SlabTables& t) { t.sat_lo.clear(); });
    expect_refused("conditional_cdf", [](SlabTables& t) { t.conditional_cdf.push_back(0); });
    expect_refused("mips", [](SlabTables& t) { t.mips.pop_back(); });
    expect_refused("mips[0]", [](SlabTables& t) { t.mips[0].texels.x += 1; });
    expect_refused("cells", [](SlabTables& t) { t.cells.x += 1; });
}

TEST(MalformedLuminaire, ALightFieldIsNoLuminaire) {
    write_lightfield(sample_lightfield(), std::nullopt, "plain.lightfield.exr");
    EXPECT_THAT(message_of([] { read_luminaire("plain.lightfield.exr"); }),
                HasSubstr("expected kind luminaire, got lightfield"));
}

}  // namespace
}  // namespace nearfield::test
