// SPDX-License-Identifier: Apache-2.0
#include "fit/solve.h"

#include "fit/sigma.h"
#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace nearfield::fit {
namespace {

// Rounding of a gradient computed in double, as a cosine; ten times the largest that was seen.
constexpr double kGradientRounding = 1e-13;
// Exchanges of all at once that may fail to lessen the breaches, before one at a time.
constexpr int kPatience = 4;

struct Problem {
    const TexelDesign& texel;
    const Penalty& penalty;
    std::span<const double> b, weight;
};

void check_data(const Problem& problem) {
    const auto k_count = static_cast<std::size_t>(problem.texel.measurement_count);
    if (problem.b.size() != k_count || problem.weight.size() != k_count)
        throw Error{"bad texel data", "measurements", fmt::format("{}", k_count),
                    fmt::format("{}", problem.b.size())};
    for (std::size_t k = 0; k < k_count; ++k) {
        const double w = problem.weight[k];
        if (!(w >= 0.0) || !std::isfinite(w) || !std::isfinite(problem.b[k]))
            throw Error{"bad texel data", fmt::format("measurement {}", k),
                        "finite value, weight >= 0", fmt::format("{}, weight {}", problem.b[k], w)};
    }
}

// The minimum over the free coefficients, signs as they come.
void solve_free(Workspace& work, TexelFit& fit) {
    follow(work.band, work.normal, fit.is_free, work.factor);
    ++fit.factorizations;
    minimum_of_free(work.factor, work.normal.rhs, work.right_side, work.coeffs_padded);
}

// Whether coefficient m breaks a condition of the minimum: free and negative, or at the bound and
// better off above it.
bool is_breach(const Workspace& work, const TexelFit& fit, std::size_t m) {
    if (fit.is_free[m] != 0)
        return work.coeffs_padded[m] < 0.0;
    const double scale = work.normal.norm[m] * work.normal.data_norm;
    return work.gradient[m] < -kGradientRounding * scale;
}

// Block principal pivoting: all coefficients that break a condition change sides at once. True at
// the minimum; false where that has not lessened their number for a while.
bool exchange_blocks(Workspace& work, TexelFit& fit) {
    std::size_t fewest = fit.is_free.size() + 1;
    std::vector<std::size_t>& breaches = work.breaches;
    for (int patience = kPatience; patience > 0;) {
        solve_free(work, fit);
        fill_gradient(work.coeffs_padded, work.band.row_end, work.normal, work.gradient);
        breaches.clear();
        for (std::size_t m = 0; m < fit.is_free.size(); ++m)
            if (is_breach(work, fit, m))
                breaches.push_back(m);
        if (breaches.empty())
            return true;
        if (breaches.size() < fewest) {
            fewest = breaches.size();
            patience = kPatience;
        } else {
            --patience;
        }
        for (const std::size_t m : breaches)
            fit.is_free[m] ^= 1U;
    }
    return false;
}

// Moves `coeffs` towards the minimum over the free coefficients as far as all stay >= 0; what stops
// it is bound. True where it arrives.
bool step_feasibly(Workspace& work, TexelFit& fit, std::vector<double>& coeffs) {
    const std::vector<double>& target = work.coeffs_padded;
    double share = 1.0;
    for (std::size_t m = 0; m < coeffs.size(); ++m)
        if (fit.is_free[m] != 0 && target[m] <= 0.0)
            share = std::min(share, coeffs[m] / (coeffs[m] - target[m]));
    bool has_arrived = true;
    for (std::size_t m = 0; m < coeffs.size(); ++m) {
        if (fit.is_free[m] == 0)
            continue;
        coeffs[m] += share * (target[m] - coeffs[m]);
        if (target[m] <= 0.0 && coeffs[m] <= 1e-14 * -target[m]) {
            coeffs[m] = 0.0;
            fit.is_free[m] = 0;
            has_arrived = false;
        }
    }
    return has_arrived;
}

// The bound coefficient that would gain most, as a cosine.
std::optional<std::size_t> steepest(const Workspace& work, const TexelFit& fit) {
    std::optional<std::size_t> best;
    double least = 0.0;
    for (std::size_t m = 0; m < fit.is_free.size(); ++m)
        if (fit.is_free[m] == 0 && is_breach(work, fit, m) &&
            work.gradient[m] / work.normal.norm[m] < least) {
            least = work.gradient[m] / work.normal.norm[m];
            best = m;
        }
    return best;
}

// The primal active-set method from a feasible start: one coefficient at a time, and what is
// minimized falls with every step. For nearly singular problems, on which exchanges of blocks go
// round in circles.
bool exchange_singly(Workspace& work, TexelFit& fit) {
    std::vector<double> coeffs(fit.is_free.size());
    for (std::size_t m = 0; m < coeffs.size(); ++m) {
        coeffs[m] = std::max(0.0, work.coeffs_padded[m]);
        fit.is_free[m] = coeffs[m] > 0.0 ? 1 : 0;
    }
    const int most_steps = 20 * work.normal.size;
    for (int step = 0; step < most_steps; ++step) {
        solve_free(work, fit);
        if (!step_feasibly(work, fit, coeffs))
            continue;
        fill_gradient(work.coeffs_padded, work.band.row_end, work.normal, work.gradient);
        const std::optional<std::size_t> next = steepest(work, fit);
        if (!next)
            return true;
        fit.is_free[*next] = 1;
    }
    return false;
}

double kkt_residual(const Workspace& work) {
    double worst = 0.0;
    for (std::size_t m = 0; m < work.normal.norm.size(); ++m) {
        const double scale = work.normal.norm[m] * work.normal.data_norm;
        if (scale == 0.0)
            continue;
        const double g = work.gradient[m];
        worst = std::max(worst, (work.coeffs_padded[m] > 0.0 ? std::abs(g) : -g) / scale);
    }
    return worst;
}

// From fit.is_free to the minimum, with the normal equations that stand in `work`.
void minimize(const Problem& problem, Workspace& work, TexelFit& fit) {
    const auto n = static_cast<std::size_t>(work.normal.size);
    work.coeffs_padded.resize(static_cast<std::size_t>(work.normal.leading));
    if (fit.is_free.size() != n) {
        fit.is_free.assign(n, 1);
        fit.coeffs.clear();
    }
    for (std::size_t m = 0; m < n; ++m)
        if (work.normal.norm[m] == 0.0)
            fit.is_free[m] = 0;
    fit.factorizations = 0;
    const TexelDesign& texel = problem.texel;
    fill_band(texel.grid,
              glm::max(glm::ivec2(texel.width, texel.height) - 1, problem.penalty.reach),
              work.band);
    start(work.band, work.normal, fit.is_free, fit.coeffs, work.factor);

    fit.has_converged = exchange_blocks(work, fit) || exchange_singly(work, fit);
    for (double& c : work.coeffs_padded)
        c = std::max(c, 0.0);
    fill_gradient(problem.texel, problem.penalty, problem.b, problem.weight, work.normal,
                  work.coeffs_padded, work.residual, work.gradient);

    fit.coeffs.assign(work.coeffs_padded.begin(),
                      work.coeffs_padded.begin() + static_cast<std::ptrdiff_t>(n));
    fit.kkt_rel = kkt_residual(work);
    fit.valid_count = work.normal.valid_count;
    fit.free_count = static_cast<int>(work.factor.free_place.size());
    fit.chi_square = 0.0;
    for (std::size_t k = 0; k < problem.b.size(); ++k)
        fit.chi_square += problem.weight[k] * work.residual[k] * work.residual[k];
}

}  // namespace

void solve_texel(const TexelDesign& texel,
                 const Penalty& penalty,
                 std::span<const double> b,
                 std::span<const double> weight,
                 const SolveOptions& options,
                 Workspace& work,
                 TexelFit& fit,
                 std::span<const double> noise_share) {
    const Problem problem{texel, penalty, b, weight};
    check_data(problem);
    form_normal(texel, penalty, b, weight, options.lambda, work.normal);
    minimize(problem, work, fit);
    if (options.wants_sigma)
        fill_sigma(texel, weight, noise_share, work, fit);
}

}  // namespace nearfield::fit
