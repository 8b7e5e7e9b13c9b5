// SPDX-License-Identifier: Apache-2.0
// Fits that keep a texel's light, where the basis cannot follow the lamp.
#include "fit/keep_light.h"

#include "tests/fit/bench_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace nearfield::fit {
namespace {

TexelDesign first_texel(const Design& design) {
    TexelDesign texel;
    fill_texel_design(design, 0, 0, texel);
    return texel;
}

// What filters at the grid's places see of light through one point of U: narrower than any basis
// function.
std::vector<double> light_through(const Slab& planes, const Optics& optics, glm::dvec2 u_m) {
    std::vector<double> b;
    for (const glm::dvec3& position_m : optics.position_m) {
        const glm::dvec2 x = (u_m - glm::dvec2(position_m)) / planes.pitch_m;
        b.push_back(model::eval(optics.filter_x, x.x) * model::eval(optics.filter_y, x.y));
    }
    return b;
}

double flux_of(const Slab& planes, const std::vector<double>& coeffs) {
    const double integral = model::integral(planes.profile);
    return std::accumulate(coeffs.begin(), coeffs.end(), 0.0) * integral * integral *
           planes.pitch_m.x * planes.pitch_m.y;
}

struct Fitted {
    Workspace work;
    TexelFit fit;
    std::vector<double> b;
};

Fitted fitted(const TexelDesign& texel,
              const std::vector<double>& b,
              const std::vector<double>& weight,
              double lambda) {
    Fitted fitted;
    fitted.b = b;
    SolveOptions options;
    options.lambda = lambda;
    solve_texel(texel, difference_penalty(texel.grid, options.difference_order), b, weight, options,
                fitted.work, fitted.fit);
    return fitted;
}

void keep(const std::vector<double>& weight, Fitted& fitted) {
    keep_light(fitted.b, weight, fitted.work, fitted.fit);
}

double excess(const TexelDesign& texel,
              const std::vector<double>& b,
              const std::vector<double>& weight,
              const std::vector<double>& coeffs) {
    double sum = 0;
    for (std::size_t k = 0; k < b.size(); ++k)
        if (weight[k] > 0)
            sum += predicted(texel, static_cast<int>(k), coeffs) - b[k];
    return sum;
}

// Proves what it is for: least squares alone makes light of a narrow beam, wherever it lies in its
// cell; with the light kept, the flux is the beam's.
TEST(KeepLight, ANarrowBeamKeepsItsFlux) {
    const Slab planes = test_planes();
    const Optics optics = test_filter(planes, 0.0);
    const TexelDesign texel = first_texel(make_design(planes, optics));
    const std::vector<double> weight(optics.position_m.size(), 1e6);
    double worst_plain = 0;
    for (const double shift : {0.0, 0.2, 0.5}) {
        const glm::dvec2 u_m = planes.basis_center_m(5, 4) + shift * planes.pitch_m;
        const std::vector<double> b = light_through(planes, optics, u_m);
        Fitted fit = fitted(texel, b, weight, 0.0);
        worst_plain = std::max(worst_plain, flux_of(planes, fit.fit.coeffs) - 1.0);
        keep(weight, fit);
        EXPECT_NEAR(flux_of(planes, fit.fit.coeffs), 1.0, 1e-9);  // a partition of unity
    }
    EXPECT_GT(worst_plain, 0.05);
}

// Proves the condition with uneven weights and missing measurements, that one factor does it, also
// for sigma, and that chi-square and residuals are the kept fit's.
TEST(KeepLight, OneFactorMakesResidualsAddUpToNothing) {
    const Slab planes = test_planes({6, 5});
    const Optics optics = test_filter(planes, 1e-3);
    const TexelDesign texel = first_texel(make_design(planes, optics));
    std::vector<double> b =
        light_through(planes, optics, planes.basis_center_m(2, 2) + 0.4 * planes.pitch_m);
    std::vector<double> weight;
    support::Random random{3};
    for (std::size_t k = 0; k < b.size(); ++k) {
        b[k] += 0.01 * normal_number(random);
        weight.push_back(k % 7 == 3 ? 0.0 : random.uniform(0.5, 2.0));
    }
    Fitted fit = fitted(texel, b, weight, 1e-3);
    fit.fit.sigma.assign(fit.fit.coeffs.size(), 2.0);
    const std::vector<double> before = fit.fit.coeffs;
    ASSERT_GT(excess(texel, b, weight, before), 1e-3);
    keep(weight, fit);
    EXPECT_NEAR(excess(texel, b, weight, fit.fit.coeffs), 0, 1e-12);
    const double factor = fit.fit.sigma[0] / 2.0;
    EXPECT_LT(factor, 1.0);
    for (std::size_t m = 0; m < before.size(); ++m)
        EXPECT_NEAR(fit.fit.coeffs[m], factor * before[m], 1e-12 * before[m]);
    double chi_square = 0;
    for (std::size_t k = 0; k < b.size(); ++k) {
        const double off = predicted(texel, static_cast<int>(k), fit.fit.coeffs) - b[k];
        if (weight[k] > 0.0) {
            EXPECT_NEAR(fit.work.residual[k], off, 1e-12);
        }
        chi_square += weight[k] * off * off;
    }
    EXPECT_NEAR(fit.fit.chi_square / chi_square, 1.0, 1e-9);
}

// Proves that noise about nothing is left alone: there is no light to keep.
TEST(KeepLight, DarknessStaysAsItIs) {
    const Slab planes = test_planes();
    const Optics optics = test_filter(planes, 0.0);
    const TexelDesign texel = first_texel(make_design(planes, optics));
    const std::vector<double> weight(optics.position_m.size(), 1.0);
    const std::vector<double> b(optics.position_m.size(), -0.1);
    Fitted fit = fitted(texel, b, weight, 0.01);
    const std::vector<double> before = fit.fit.coeffs;
    keep(weight, fit);
    EXPECT_EQ(fit.fit.coeffs, before);
}

}  // namespace
}  // namespace nearfield::fit
