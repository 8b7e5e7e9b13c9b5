// SPDX-License-Identifier: Apache-2.0
#include "tests/render/brdf_oracle.h"
#include "tests/support/chi_square.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

namespace nearfield {
namespace {

using shared::Brdf;
using test::LobeCase, test::LobeMap, test::random_pair;

/// Of all chi-square tests of one TEST together.
constexpr double kAlpha = 0.01;
constexpr std::array<double, 5> kAngles = {0.0, 0.5, 1.0, 1.3, 1.45};
constexpr int kDraws = 100000;

/// Sidak's correction.
double chance_of_each(double alpha, std::size_t tests) {
    return -std::expm1(std::log1p(-alpha) / static_cast<double>(tests));
}

using Density = std::function<double(glm::dvec3)>;
using Draw = std::function<glm::vec3(support::Random&)>;

/// Directions sorted into parts of a lobe's map, and into one bin for all below the surface.
struct Histogram {
    static constexpr int kRings = 12, kSectors = 16;
    std::array<double, kRings * kSectors + 1> bins{};
};

/// Probabilities by quadrature of a density over the map's parts; the rest is below the surface.
Histogram expected_bins(const LobeMap& map, const Density& density) {
    constexpr int kParts = 2;  // of a bin's side; 4 give the same verdicts
    Histogram result;
    double above = 0.0;
    for (int ring = 0; ring < Histogram::kRings * kParts; ++ring)
        for (int sector = 0; sector < Histogram::kSectors * kParts; ++sector) {
            const glm::dvec4 part(static_cast<double>(ring) / (Histogram::kRings * kParts),
                                  static_cast<double>(ring + 1) / (Histogram::kRings * kParts),
                                  static_cast<double>(sector) / (Histogram::kSectors * kParts),
                                  static_cast<double>(sector + 1) / (Histogram::kSectors * kParts));
            const double share = test::integrate(map, part, 8, density);
            const int bin = ring / kParts * Histogram::kSectors + sector / kParts;
            result.bins.at(static_cast<std::size_t>(bin)) += share;
            above += share;
        }
    result.bins.back() = std::max(1.0 - above, 0.0);
    return result;
}

Histogram observed_bins(const LobeMap& map, std::uint64_t seed, const Draw& draw) {
    support::Random random{seed};
    Histogram result;
    for (int k = 0; k < kDraws; ++k) {
        const glm::vec3 direction = draw(random);
        if (!shared::brdf_is_above(direction)) {
            result.bins.back() += 1.0;
            continue;
        }
        const glm::dvec2 place = map.inverse(glm::normalize(glm::dvec3(direction)));
        const int ring =
            std::clamp(static_cast<int>(place.x * Histogram::kRings), 0, Histogram::kRings - 1);
        const int sector =
            std::clamp(static_cast<int>(place.y * Histogram::kSectors), 0, Histogram::kSectors - 1);
        result.bins.at(static_cast<std::size_t>(ring * Histogram::kSectors + sector)) += 1.0;
    }
    return result;
}

/// The chance of a misfit as large as this or larger. Bins of few expected samples are pooled.
double chance(const Histogram& expected, const Histogram& observed) {
    constexpr double kFewest = 10.0;
    double sum = 0.0, pooled_expected = 0.0, pooled_observed = 0.0;
    int degrees = -1;
    const auto add = [&](double e, double o) {
        sum += (o - e) * (o - e) / e;
        ++degrees;
    };
    for (std::size_t k = 0; k < expected.bins.size(); ++k) {
        const double e = expected.bins.at(k) * kDraws, o = observed.bins.at(k);
        if (e >= kFewest) {
            add(e, o);
        } else {
            pooled_expected += e;
            pooled_observed += o;
        }
    }
    if (pooled_expected >= kFewest)
        add(pooled_expected, pooled_observed);
    else if (pooled_observed > 5.0 * kFewest)
        return 0.0;  // many where almost none may be
    return support::chi_square_tail(sum, std::max(degrees, 1));
}

/// Chance of `drawn`'s directions if they had the density of `stated`: of their lobes alone.
double lobe_chance(const Brdf& drawn, const Brdf& stated, glm::vec3 v, std::uint64_t seed) {
    const LobeMap map(stated, v);
    const Histogram expected = expected_bins(map, [&](glm::dvec3 l) {
        return static_cast<double>(shared::brdf_lobe_density(stated, glm::vec3(l), v));
    });
    const Histogram observed = observed_bins(map, seed, [&](support::Random& random) {
        return shared::brdf_lobe_sample(drawn, v, random_pair(random));
    });
    return chance(expected, observed);
}

/// The same of diffuse part and lobe together.
double mixture_chance(const Brdf& drawn, const Brdf& stated, glm::vec3 v, std::uint64_t seed) {
    const LobeMap map(stated, v);
    const Histogram expected = expected_bins(map, [&](glm::dvec3 l) {
        return static_cast<double>(shared::brdf_density(stated, glm::vec3(l), v));
    });
    const Histogram observed = observed_bins(map, seed, [&](support::Random& random) {
        const glm::vec2 xi = random_pair(random);
        return shared::brdf_sample(drawn, v, {xi, random_pair(random).x});
    });
    return chance(expected, observed);
}

// Proves that every lobe draws directions as its density says, and that the density integrates to 1
// less the chance of going below the surface. In every single case the test rejects directions of
// a lobe whose alpha is 5 % smaller, or whose exponent is 20 % larger. Lobes that float directions
// cannot resolve are left out.
TEST(BrdfSample, LobesAreDrawnByTheirDensity) {
    const std::vector<LobeCase> cases = test::lobe_cases();
    const double least = chance_of_each(kAlpha, cases.size() * kAngles.size());
    std::uint64_t seed = 1;
    for (const LobeCase& lobe : cases)
        for (const double angle : kAngles) {
            const glm::vec3 v = test::viewer_at(angle);
            if (shared::brdf_lobe_width_rad(lobe.brdf, v) < 1e-3F)
                continue;
            Brdf narrower = lobe.brdf;
            narrower.alpha *= 0.95F;
            narrower.exponent += 0.2F * (lobe.brdf.exponent + 1.0F);
            ++seed;
            EXPECT_GT(lobe_chance(lobe.brdf, lobe.brdf, v, seed), least)
                << lobe.name << ", viewer " << angle;
            EXPECT_LT(lobe_chance(narrower, lobe.brdf, v, seed), least)
                << lobe.name << ", viewer " << angle;
        }
}

// Proves the same of a diffuse part and a lobe of any color together; a lobe that is
// drawn as if it were 15 % weaker is rejected.
TEST(BrdfSample, MixturesAreDrawnByTheirDensity) {
    const std::vector<LobeCase> cases = test::lobe_cases();
    const double least = chance_of_each(kAlpha, cases.size() * kAngles.size());
    std::uint64_t seed = 1000;
    std::set<shared::uint> kinds;
    for (const LobeCase& lobe : cases)
        for (const double angle : kAngles) {
            const glm::vec3 v = test::viewer_at(angle);
            // The map about a narrow lobe would hold all of the diffuse part in one ring; a wide
            // one looks like the diffuse part.
            if (shared::brdf_lobe_width_rad(lobe.brdf, v) < 0.06F ||
                shared::brdf_lobe_width_rad(lobe.brdf, {0, 0, 1}) > 0.3F)
                continue;
            Brdf brdf = lobe.brdf;
            brdf.diffuse = {0.4F, 0.5F, 0.0F};
            brdf.specular = {0.1F, 0.3F, 0.5F};
            Brdf duller = brdf;
            duller.specular *= 0.85F;
            ++seed;
            kinds.insert(brdf.kind);
            EXPECT_GT(mixture_chance(brdf, brdf, v, seed), least)
                << lobe.name << ", viewer " << angle;
            EXPECT_LT(mixture_chance(duller, brdf, v, seed), least)
                << lobe.name << ", viewer " << angle;
        }
    EXPECT_EQ(kinds.size(), 5U);
}

// Proves that densities integrate to 1 where no direction, or next to none, goes below the surface:
// all of the halfway disk's, Lambert's, and narrow lobes about oblique directions.
TEST(BrdfSample, DensitiesIntegrateToOne) {
    constexpr double kError = 1e-3;  // GGX' tail below the surface is the largest part
    std::vector<Brdf> brdfs(1);
    brdfs[0].kind = shared::kBrdfPhong;
    brdfs[0].diffuse = glm::vec3(0.7F);
    for (const LobeCase& lobe : test::lobe_cases())
        if (lobe.brdf.kind == shared::kBrdfHalfwayDisk ||
            shared::brdf_lobe_width_rad(lobe.brdf, {0, 0, 1}) < 0.03F)
            brdfs.push_back(lobe.brdf);
    ASSERT_EQ(brdfs.size(), 7U);
    for (const Brdf& brdf : brdfs)
        for (const double angle : {0.0, 0.5, 1.0}) {
            const glm::vec3 v = test::viewer_at(angle);
            const double sum = test::integrate(LobeMap(brdf, v), 24, [&](glm::dvec3 l) {
                return static_cast<double>(shared::brdf_density(brdf, glm::vec3(l), v));
            });
            EXPECT_NEAR(sum, 1.0, kError) << brdf.kind << ", viewer " << angle;
        }
}

}  // namespace
}  // namespace nearfield
