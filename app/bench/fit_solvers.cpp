// SPDX-License-Identifier: Apache-2.0
#include "app/bench/fit_solvers.h"

#include "fit/lawson_hanson.h"
#include "fit/noise.h"
#include "fit/stream.h"
#include "formats/files/provenance.h"
#include "formats/model/profile.h"
#include "sample_data/random.h"
#include "sample_data/reference_lamp.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <ctime>

namespace nearfield::bench {
namespace {

constexpr int kChannels = 3;
constexpr double kChannel[kChannels] = {1.0, 0.7, 0.4};  // of the lamp's light

// What other programs take of the machine does not count.
double cpu_s(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The lamp with another number of texels, taken from its own.
struct LampToFit {
    Slab planes;
    std::vector<float> coeffs;  // [m][j][i] of its own texels
    glm::ivec2 own{0};
};

LampToFit make_lamp_to_fit(int texels) {
    Slab slab = sample_data::make_reference_lamp().slabs.front();
    LampToFit lamp{slab, std::move(slab.coeffs), slab.texels};
    lamp.planes.coeffs.clear();
    lamp.planes.texels = {texels, texels};
    return lamp;
}

// A filter with the basis' own profile at the grid's centers, each off by up to `error_m` along x,
// y and z.
fit::Optics filter_optics(const Slab& planes, double error_m) {
    fit::Optics optics;
    optics.filter_x = optics.filter_y = planes.profile;
    optics.filter_pitch_m = planes.pitch_m;
    sample_data::SplitMix random{7};
    for (int m = 0; m < planes.image_count(); ++m) {
        const glm::dvec2 center_m = planes.basis_center_m(m % planes.grid.x, m / planes.grid.x);
        const auto off_m = [&] { return error_m * (2.0 * random.next() - 1.0); };
        const glm::dvec3 off(off_m(), off_m(), off_m());
        optics.position_m.push_back(glm::dvec3(center_m, -planes.delta_m) + off);
    }
    return optics;
}

// All channels of one texel with photon noise; the brightest datum has 1e6 electrons.
void measure_texel(const fit::TexelDesign& texel,
                   const std::vector<double>& truth,
                   const fit::TileLayout& layout,
                   std::size_t row,
                   std::size_t i,
                   fit::TileInput& input) {
    constexpr double kBrightest = 1e-4;  // of the lamp's measurements
    constexpr double kElectrons = 1e6, kDark = 1e-9;
    const fit::NoiseKey key = fit::noise_key(1, 0, 0, row * layout.width + i);
    for (std::size_t k = 0; k < layout.measurements; ++k) {
        const double light = predicted(texel, static_cast<int>(k), truth);
        for (std::size_t c = 0; c < kChannels; ++c) {
            const double variance =
                kBrightest * (kChannel[c] * light / kElectrons + kDark * kBrightest);
            const double noise =
                fit::normal_number(key, static_cast<std::uint32_t>(c * layout.measurements + k));
            const std::size_t to = layout.at(c, k, layout.measurements, row, i);
            input.value[to] = static_cast<float>(kChannel[c] * light + std::sqrt(variance) * noise);
            input.variance[to] = static_cast<float>(variance);
        }
    }
}

fit::TileInput measured(const LampToFit& lamp, const fit::Design& design) {
    const fit::TileLayout layout =
        fit::tile_layout(design, static_cast<int>(kChannels), {0, lamp.planes.texels.y});
    fit::TileInput input;
    input.value.resize(kChannels * layout.measurements * layout.rows * layout.width);
    input.variance.resize(input.value.size());
    tbb::parallel_for(std::size_t{0}, layout.rows, [&](std::size_t row) {
        fit::TexelDesign texel;
        std::vector<double> truth(layout.functions);
        for (std::size_t i = 0; i < layout.width; ++i) {
            if (i == 0 || design.is_varying())
                fill_texel_design(design, static_cast<int>(i), static_cast<int>(row), texel);
            const glm::ivec2 at = glm::ivec2(i, row) * lamp.own / lamp.planes.texels;
            for (std::size_t m = 0; m < layout.functions; ++m)
                truth[m] =
                    double(lamp.coeffs[m * static_cast<std::size_t>(lamp.own.x * lamp.own.y) +
                                       static_cast<std::size_t>(at.y * lamp.own.x + at.x)]);
            measure_texel(texel, truth, layout, row, i, input);
        }
    });
    return input;
}

SolveCost whole_cost(const fit::Design& design, const fit::TileInput& input, bool wants_sigma) {
    fit::FitOptions options;
    options.channels = kChannels;
    options.solve.wants_sigma = wants_sigma;
    fit::FitReport report;
    const double start_s = now_s(), cpu_start_s = cpu_s(CLOCK_PROCESS_CPUTIME_ID);
    (void)solve_tile(design, options, {0, design.texels.y}, input, report);
    SolveCost cost;
    cost.wall_s = now_s() - start_s;
    cost.cpu_s = cpu_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_start_s;
    cost.texels = design.texels.x;
    cost.channels = kChannels;
    cost.threads = tbb::info::default_concurrency();
    const auto count = static_cast<double>(report.texel_count);
    cost.texel_us = 1e6 * cost.cpu_s / count;
    cost.factorizations = static_cast<double>(report.factorizations) / count;
    cost.free_coefficients = static_cast<double>(report.free_count) / count;
    cost.kkt_worst = report.kkt_worst;
    return cost;
}

// A row of texels, one channel: each solver's coefficients and time.
struct RowTimes {
    double banded_s = 0, updated_s = 0, fresh_s = 0;
    double updated_difference = 0, fresh_difference = 0;
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0, most = 0;
    for (std::size_t m = 0; m < a.size(); ++m) {
        worst = std::max(worst, std::abs(a[m] - b[m]));
        most = std::max(most, std::abs(b[m]));
    }
    return most > 0 ? worst / most : worst;
}

// The problem as rows of a dense matrix.
void weigh(const fit::TexelDesign& texel,
           const std::vector<double>& weight,
           std::vector<double>& a,
           std::vector<double>& b) {
    a = dense(texel);
    const std::size_t columns = a.size() / b.size();
    for (std::size_t k = 0; k < b.size(); ++k) {
        const double root = std::sqrt(weight[k]);
        b[k] *= root;
        for (std::size_t m = 0; m < columns; ++m)
            a[k * columns + m] *= root;
    }
}

RowTimes row_times(const fit::Design& design, const fit::TileInput& input, std::size_t row) {
    const auto width = static_cast<std::size_t>(design.texels.x);
    const auto count = static_cast<std::size_t>(design.measurement_count);
    const fit::Penalty penalty = fit::difference_penalty(design.grid, 2);
    const auto timed = [](double& total_s, const auto& run) {
        const double start_s = cpu_s(CLOCK_THREAD_CPUTIME_ID);
        run();
        total_s += cpu_s(CLOCK_THREAD_CPUTIME_ID) - start_s;
    };
    RowTimes times;
    fit::TexelDesign texel;
    fit::Workspace work;
    fit::TexelFit found;
    std::vector<double> b(count), weight(count), a;
    for (std::size_t i = 0; i < width; ++i) {
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t at = (k * width + row) * width + i;
            b[k] = double(input.value[at]);
            weight[k] = 1.0 / double(input.variance[at]);
        }
        timed(times.banded_s, [&] {
            fill_texel_design(design, static_cast<int>(i), static_cast<int>(row), texel);
            solve_texel(texel, penalty, b, weight, {}, work, found);
        });
        weigh(texel, weight, a, b);
        std::vector<double> dense_found;
        const auto by = [&](fit::LeastSquares kept) {
            dense_found = fit::lawson_hanson(a, b, design.basis_count(), kept);
        };
        timed(times.updated_s, [&] { by(fit::LeastSquares::Updated); });
        times.updated_difference =
            std::max(times.updated_difference, largest_difference(found.coeffs, dense_found));
        timed(times.fresh_s, [&] { by(fit::LeastSquares::Fresh); });
        times.fresh_difference =
            std::max(times.fresh_difference, largest_difference(found.coeffs, dense_found));
    }
    return times;
}

std::vector<SolverTime> times_of(const fit::Design& design,
                                 const fit::TileInput& input,
                                 int compared) {
    const int width = design.texels.x;
    const int rows = std::clamp(compared / width, 1, design.texels.y);
    RowTimes all;
    for (int r = 0; r < rows; ++r) {
        const RowTimes one =
            row_times(design, input, static_cast<std::size_t>((2 * r + 1) * width / (2 * rows)));
        all.banded_s += one.banded_s;
        all.updated_s += one.updated_s;
        all.fresh_s += one.fresh_s;
        all.updated_difference = std::max(all.updated_difference, one.updated_difference);
        all.fresh_difference = std::max(all.fresh_difference, one.fresh_difference);
    }
    const std::int64_t texels = std::int64_t{rows} * width;
    const auto time = [&](const char* name, double time_s, double difference) {
        return SolverTime{name, 1e6 * time_s / static_cast<double>(texels), time_s / all.banded_s,
                          difference, texels};
    };
    return {time("banded, block pivoting", all.banded_s, 0),
            time("Lawson-Hanson, one QR updated", all.updated_s, all.updated_difference),
            time("Lawson-Hanson, fresh QR an exchange", all.fresh_s, all.fresh_difference)};
}

}  // namespace

SolverComparison compare_solvers(int texels, int compared) {
    constexpr double kOffU_m = 0.0005;
    const LampToFit lamp = make_lamp_to_fit(texels);
    SolverComparison comparison;
    for (const double error_m : {0.0, kOffU_m}) {
        const fit::Design design = make_design(lamp.planes, filter_optics(lamp.planes, error_m));
        const fit::TileInput input = measured(lamp, design);
        if (error_m > 0)
            comparison.solvers = times_of(design, input, compared);
        const std::string name = error_m > 0 ? "filter off U" : "filter on U";
        comparison.wholes.push_back({name, whole_cost(design, input, false)});
        comparison.wholes.push_back({name + ", sigmas", whole_cost(design, input, true)});
    }
    return comparison;
}

}  // namespace nearfield::bench
