// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "formats/rays/export_rays.h"
#include "formats/rays/ray_file.h"
#include "tests/support/chi_square.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

namespace nearfield {
namespace {

using rays::RayFormat;

// Two slabs, one turned aside, with dark images, dark texels and light of many strengths.
LightField two_slabs(Weighting weighting, int channels, const std::string& profile) {
    LightField lightfield;
    for (int s = 0; s < 2; ++s) {
        Slab slab;
        slab.delta_m = 0.02;
        slab.grid = {4, 3};
        slab.pitch_m = {0.004, 0.006};
        slab.u_center_m = {0.001, -0.002};
        slab.texels = {8, 6};
        slab.s_min_m = {-0.012, -0.009};
        slab.s_max_m = {0.010, 0.009};
        slab.profile = model::make_profile(profile);
        slab.weighting = weighting;
        slab.channels = channels;
        const std::size_t values =
            slab.texel_count() * static_cast<std::size_t>(slab.image_count() * channels);
        for (std::size_t k = 0; k < values; ++k) {
            const std::size_t image = k / slab.texel_count() % 12;
            const bool is_dark = image == 5 || k % 7 == 3;
            slab.coeffs.push_back(is_dark ? 0.0F
                                          : 1e6F * static_cast<float>((1 + k % 11) * (image + 1)));
        }
        if (s == 1) {
            const double angle = std::numbers::pi / 2;
            slab.luminaire_from_slab.rotation = {{std::cos(angle), 0, -std::sin(angle)},
                                                 {0, 1, 0},
                                                 {std::sin(angle), 0, std::cos(angle)}};
            slab.luminaire_from_slab.translation_m = {0.05, 0, -0.01};
        }
        lightfield.slabs.push_back(slab);
    }
    return lightfield;
}

rays::RaySet round_trip(const LightField& lightfield, const rays::ExportOptions& options) {
    rays::export_rays(lightfield, "export.rays", options);
    return rays::read_rays("export.rays");
}

double flux_of(const LightField& lightfield) {
    return model::luminance(model::flux(lightfield));
}

TEST(ExportRays, KeepTheFluxInEveryFormat) {
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        LightField lightfield = two_slabs(weighting, 3, "bspline");
        for (const Quantity quantity : {Quantity::Photometric, Quantity::Radiometric})
            for (const auto& [name, format] : rays::ray_format_names()) {
                lightfield.quantity = quantity;
                rays::ExportOptions options;
                options.format = format;
                options.rays = 70001;  // more than one chunk, and an odd number
                const rays::RaySet set = round_trip(lightfield, options);
                EXPECT_EQ(set.rays.size(), options.rays) << name;
                EXPECT_NEAR(rays::flux(set), flux_of(lightfield), 1e-5 * flux_of(lightfield));
                // A sum of equal floats: 6e-8 each, all the same way at worst.
                EXPECT_NEAR(set.flux_of_rays, flux_of(lightfield), 1e-6 * flux_of(lightfield));
                const auto [least, most] = std::minmax_element(
                    set.rays.begin(), set.rays.end(),
                    [](const rays::Ray& a, const rays::Ray& b) { return a.flux < b.flux; });
                EXPECT_EQ(least->flux, most->flux) << name;
                const bool is_text_of_zemax = format == RayFormat::ZemaxText;  // has no kind: W
                EXPECT_EQ(set.quantity, is_text_of_zemax ? Quantity::Radiometric : quantity);
                EXPECT_EQ(set.colors.size(),
                          format == RayFormat::Tm25 && quantity == Quantity::Photometric
                              ? set.rays.size()
                              : 0U);
            }
    }
}

TEST(ExportRays, KeepTheColor) {
    const LightField lightfield = two_slabs(Weighting::Irradiance, 3, "bilinear");
    rays::ExportOptions options;
    options.rays = 200000;
    const rays::RaySet set = round_trip(lightfield, options);
    glm::dvec3 sum{0.0};
    for (std::size_t r = 0; r < set.rays.size(); ++r)
        sum += static_cast<double>(set.rays[r].flux) * glm::dvec3(set.colors[r]);
    const glm::dvec3 truth = model::flux(lightfield);
    for (int c = 0; c < 3; ++c)  // a color of a ray spreads by less than its mean
        EXPECT_NEAR(sum[c], truth[c], 4 * truth[c] / std::sqrt(200000.0));
}

// Where a ray crosses the planes of the slab that it is meant to have come from.
struct Crossing {
    glm::dvec2 u_m, s_m;
};
Crossing crossing(const Slab& slab, const rays::Ray& ray) {
    const glm::dmat3 to_slab = glm::transpose(slab.luminaire_from_slab.rotation);
    const glm::dvec3 p =
        to_slab * (glm::dvec3(ray.position_m) - slab.luminaire_from_slab.translation_m);
    const glm::dvec3 d = to_slab * glm::dvec3(ray.direction);
    const auto at = [&](double z) { return glm::dvec2(p + d * ((z - p.z) / d.z)); };
    return {at(-slab.delta_m), at(0.0)};
}

// The light in bins of 2 x 2 texels and one cell of U, by the definition: L cos^4 / delta^2, in
// midpoints. Bins: [texel block][cell].
constexpr int kBlocksX = 4, kBlocksY = 3;
struct Bins {
    glm::ivec2 cells{0};
    glm::dvec2 u_min_m{0};
    std::size_t index(const Slab& slab, const Crossing& at) const {
        const glm::dvec2 block = (at.s_m - slab.s_min_m) / (2.0 * slab.texel_m());
        const glm::dvec2 cell = (at.u_m - u_min_m) / slab.pitch_m;
        const auto clamp = [](double x, int count) {
            return std::clamp(static_cast<int>(std::floor(x)), 0, count - 1);
        };
        return static_cast<std::size_t>(
            (clamp(block.y, kBlocksY) * kBlocksX + clamp(block.x, kBlocksX)) * cells.x * cells.y +
            clamp(cell.y, cells.y) * cells.x + clamp(cell.x, cells.x));
    }
};
Bins bins_of(const Slab& slab) {
    Bins bins;
    const int n = static_cast<int>(slab.profile.cells.size());
    bins.cells = slab.grid + n - 1;
    bins.u_min_m = slab.u_center_m - 0.5 * glm::dvec2(bins.cells) * slab.pitch_m;
    return bins;
}
std::vector<double> expected_light(const Slab& slab, const Bins& bins) {
    constexpr int kOnS = 4, kOnU = 6;  // a block's side in steps (2 a texel), a cell's
    std::vector<double> light(
        static_cast<std::size_t>(kBlocksX * kBlocksY * bins.cells.x * bins.cells.y));
    const glm::ivec2 s_steps(kBlocksX * kOnS, kBlocksY * kOnS), u_steps = bins.cells * kOnU;
    const glm::dvec2 ds = (slab.s_max_m - slab.s_min_m) / glm::dvec2(s_steps);
    const glm::dvec2 du = slab.pitch_m / static_cast<double>(kOnU);
    for (int sy = 0; sy < s_steps.y; ++sy)
        for (int sx = 0; sx < s_steps.x; ++sx)
            for (int uy = 0; uy < u_steps.y; ++uy)
                for (int ux = 0; ux < u_steps.x; ++ux) {
                    const glm::dvec2 s = slab.s_min_m + (glm::dvec2(sx, sy) + 0.5) * ds;
                    const glm::dvec2 u = bins.u_min_m + (glm::dvec2(ux, uy) + 0.5) * du;
                    const glm::dvec2 tangent = (s - u) / slab.delta_m;
                    const double cos2 = 1 / (1 + glm::dot(tangent, tangent));
                    light[bins.index(slab, {u, s})] +=
                        model::luminance(model::radiance(slab, u, s)) * cos2 * cos2 * ds.x * ds.y *
                        du.x * du.y / (slab.delta_m * slab.delta_m);
                }
    return light;
}

// The chance of these rays if they come from this light field.
double chance(const LightField& lightfield, const LightField& truth, RayFormat format) {
    rays::ExportOptions options;
    options.format = format;
    options.rays = 300000;
    options.has_color = false;
    options.start = rays::RayStart::U;
    options.seed = 3;
    const rays::RaySet set = round_trip(lightfield, options);
    double chi2 = 0;
    int degrees = -1;
    for (std::size_t k = 0; k < truth.slabs.size(); ++k) {
        const Slab& slab = truth.slabs[k];
        const Bins bins = bins_of(slab);
        const std::vector<double> light = expected_light(slab, bins);
        std::vector<double> counts(light.size());
        const bool is_aside = k == 1;
        for (const rays::Ray& ray : set.rays)  // the slabs' directions do not overlap
            if ((ray.position_m.x > 0.02F) == is_aside)
                ++counts[bins.index(slab, crossing(slab, ray))];
        for (std::size_t b = 0; b < light.size(); ++b) {
            const double expected = light[b] / flux_of(truth) * static_cast<double>(options.rays);
            constexpr double kLeast = 8;  // the count is close enough to normal
            if (expected < kLeast)
                continue;
            chi2 += (counts[b] - expected) * (counts[b] - expected) / expected;
            ++degrees;
        }
    }
    EXPECT_GT(degrees, 100);
    return support::chi_square_tail(chi2, degrees);
}

TEST(ExportRays, AreTheLightFieldsOwn) {
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance})
        for (const char* profile : {"box", "bilinear", "quadratic", "bspline"}) {
            const LightField lightfield = two_slabs(weighting, 3, profile);
            EXPECT_GT(chance(lightfield, lightfield, RayFormat::Tm25), 1e-4) << profile;
        }
    // Six digits of text and floats of mm move no ray into another bin but by luck.
    const LightField lightfield = two_slabs(Weighting::Irradiance, 1, "bspline");
    for (const auto& [name, format] : rays::ray_format_names())
        EXPECT_GT(chance(lightfield, lightfield, format), 1e-4) << name;
}

// The test has power: 3 % of light moved from one image to another is seen.
TEST(ExportRays, OfAnotherLightFieldAreTold) {
    const LightField truth = two_slabs(Weighting::Irradiance, 1, "bspline");
    LightField other = truth;
    Slab& slab = other.slabs[0];
    for (std::size_t t = 0; t < slab.texel_count(); ++t) {
        slab.coeffs[slab.image_offset(0, 11) + t] *= 0.9F;
        slab.coeffs[slab.image_offset(0, 0) + t] *= 1.5F;
    }
    EXPECT_LT(chance(other, truth, RayFormat::Tm25), 1e-6);
    other = truth;
    std::swap(other.slabs[0].pitch_m.x, other.slabs[0].pitch_m.y);
    EXPECT_LT(chance(other, truth, RayFormat::Tm25), 1e-6);
}

// The same lines, from other points of them, in another frame.
TEST(ExportRays, StartWhereAskedFor) {
    const LightField lightfield = two_slabs(Weighting::Irradiance, 1, "bspline");
    rays::ExportOptions options;
    options.rays = 2000;
    const rays::RaySet on_s = round_trip(lightfield, options);
    options.start = rays::RayStart::U;
    const rays::RaySet on_u = round_trip(lightfield, options);
    options.start = rays::RayStart::Sphere;
    options.sphere_radius_m = 0.2;
    const rays::RaySet on_sphere = round_trip(lightfield, options);
    options.axis = rays::LightAxis::MinusY;
    options.origin_m = {0.1, 0.2, 0.3};
    const rays::RaySet turned = round_trip(lightfield, options);
    for (std::size_t r = 0; r < options.rays; ++r) {
        const glm::dvec3 s(on_s.rays[r].position_m), d(on_s.rays[r].direction);
        const glm::dvec3 to_u = glm::dvec3(on_u.rays[r].position_m) - s,
                         to_sphere = glm::dvec3(on_sphere.rays[r].position_m) - s;
        constexpr double kRounding_m = 1e-7;
        EXPECT_LT(glm::length(glm::cross(to_u, d)), kRounding_m);
        EXPECT_LT(glm::length(glm::cross(to_sphere, d)), kRounding_m);
        EXPECT_LT(glm::dot(to_u, d), 0);
        EXPECT_GT(glm::dot(to_sphere, d), 0);
        EXPECT_NEAR(glm::length(on_sphere.rays[r].position_m), 0.2F, 1e-6F);
        const glm::vec3 p = on_sphere.rays[r].position_m;  // z goes to -y, x to z, y to -x
        EXPECT_LT(
            glm::length(turned.rays[r].position_m - glm::vec3(0.1 - p.y, 0.2 - p.z, 0.3 + p.x)),
            1e-6F);
    }
    options.sphere_radius_m = 0.01;
    EXPECT_THROW(rays::export_rays(lightfield, "export.rays", options), Error);
}

TEST(ExportRays, AreAFunctionOfSeedAndNumberAlone) {
    const LightField lightfield = two_slabs(Weighting::Irradiance, 1, "bspline");
    rays::ExportOptions options;
    options.rays = 100;
    const rays::RaySet few = round_trip(lightfield, options);
    options.rays = 70000;
    const rays::RaySet many = round_trip(lightfield, options);
    for (std::size_t r = 0; r < 100; ++r)
        EXPECT_EQ(few.rays[r].direction, many.rays[r].direction);
    options.seed = 1;
    EXPECT_NE(round_trip(lightfield, options).rays[0].direction, many.rays[0].direction);
}

TEST(ExportRays, OfADarkLightFieldAreRefused) {
    LightField dark = two_slabs(Weighting::Irradiance, 1, "box");
    for (Slab& slab : dark.slabs)
        std::fill(slab.coeffs.begin(), slab.coeffs.end(), 0.0F);
    std::filesystem::remove("dark.rays");
    EXPECT_THROW(rays::export_rays(dark, "dark.rays", {}), Error);
    EXPECT_FALSE(std::filesystem::exists("dark.rays"));
}

}  // namespace
}  // namespace nearfield
