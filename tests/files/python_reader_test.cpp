// SPDX-License-Identifier: Apache-2.0
// Proves that docs/formats.md is enough to read our files: docs/read_luminaire.py, which shares no
// code with us, finds the same radiance as the model in files that the C++ wrote, and the same flux
// where it is a plain sum (irradiance weighting).
#include "formats/files/luminaire.h"
#include "formats/model/luminaire.h"
#include "tests/files/sample_lightfield.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstdlib>

namespace nearfield::test {
namespace {

constexpr const char* kPython = "/usr/bin/python3";  // Debian's, which has Debian's modules

// Both sides compute in double from the same floats; what remains is the order of sums.
constexpr double kTolerance = 1e-9;

std::string output_of(const std::string& command) {
    std::string output;
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr)
        return output;
    std::array<char, 4096> block{};
    for (std::size_t size = 0; (size = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
        output.append(block.data(), size);
    pclose(pipe);
    return output;
}

void expect_near(const std::vector<double>& python, glm::dvec3 ours, double tolerance) {
    ASSERT_TRUE(python.size() == 1 || python.size() == 3);
    for (std::size_t c = 0; c < python.size(); ++c) {
        const double expected = ours[static_cast<int>(c)];
        EXPECT_GT(expected, 0.0);
        EXPECT_NEAR(python[c], expected, tolerance * expected);
    }
}

class PythonReader : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        const std::string command =
            std::string(kPython) + " -c 'import numpy, OpenImageIO' >/dev/null 2>&1";
        // One thread: nothing else runs beside a test.
        if (std::system(command.c_str()) == 0)  // NOLINT(concurrency-mt-unsafe)
            return;
        const char* ci = std::getenv("CI");  // NOLINT(concurrency-mt-unsafe)
        if (ci != nullptr && std::string(ci) == "true")
            FAIL() << "python3-numpy and python3-openimageio must be installed where CI=true";
        GTEST_SKIP() << "needs python3-numpy and python3-openimageio";
    }
};

TEST_P(PythonReader, FindsTheFluxAndRadianceOfTheModel) {
    const std::string path = GetParam();
    const LightField lightfield = sample_lightfield();
    if (path.ends_with(".luminaire.exr"))
        write_luminaire(sample_luminaire(), std::nullopt, path);
    else
        write_lightfield(lightfield, std::nullopt, path);

    for (std::size_t k = 0; k < lightfield.slabs.size(); ++k) {
        const Slab& slab = lightfield.slabs[k];
        const glm::dvec2 u = slab.u_center_m + glm::dvec2(0.3, -0.2) * slab.pitch_m;
        const glm::dvec2 s = slab.s_min_m + glm::dvec2(0.7, 0.6) * (slab.s_max_m - slab.s_min_m);
        const auto answer = nlohmann::json::parse(output_of(
            fmt::format("{} '{}/docs/read_luminaire.py' {} {} {:.17g} {:.17g} {:.17g} {:.17g}",
                        kPython, NEARFIELD_SOURCE_DIR, path, k, u.x, u.y, s.x, s.y)));
        expect_near(answer["radiance"].get<std::vector<double>>(), model::radiance(slab, u, s),
                    kTolerance);
        if (slab.weighting == Weighting::Irradiance)
            expect_near(answer["flux"][k].get<std::vector<double>>(), model::flux(slab),
                        kTolerance);
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds,
                         PythonReader,
                         testing::Values("python.lightfield.exr", "python.luminaire.exr"),
                         [](const auto& values) {
                             return std::string(values.param).substr(7, 5) == "light" ? "LightField"
                                                                                      : "Luminaire";
                         });

}  // namespace
}  // namespace nearfield::test
