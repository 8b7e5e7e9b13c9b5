// SPDX-License-Identifier: Apache-2.0
// Hard cases of summed-area tables and of what is drawn from them. Positions' chi-square and the
// z-tests of full-size lamps are the estimators' own tests.
#include "formats/model/profile.h"
#include "formats/model/sampler.h"
#include "formats/shared/rng.glsl.h"
#include "formats/shared/sequences.glsl.h"
#include "tests/model/hard_cases.h"
#include "tests/model/texel_sums.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/random.h"
#include "tests/support/receivers.h"
#include "tests/support/z_test.h"

#include <algorithm>
#include <cmath>

namespace nearfield::test {
namespace {

using model::ReceiverF;
using model::Sampler;
using model::SamplerOptions;
using model::SamplingSlab;
using model::SamplingView;
using model::TablePrecision;
using support::LampShape;
using support::Random;
using support::random_lamp;

SamplerOptions options_of(Sampler sampler, int samples = 64) {
    SamplerOptions options;
    options.sampler = sampler;
    options.samples = samples;
    options.sequence = model::default_sequence(sampler);
    return options;
}

double relative_error(double got, double expected) {
    return got == expected ? 0.0 : std::abs(got - expected) / std::abs(expected);
}

// int C over the box of the only image that the view shows, its corners where the view has them.
double energy_of_box(const Slab& slab, const SamplingView& view) {
    const shared::AxisBox &x = view.x[0], &y = view.y[0];
    double sum = 0.0;
    for (int j = y.first; j <= y.last; ++j) {
        double row = 0.0;
        for (int i = x.first; i <= x.last; ++i)
            row += static_cast<double>(texel_width(x, i)) *
                   slab.coeffs[to_size(j) * to_size(slab.texels.x) + to_size(i)];
        sum += static_cast<double>(texel_width(y, j)) * row;
    }
    return slab.delta_m * slab.delta_m * sum;
}

// Boxes that hold at least 1e-9 of the image's light, half of them dark, with fractional corners:
// A_m of pairs of floats, and of one float's table.
HardRow dark_boxes(int size, int tries) {
    HardRow row{"relative error of A_m, " + std::to_string(size) + "² texels", 1e-4, 0.0,
                std::nullopt, 0.0};
    SamplingSlab slab = model::prepare_sampling(wide_range_slab(size));
    Slab& lamp = slab.prepared.slab;
    const glm::dvec2 s_m = lamp.s_max_m - lamp.s_min_m;
    const double least = 1e-9 * sum_box(lamp, {0, 0, size, size}) / s_m.x / s_m.y;
    Random random{7};
    SamplerOptions options = options_of(Sampler::Systematic);
    SamplingView view;
    for (int k = 0; k < tries; ++k) {
        const double low = k % 2 == 0 ? 0.51 : 0.0;
        const auto edge = [&] { return low + (1.0 - low) * random.uniform(); };
        const auto [x0, x1] = std::minmax({edge(), edge()});
        const auto [y0, y1] = std::minmax({edge(), edge()});
        // From 10 delta above the origin, s = u * 10 / 11.
        lamp.pitch_m = glm::dvec2(x1 - x0, y1 - y0) * s_m * 1.1;
        lamp.u_center_m = (lamp.s_min_m + 0.5 * glm::dvec2(x0 + x1, y0 + y1) * s_m) * 1.1;
        const ReceiverF receiver{{0, 0, static_cast<float>(10.0 * lamp.delta_m)}, {0, 0, -1}};
        options.precision = TablePrecision::Pair;
        look(slab, receiver, options, view);
        const double exact = energy_of_box(lamp, view);
        // energy is per square of a tangent, 2 m each, and times delta^2
        if (exact < least * lamp.delta_m * lamp.delta_m * (x1 - x0) * (y1 - y0) / 4.0)
            continue;
        row.in_float = std::max(*row.in_float, relative_error(view.energy[0], exact));
        options.precision = TablePrecision::Float;
        look(slab, receiver, options, view);
        row.naive = std::max(*row.naive, relative_error(view.energy[0], exact));
    }
    return row;
}

std::vector<HardRow> dark_box() {
    return {dark_boxes(512, 300), dark_boxes(4096, 60)};
}

// Overlap in tangents of texel i with a support [u_lo, u_hi].
double overlap_t(
    const Slab& slab, int axis, double p_m, double z_m, double u_lo, double u_hi, int i) {
    const double height_m = slab.delta_m + z_m;
    const auto u_of_s = [&](double s_m) { return s_m + (s_m - p_m) * slab.delta_m / z_m; };
    const double s_m = slab.s_min_m[axis] + i * slab.texel_m()[axis];
    double lo = -INFINITY, hi = INFINITY;
    if (z_m == 0.0) {
        if (p_m < s_m || p_m >= s_m + slab.texel_m()[axis])
            return 0.0;
    } else {
        const auto [a, b] = std::minmax({u_of_s(s_m), u_of_s(s_m + slab.texel_m()[axis])});
        lo = a;
        hi = b;
    }
    return std::max(std::min(hi, u_hi) - std::max(lo, u_lo), 0.0) / height_m;
}

double energy_of_image(const Slab& slab, const glm::dvec3& p_m, int m) {
    const glm::dvec2 half_m = 0.5 * static_cast<double>(slab.profile.cells.size()) * slab.pitch_m;
    const glm::dvec2 center_m = slab.basis_center_m(m % slab.grid.x, m / slab.grid.x);
    double sum = 0.0;
    for (int j = 0; j < slab.texels.y; ++j) {
        const double width_y =
            overlap_t(slab, 1, p_m.y, p_m.z, center_m.y - half_m.y, center_m.y + half_m.y, j);
        for (int i = 0; width_y > 0.0 && i < slab.texels.x; ++i)
            sum +=
                width_y *
                overlap_t(slab, 0, p_m.x, p_m.z, center_m.x - half_m.x, center_m.x + half_m.x, i) *
                slab.coeffs[slab.image_offset(0, m) + to_size(j) * to_size(slab.texels.x) +
                            to_size(i)];
    }
    return slab.delta_m * slab.delta_m * sum;
}

std::vector<HardRow> energies_near_s() {
    HardRow row{"relative error of A_m at Δ/δ = 0, ±1e-7, ±1e-4, ±1e-2, −0.9", 1e-3, 0.0,
                std::nullopt};
    LampShape shape;
    shape.decades = 2;
    const SamplingSlab slab = model::prepare_sampling(
        random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 15, shape));
    const Slab& lamp = slab.prepared.slab;
    SamplingView view;
    std::uint64_t seed = 15;
    for (const double height : {0.0, 1e-7, -1e-7, 1e-4, -1e-4, 1e-2, -1e-2, -0.9}) {
        const support::HardReceiver hard = support::hard_receivers(lamp, height, ++seed)[0];
        const ReceiverF receiver{glm::vec3(hard.receiver.position_m), {0, 0, -1}};
        look(slab, receiver, options_of(Sampler::Systematic), view);
        for (int m = 0; m < lamp.image_count(); ++m) {
            const double exact = energy_of_image(lamp, glm::dvec3(receiver.position_m), m);
            row.in_float = std::max(*row.in_float, relative_error(view.energy[to_size(m)], exact));
        }
    }
    return {row};
}

struct Drawn {
    double z = 0;           // of the mean over all runs against the oracle
    double lost_share = 0;  // of draws without light
};

// `runs` independent sets of samples of one receiver.
Drawn draw_often(const SamplingSlab& slab,
                 const ReceiverF& receiver,
                 const SamplerOptions& options,
                 int runs,
                 std::uint32_t seed) {
    std::vector<SamplingView> views(1);
    std::vector<model::LightSample> samples;
    double sum = 0.0, squares = 0.0, kept = 0.0;
    for (int run = 0; run < runs; ++run) {
        const glm::vec2 shift =
            shift_of(model::Shift::Random, {static_cast<std::uint32_t>(run), 0}, 0, seed);
        const double value =
            irradiance_by_sampler({&slab, 1}, {&receiver, 1}, options, shift, views, samples).x;
        sum += value;
        squares += value * value;
        kept += static_cast<double>(samples.size());
    }
    const double mean = sum / runs;
    const double sigma = std::sqrt(std::max(squares / runs - mean * mean, 0.0) / (runs - 1.0));
    const double exact = support::oracle_irradiance(slab.prepared.slab,
                                                    model::Receiver{glm::dvec3(receiver.position_m),
                                                                    glm::dvec3(receiver.normal)})
                             .x;
    // Where no run differs from another, float's rounding is all there is.
    const double rounding = 1e-6 * exact;
    return {std::abs(mean - exact) / std::hypot(sigma, rounding),
            1.0 - kept / (static_cast<double>(runs) * options.samples)};
}

struct SamplingCase {
    std::string name;
    Slab slab;
    glm::ivec2 through;  // the texel through which receivers see the middle of U
};

ReceiverF receiver_through(const SamplingCase& one, double height_per_delta) {
    const Slab& slab = one.slab;
    const glm::dvec2 s_m = slab.s_min_m + (glm::dvec2(one.through) + 0.5) * slab.texel_m();
    const glm::dvec2 p_m = s_m + (s_m - slab.u_center_m) * height_per_delta;
    return {glm::vec3(glm::dvec3(p_m, height_per_delta * slab.delta_m)),
            glm::normalize(glm::vec3(0.2F, -0.1F, -1.0F))};
}

// Largest |z| over the cases, both unbiased samplers, three heights and the given counts.
std::vector<HardRow> unbiased(const std::vector<SamplingCase>& cases,
                              const std::vector<int>& counts) {
    std::vector<HardRow> rows;
    for (const SamplingCase& one : cases) {
        const SamplingSlab slab = model::prepare_sampling(one.slab);
        Drawn worst;
        int tests = 0;
        for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells})
            for (const double height : {-0.3, 0.0, 1.5})
                for (const int count : counts) {
                    const Drawn drawn =
                        draw_often(slab, receiver_through(one, height), options_of(sampler, count),
                                   200000 / (count + 100), 5);
                    worst.z = std::max(worst.z, drawn.z);
                    worst.lost_share = std::max(worst.lost_share, drawn.lost_share);
                    ++tests;
                }
        const double limit = support::sidak_z_limit(tests * static_cast<int>(cases.size()));
        rows.push_back({"z of the mean, " + one.name, limit, worst.z, std::nullopt});
        rows.push_back(
            {"share of draws without light, " + one.name, 1e-5, worst.lost_share, std::nullopt});
    }
    return rows;
}

Slab shaped(glm::ivec2 grid, glm::ivec2 texels, std::uint64_t seed) {
    LampShape shape;
    shape.grid = grid;
    shape.texels = texels;
    shape.decades = 2;
    shape.dark_fraction = 0.0;
    return random_lamp(model::make_profile("bspline"), Weighting::Irradiance, seed, shape);
}

template <typename IsLit>
Slab lit_where(glm::ivec2 texels, const IsLit& is_lit) {
    Slab slab = shaped({3, 2}, texels, 8);
    for (std::size_t k = 0; k < slab.coeffs.size(); ++k) {
        const auto at = static_cast<int>(k % slab.texel_count());
        if (!is_lit(at % texels.x, at / texels.x))
            slab.coeffs[k] = 0.0F;
    }
    return slab;
}

std::vector<HardRow> sparse_draws() {
    const glm::ivec2 size(24, 20);
    return unbiased(
        {{"one texel lit",
          lit_where(size, [](int i, int j) { return i == 12 && j == 10; }),
          {12, 10}},
         {"one row lit", lit_where(size, [](int, int j) { return j == 10; }), {12, 10}},
         {"one column lit", lit_where(size, [](int i, int) { return i == 12; }), {12, 10}},
         {"the last column lit", lit_where(size, [](int i, int) { return i == 23; }), {23, 10}},
         {"300 texels wide", shaped({3, 2}, {300, 5}, 31), {150, 2}},
         {"600 texels wide", shaped({3, 2}, {600, 5}, 32), {300, 2}},
         {"1080 texels wide", shaped({3, 2}, {1080, 5}, 33), {540, 2}}},
        {63});
}

std::vector<HardRow> odd_shapes() {
    return unbiased({{"one image", shaped({1, 1}, {24, 20}, 41), {12, 10}},
                     {"images of 1 x 1 texel", shaped({5, 4}, {1, 1}, 42), {0, 0}},
                     {"W ≠ H, texels not square", shaped({7, 2}, {9, 31}, 43), {4, 15}}},
                    {1, 16, 4096});
}

// Second coordinates of the lattice, q up to 1e7, against long double (whose 64 bits hold the
// product); and frac of the product in float.
std::vector<HardRow> lattice() {
    HardRow row{"error of frac(2654435769 q / 2³²), q up to 1e7", 1e-6, 0.0, std::nullopt, 0.0};
    const long double golden = 2654435769.0L / 4294967296.0L;
    const auto distance = [](double a, double b) {  // on the circle
        const double d = std::abs(a - b);
        return std::min(d, 1.0 - d);
    };
    for (std::uint32_t q = 1; q < 10'000'000; q += 997) {
        const long double product = golden * q;
        const auto exact = static_cast<double>(product - std::floor(product));
        const float got = shared::unit_float(shared::golden_word(q));
        const float naive = static_cast<float>(q) * static_cast<float>(golden);
        row.in_float = std::max(*row.in_float, distance(got, exact));
        row.naive = std::max(*row.naive, distance(naive - std::floor(naive), exact));
    }
    return {row};
}

}  // namespace

std::vector<HardCase> sampling_cases() {
    return {
        {"DarkBox", "dark box in a bright image",
         "differences of one float's summed-area table: all digits cancel", dark_box},
        {"EnergiesNearS", "energies on S and between the planes",
         "boxes smaller than a texel; texel coordinates by S's formula", energies_near_s},
        {"SparseDraws", "draws from sparse and odd-sized images",
         "0/0 in conditionals, searches that do not end, texels off by one", sparse_draws},
        {"OddShapes", "K = 1, K = 4096 ≫ texels, M = 1, 1 x 1 images, W ≠ H",
         "off by one; counts that round to zero", odd_shapes},
        {"Lattice", "K q beyond 1e5", "frac of a float product", lattice},
    };
}

}  // namespace nearfield::test
