// SPDX-License-Identifier: Apache-2.0
#include "fit/sigma.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace nearfield::fit {
namespace {

using LaneSums = std::array<double, kLanes>;

// What of a texel's measurements is noise.
struct Noise {
    const TexelDesign& texel;
    std::span<const double> weight, noise_share;
};

// Of eight vectors z over all coefficients, [m][lane]: sum over k of share_k w_k (G_k z)^2.
LaneSums noise_through(const Noise& noise, const std::vector<double>& z) {
    const auto& [texel, weight, noise_share] = noise;
    using LaneArray = Eigen::Array<double, kLanes, 1>;
    LaneArray sums = LaneArray::Zero();
    for (int k = 0; k < texel.measurement_count; ++k) {
        const auto at = static_cast<std::size_t>(k);
        if (weight[at] == 0.0)
            continue;
        LaneArray seen = LaneArray::Zero();
        const double* block = &texel.value[texel.block(k)];
        const double* from = &z[static_cast<std::size_t>(texel.first[at]) * kLanes];
        for (int row = 0; row < texel.height; ++row) {
            for (int v = 0; v < texel.width; ++v)
                seen += block[v] * Eigen::Map<const LaneArray>(from + v * kLanes);
            block += texel.stride;
            from += static_cast<std::ptrdiff_t>(texel.grid.x) * kLanes;
        }
        sums += (noise_share.empty() ? weight[at] : noise_share[at] * weight[at]) * seen * seen;
    }
    LaneSums result;
    Eigen::Map<LaneArray>(result.data()) = sums;
    return result;
}

LaneSums squared_norms(const Workspace& work) {
    LaneSums sums{};
    for (std::size_t at = 0; at < work.lanes.size(); ++at)
        sums[at % kLanes] += work.lanes[at] * work.lanes[at];
    return sums;
}

void clear_lanes(Workspace& work) {
    work.lanes.assign(static_cast<std::size_t>(work.factor.matrix.padded * kLanes), 0.0);
}

std::size_t coefficient_at(const Workspace& work, int place) {
    return static_cast<std::size_t>(work.factor.order[static_cast<std::size_t>(place)]);
}

// work.lanes, by place in the factor, over all coefficients.
void spread_lanes(const Workspace& work, double sign, std::vector<double>& z) {
    std::fill(z.begin(), z.end(), 0.0);
    for (const int place : work.factor.free_place) {
        const double* from = &work.lanes[static_cast<std::size_t>(place) * kLanes];
        double* to = &z[coefficient_at(work, place) * kLanes];
        for (int lane = 0; lane < kLanes; ++lane)
            to[lane] = sign * from[lane];
    }
}

void fill_free(const Noise& noise, Workspace& work, std::vector<double>& z, TexelFit& fit) {
    const std::vector<int>& places = work.factor.free_place;
    for (std::size_t begin = 0; begin < places.size(); begin += kLanes) {
        const std::size_t lanes = std::min<std::size_t>(kLanes, places.size() - begin);
        clear_lanes(work);
        for (std::size_t lane = 0; lane < lanes; ++lane)
            work.lanes[static_cast<std::size_t>(places[begin + lane]) * kLanes + lane] = 1.0;
        solve_lower(work.factor.matrix, places[begin], work.lanes.data());
        solve_upper(work.factor.matrix, work.lanes.data());
        spread_lanes(work, 1.0, z);
        const LaneSums variance = noise_through(noise, z);
        for (std::size_t lane = 0; lane < lanes; ++lane)
            fit.sigma[coefficient_at(work, places[begin + lane])] = std::sqrt(variance[lane]);
    }
}

double symmetric_entry(const NormalEquations& normal, int a, int b) {
    return normal.entry(std::max(a, b), std::min(a, b));
}

void fill_bound(const Noise& noise,
                const std::vector<int>& bound,
                Workspace& work,
                std::vector<double>& z,
                TexelFit& fit) {
    for (std::size_t begin = 0; begin < bound.size(); begin += kLanes) {
        const std::size_t lanes = std::min<std::size_t>(kLanes, bound.size() - begin);
        clear_lanes(work);
        for (const int place : work.factor.free_place)
            for (std::size_t lane = 0; lane < lanes; ++lane)
                work.lanes[static_cast<std::size_t>(place) * kLanes + lane] =
                    symmetric_entry(work.normal, static_cast<int>(coefficient_at(work, place)),
                                    bound[begin + lane]);
        solve_lower(work.factor.matrix, 0, work.lanes.data());
        const LaneSums explained = squared_norms(work);
        solve_upper(work.factor.matrix, work.lanes.data());
        spread_lanes(work, -1.0, z);
        for (std::size_t lane = 0; lane < lanes; ++lane)
            z[static_cast<std::size_t>(bound[begin + lane]) * kLanes + lane] = 1.0;
        const LaneSums through = noise_through(noise, z);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const auto m = static_cast<std::size_t>(bound[begin + lane]);
            const double s =
                work.normal.entry(bound[begin + lane], bound[begin + lane]) - explained[lane];
            const double sigma = std::sqrt(through[lane]) / s;
            fit.sigma[m] = s > 0.0 && sigma > 0.0
                               ? sigma * one_sided_rms(std::max(0.0, work.gradient[m]) / s / sigma)
                               : std::numeric_limits<double>::infinity();
        }
    }
}

}  // namespace

double one_sided_rms(double ratio) {
    // With h = density / tail at `ratio`: E[x^2 | x >= 0] = 1 + ratio^2 - ratio h, which tends to
    // 2 / ratio^2 and loses its digits far out.
    constexpr double kFar = 25.0;
    const double square = ratio * ratio;
    if (ratio > kFar)
        return std::sqrt(2.0 / square * (1.0 - (5.0 - 37.0 / square) / square));
    const double tail = 0.5 * std::erfc(ratio * std::sqrt(0.5));
    const double density = std::exp(-0.5 * square) / std::sqrt(2.0 * std::acos(-1.0));
    return std::sqrt(1.0 + square - ratio * density / tail);
}

void fill_sigma(const TexelDesign& texel,
                std::span<const double> weight,
                std::span<const double> noise_share,
                Workspace& work,
                TexelFit& fit) {
    const std::size_t n = work.normal.norm.size();
    fit.sigma.assign(n, std::numeric_limits<double>::infinity());
    std::vector<bool> is_free(n, false);
    for (const int place : work.factor.free_place)
        is_free[coefficient_at(work, place)] = true;
    std::vector<int> bound;
    for (std::size_t m = 0; m < n; ++m)
        if (!is_free[m] && work.normal.norm[m] > 0.0)
            bound.push_back(static_cast<int>(m));
    const Noise noise{texel, weight, noise_share};
    std::vector<double> z(n * kLanes);
    fill_free(noise, work, z, fit);
    fill_bound(noise, bound, work, z, fit);
}

}  // namespace nearfield::fit
