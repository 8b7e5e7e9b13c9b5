// SPDX-License-Identifier: Apache-2.0
#include "fit/sigma.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

using LaneSums = std::array<double, kLanes>;

// Diagonal of X (lambda D^T Q D)_FF X for eight columns of X, which stand in work.lanes.
LaneSums penalty_sums(const Penalty& penalty,
                      const Workspace& work,
                      const std::vector<int>& place) {
    LaneSums sums{};
    for (std::size_t d = 0; d < work.normal.penalty_weight.size(); ++d) {
        LaneSums difference{};
        for (std::size_t p = 0; p < penalty.stencil.size(); ++p) {
            const auto [first, step] = penalty.differences[d];
            const int at = place[static_cast<std::size_t>(first + static_cast<int>(p) * step)];
            for (std::size_t lane = 0; at >= 0 && lane < kLanes; ++lane)
                difference[lane] +=
                    penalty.stencil[p] * work.lanes[static_cast<std::size_t>(at) * kLanes + lane];
        }
        for (std::size_t lane = 0; lane < kLanes; ++lane)
            sums[lane] += work.normal.penalty_weight[d] * difference[lane] * difference[lane];
    }
    return sums;
}

LaneSums squared_norms(const Workspace& work) {
    LaneSums sums{};
    for (std::size_t at = 0; at < work.lanes.size(); ++at)
        sums[at % kLanes] += work.lanes[at] * work.lanes[at];
    return sums;
}

void clear_lanes(Workspace& work) {
    work.lanes.assign(static_cast<std::size_t>(work.factor.padded * kLanes), 0.0);
}

void fill_free(const Penalty& penalty,
               const std::vector<int>& place,
               Workspace& work,
               TexelFit& fit) {
    const int count = work.factor.size;
    for (int begin = 0; begin < count; begin += kLanes) {
        const int lanes = std::min(kLanes, count - begin);
        clear_lanes(work);
        for (int lane = 0; lane < lanes; ++lane)
            work.lanes[static_cast<std::size_t>((begin + lane) * kLanes + lane)] = 1.0;
        solve_lower(work.factor, begin, work.lanes.data());
        LaneSums variance = squared_norms(work);
        if (!work.normal.penalty_weight.empty()) {
            solve_upper(work.factor, work.lanes.data());
            const LaneSums smoothed = penalty_sums(penalty, work, place);
            for (std::size_t lane = 0; lane < kLanes; ++lane)
                variance[lane] -= smoothed[lane];
        }
        for (int lane = 0; lane < lanes; ++lane)
            fit.sigma[static_cast<std::size_t>(
                work.free_index[static_cast<std::size_t>(begin + lane)])] =
                std::sqrt(std::max(0.0, variance[static_cast<std::size_t>(lane)]));
    }
}

double symmetric_entry(const NormalEquations& normal, int a, int b) {
    return normal.entry(std::max(a, b), std::min(a, b));
}

void fill_bound(const std::vector<int>& bound, Workspace& work, TexelFit& fit) {
    for (std::size_t begin = 0; begin < bound.size(); begin += kLanes) {
        const std::size_t lanes = std::min<std::size_t>(kLanes, bound.size() - begin);
        clear_lanes(work);
        for (std::size_t i = 0; i < work.free_index.size(); ++i)
            for (std::size_t lane = 0; lane < lanes; ++lane)
                work.lanes[i * kLanes + lane] =
                    symmetric_entry(work.normal, work.free_index[i], bound[begin + lane]);
        solve_lower(work.factor, 0, work.lanes.data());
        const LaneSums explained = squared_norms(work);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const auto m = static_cast<std::size_t>(bound[begin + lane]);
            const double s =
                work.normal.entry(bound[begin + lane], bound[begin + lane]) - explained[lane];
            fit.sigma[m] = s > 0.0 ? one_sided_rms(std::max(0.0, work.gradient[m]) / std::sqrt(s)) /
                                         std::sqrt(s)
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

void fill_sigma(const Penalty& penalty, Workspace& work, TexelFit& fit) {
    const std::size_t n = work.normal.norm.size();
    fit.sigma.assign(n, std::numeric_limits<double>::infinity());
    std::vector<int> place(n, -1), bound;
    for (std::size_t i = 0; i < work.free_index.size(); ++i)
        place[static_cast<std::size_t>(work.free_index[i])] = static_cast<int>(i);
    for (std::size_t m = 0; m < n; ++m)
        if (place[m] < 0 && work.normal.norm[m] > 0.0)
            bound.push_back(static_cast<int>(m));
    fill_free(penalty, place, work, fit);
    fill_bound(bound, work, fit);
}

}  // namespace nearfield::fit
