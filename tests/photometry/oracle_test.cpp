// SPDX-License-Identifier: Apache-2.0
// Compares the readers with photometry_oracle.py, which was written from the formats' descriptions
// without sight of them and shares no code: frames, symmetries, factors, openings, sums. On files
// that the tests make, and on all files of the optional shared folder.
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"
#include "tests/photometry/lamp_files.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdio>
#include <filesystem>

namespace nearfield {
namespace {

using photometry::Coordinates;
using photometry::Photometry;
using Json = nlohmann::json;

// Both compute in double; what remains is the order of sums, and angles rounded by files to 1e-6.
constexpr double kTolerance = 1e-6;

// What the oracle finds in each file, in their order.
Json oracle(const std::vector<std::string>& paths) {
    std::string command = "PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 '" NEARFIELD_SOURCE_DIR
                          "/tests/photometry/photometry_oracle.py' --array";
    for (const std::string& path : paths)
        command += " '" + path + "'";
    std::string output;
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr)
        return {};
    std::array<char, 4096> block{};
    for (std::size_t size = 0; (size = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
        output.append(block.data(), size);
    pclose(pipe);
    return Json::parse(output, nullptr, false);
}

// The oracle's z points up and its C90 along +y; ours has z down and C90 along -y.
glm::dvec3 photometry_from_oracle(const std::vector<double>& d) {
    return {d.at(0), -d.at(1), -d.at(2)};
}

void expect_agreement(const std::string& path, const Json& expected) {
    SCOPED_TRACE(path);
    ASSERT_FALSE(expected.contains("error")) << expected.dump();
    const Photometry lamp = photometry::read_photometry(path);
    EXPECT_EQ(lamp.format, expected["format"]);
    EXPECT_EQ(lamp.is_absolute, expected["absolute"].get<bool>());
    const double flux_lm = expected["flux_lm"], peak_cd = expected["peak_cd"];
    EXPECT_NEAR(photometry::flux_lm(lamp), flux_lm, kTolerance * flux_lm);
    EXPECT_NEAR(photometry::peak(lamp).intensity_cd, peak_cd, kTolerance * peak_cd);
    for (const Json& probe : expected["probes"]) {
        const glm::dvec3 d = photometry_from_oracle(probe["direction"]);
        EXPECT_NEAR(photometry::intensity_cd(lamp, d), probe["cd"].get<double>(),
                    kTolerance * peak_cd)
            << probe["direction"].dump();
    }
    if (lamp.opening.shape != photometry::Shape::Rectangle)
        return;
    // Lengths lie along plane 0 in LM-63, across it in EULUMDAT.
    const bool is_eulumdat = lamp.format == "EULUMDAT";
    const Json& opening = expected["opening_m"];
    EXPECT_NEAR(lamp.opening.size_m.x, opening[is_eulumdat ? "width" : "length"], 1e-12);
    EXPECT_NEAR(lamp.opening.size_m.y, opening[is_eulumdat ? "length" : "width"], 1e-12);
}

void expect_agreement(const std::vector<std::string>& paths) {
    const Json expected = oracle(paths);
    ASSERT_TRUE(expected.is_array());
    ASSERT_EQ(expected.size(), paths.size());
    for (std::size_t k = 0; k < paths.size(); ++k)
        expect_agreement(paths[k], expected[k]);
}

// The oracle takes V of type B up to 90 degrees alone.
test::Lm63File skew_type_b() {
    test::Lm63File file = test::skew_lm63(Coordinates::B, 15);
    file.angles = test::steps(-90, 90, 15);
    file.intensities.clear();
    for (const double plane : file.planes)
        for (const double angle : file.angles)
            file.intensities.push_back(
                test::skew_lamp_cd(test::east_north_up(Coordinates::B, plane, angle)));
    return file;
}

TEST(PhotometryOracle, AgreesOnALampWithoutSymmetryInEveryType) {
    expect_agreement(
        {test::write_text("oracle_a.ies", to_text(test::skew_lm63(Coordinates::A, 15))),
         test::write_text("oracle_b.ies", to_text(skew_type_b())),
         test::write_text("oracle_c.ies", to_text(test::skew_lm63(Coordinates::C, 15))),
         test::write_text("oracle.ldt", to_text(test::skew_ldt(15)))});
}

TEST(PhotometryOracle, AgreesOnFactorsUnitsAndOpenings) {
    test::Lm63File file = test::skew_lm63(Coordinates::C, 30);
    file.first_line = "IESNA91";
    file.multiplier = "2.5";
    file.factors = "0.9 0.8 100";
    file.unit = std::to_string(1);
    file.opening = "1.5 2.5 0";
    const std::string relative = test::write_text("oracle_1991.ies", to_text(file));
    file.first_line = "IESNA:LM-63-2002";
    file.lamps = "1 -1";
    expect_agreement({relative, test::write_text("oracle_2002.ies", to_text(file))});
}

TEST(PhotometryOracle, AgreesOnAllSharedFiles) {
    const std::filesystem::path folder =
        std::filesystem::path(NEARFIELD_SOURCE_DIR) / "../shared/data/photometry";
    if (!std::filesystem::exists(folder))
        GTEST_SKIP() << "optional folder " << folder << " is not there";
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            paths.push_back(entry.path().string());
    EXPECT_EQ(paths.size(), 43U);
    expect_agreement(paths);
}

}  // namespace
}  // namespace nearfield
