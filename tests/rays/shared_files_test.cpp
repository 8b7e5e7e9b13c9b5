// SPDX-License-Identifier: Apache-2.0
// Files that nobody of this project made, where they are at hand: every one is read, or refused for
// a true reason, and what is known of them comes out.
#include "formats/files/error.h"
#include "formats/rays/ray_file.h"
#include "formats/rays/survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

namespace nearfield {
namespace {

class SharedRays : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(folder_))
            GTEST_SKIP() << "optional folder " << folder_ << " is not there";
    }
    rays::RaySet read(const std::string& name, bool keep_ray_flux = false) const {
        rays::ReadOptions options;
        options.keep_ray_flux = keep_ray_flux;
        return rays::read_rays((folder_ / name).string(), options);
    }
    const std::filesystem::path folder_ =
        std::filesystem::path(NEARFIELD_SOURCE_DIR) / "../shared/data/rays";
};

// Positions, directions and shares of the flux; `tolerance` absolute, in m and 1, and relative.
void expect_same_rays(const rays::RaySet& a, const rays::RaySet& b, double tolerance) {
    ASSERT_EQ(a.rays.size(), b.rays.size());
    const double flux_a = rays::flux(a), flux_b = rays::flux(b);
    for (std::size_t r = 0; r < a.rays.size(); ++r) {
        EXPECT_LT(glm::length(a.rays[r].position_m - b.rays[r].position_m), tolerance) << r;
        EXPECT_LT(glm::length(a.rays[r].direction - b.rays[r].direction), tolerance) << r;
        EXPECT_NEAR(a.rays[r].flux / flux_a, b.rays[r].flux / flux_b,
                    tolerance * a.rays[r].flux / flux_a)
            << r;
    }
}

TEST_F(SharedRays, AllAreReadOrRefusedForATrueReason) {
    int read_well = 0, refused = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
        if (!entry.is_regular_file())
            continue;
        try {
            EXPECT_GT(rays::flux(rays::read_rays(entry.path().string())), 0);
            ++read_well;
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(error.what_, "ray file is truncated");
            EXPECT_THAT(error.where,
                        testing::HasSubstr("RaysWithoutSpectralData.RAY, byte 3215, ray 113"));
        }
    }
    EXPECT_EQ(read_well, 16);
    EXPECT_EQ(refused, 1);
}

TEST_F(SharedRays, LightToolsTextHoldsTheRaysOfItsTm25) {
    const rays::RaySet text = read("lighttools_sim/Cyl10k.1.ray", true);
    EXPECT_EQ(text.format, "LightTools (text)");
    EXPECT_NEAR(text.flux_of_rays, 10000, 0.05);
    EXPECT_EQ(text.flux_stated, 1);
    expect_same_rays(text, read("lighttools_sim/Cyl10k.1.tm25ray", true), 5e-6);
}

TEST_F(SharedRays, PairsOfFormatsHoldTheSameRays) {
    expect_same_rays(read("zemax_format/test_08_dat.DAT"),
                     read("zemax_format/test_08_dat_reference.ray"), 1e-6);
    expect_same_rays(read("zemax_format/test_08_ray.ray"),
                     read("zemax_format/test_08_ray_reference.sdf"), 1e-6);
    expect_same_rays(read("zemax_format/test_08_sdf.sdf"),
                     read("zemax_format/test_08_sdf_reference.ray"), 1e-5);
    expect_same_rays(read("zemax_format/ThreeRays_Wavelength.1.ray"),
                     read("zemax_format/ThreeRays_Wavelength_ZMX.ray"), 1e-6);
}

// 1 W at 550 nm; the fit of V is good to 2 %.
TEST_F(SharedRays, WattsBecomeTheLumensThatTheirPairStates) {
    const double lm = rays::flux(read("zemax_format/test_08_dat_reference.ray"));
    EXPECT_NEAR(lm, 679.55, 0.01);  // stated, and scaled to
    EXPECT_NEAR(rays::flux(read("zemax_format/test_08_dat.DAT")), lm, 0.02 * lm);
}

// A filament of 0.4 mm radius x 6 mm.
TEST_F(SharedRays, SpeosRaysStartInTheirFilament) {
    const rays::RaySet set = read("speos_sim/Rays.ray");
    EXPECT_EQ(set.rays.size(), 45462U);
    EXPECT_NEAR(rays::flux(set), 450.08, 0.01);
    EXPECT_NEAR(set.flux_of_rays / 45462 * 4.0177, 450.08, 0.02 * 450.08);  // shares of 1
    glm::dvec3 least(1e9), most(-1e9);
    for (const rays::Ray& ray : set.rays) {
        least = glm::min(least, glm::dvec3(ray.position_m));
        most = glm::max(most, glm::dvec3(ray.position_m));
    }
    const glm::dvec3 size_mm = 1e3 * (most - least);
    RecordProperty("size_mm", testing::PrintToString(std::vector{size_mm.x, size_mm.y, size_mm.z}));
    std::vector<double> sides{size_mm.x, size_mm.y, size_mm.z};
    std::sort(sides.begin(), sides.end());
    EXPECT_NEAR(sides[2], 6, 0.05);
    EXPECT_NEAR(sides[0], 0.8, 0.02);
}

// The largest illuminance of n x n pixels on the 6 x 6 mm square at z = 0.1 mm, and the flux
// through it, by counting rays.
struct OnSquare {
    double flux_lm = 0, peak_lx = 0;
};

OnSquare count_on_square(const rays::RaySet& set, int n) {
    constexpr double kSide_mm = 6, kPlane_mm = 0.1;
    const auto pixels = static_cast<std::size_t>(n);
    std::vector<double> pixel(pixels * pixels);
    OnSquare result;
    for (const rays::Ray& ray : set.rays) {
        if (ray.direction.z <= 0)
            continue;
        const glm::dvec3 p = 1e3 * glm::dvec3(ray.position_m), d(ray.direction);
        const glm::dvec2 at =
            (glm::dvec2(p) + glm::dvec2(d) * ((kPlane_mm - p.z) / d.z)) / kSide_mm;
        if (std::max(std::abs(at.x), std::abs(at.y)) >= 0.5)
            continue;
        result.flux_lm += ray.flux;
        const auto index = [&](double x) { return static_cast<std::size_t>((x + 0.5) * n); };
        pixel[index(at.y) * pixels + index(at.x)] += ray.flux;
    }
    result.peak_lx =
        *std::max_element(pixel.begin(), pixel.end()) / std::pow(1e-3 * kSide_mm / n, 2);
    return result;
}

// Counts of the measured LED's 100,000 rays.
TEST_F(SharedRays, TheMeasuredLedIsAsItsVendorSays) {
    const std::filesystem::path led = *std::filesystem::directory_iterator(folder_ / "osram_led");
    const rays::RaySet set = rays::read_rays(led.string());
    EXPECT_NEAR(rays::flux(set), 337.0, 1e-3);
    EXPECT_NEAR(count_on_square(set, 100).flux_lm, 331.86, 0.01);
    EXPECT_NEAR(count_on_square(set, 100).peak_lx, 1.43e8, 0.005e8);
    EXPECT_NEAR(count_on_square(set, 50).peak_lx, 1.30e8, 0.005e8);
    EXPECT_NEAR(count_on_square(set, 25).peak_lx, 1.23e8, 0.005e8);
    double cone = 0;
    for (const rays::Ray& ray : set.rays)
        if (ray.direction.z >= std::cos(5 * std::numbers::pi / 180))
            cone += ray.flux;
    const double cone_sr = 2 * std::numbers::pi * (1 - std::cos(5 * std::numbers::pi / 180));
    EXPECT_NEAR(cone / cone_sr, 112.8, 0.1);
}

// Where its rays start and which point they come from, without reading them into memory. 56 of
// 100,000 rays go backwards.
TEST_F(SharedRays, TheMeasuredLedsSurvey) {
    const std::filesystem::path led = *std::filesystem::directory_iterator(folder_ / "osram_led");
    const rays::RaySurvey survey = rays::survey_rays(led.string(), false);
    EXPECT_EQ(survey.rays, 100000U);
    EXPECT_NEAR(survey.flux, 337.0, 1e-3);
    EXPECT_NEAR(survey.flux_stated, 337.0, 1e-3);
    EXPECT_NEAR(1e3 * survey.least_start_m.z, -1.18, 0.005);
    EXPECT_NEAR(1e3 * survey.most_start_m.z, 0.02, 1e-6);
    ASSERT_TRUE(survey.focus_m);
    EXPECT_LT(glm::length(1e3 * *survey.focus_m - glm::dvec3(-0.6836, 0.8361, -0.4491)), 1e-4);
    EXPECT_EQ(survey.backward_rays, 56U);
    EXPECT_NEAR(survey.backward_flux / survey.flux, 56e-5, 1e-8);
}

}  // namespace
}  // namespace nearfield
