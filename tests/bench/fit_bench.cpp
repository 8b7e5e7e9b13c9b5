// SPDX-License-Identifier: Apache-2.0
// The fit of the reference lamp (11 x 9 images, B-splines, three channels) from its measurements
// behind a filter with a camera's noise: texels of 256 x 256 and the same fit by a dense
// Lawson-Hanson, texel by texel, in the same run; time by kind of option; memory of a fit of
// 4096 x 4096 texels by tiles. Run: fit_bench [texels along an axis, default 256] [huge].
#include "fit/stream.h"
#include "formats/model/profile.h"
#include "sample_data/reference_lamp.h"
#include "tests/fit/bench_planes.h"
#include "tests/fit/dense_nnls.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

namespace nearfield::fit {
namespace {

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

// Of all threads together: what other programs take does not count.
double cpu_seconds_now() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double peak_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// The lamp's planes, one channel, its texels taken again for other counts.
struct Lamp {
    Slab planes;
    std::vector<float> coeffs;  // [m][j][i] of the file's own texels
    glm::ivec2 own{0};

    float at(int m, int i, int j) const {
        const int x = i * own.x / planes.texels.x, y = j * own.y / planes.texels.y;
        return coeffs[static_cast<std::size_t>((m * own.y + y) * own.x + x)];
    }
};

Lamp make_lamp(int texels) {
    Slab slab = sample_data::make_reference_lamp().slabs[0];
    Lamp lamp{slab, slab.coeffs, slab.texels};
    lamp.planes.texels = {texels, texels};
    lamp.planes.coeffs.clear();
    return lamp;
}

constexpr double kChannel[] = {1.0, 0.7, 0.4};

// Measurements of a tile with photon noise; the brightest datum has 1e6 electrons.
TileInput measured(const Lamp& lamp, const Design& design, int channels, TileRange rows) {
    const auto width = static_cast<std::size_t>(lamp.planes.texels.x);
    const auto height = static_cast<std::size_t>(rows.row_count);
    const auto count = static_cast<std::size_t>(design.measurement_count);
    TileInput input;
    input.value.resize(static_cast<std::size_t>(channels) * count * height * width);
    input.variance.resize(input.value.size());
    const std::size_t channel_count =
        std::min(static_cast<std::size_t>(channels), std::size(kChannel));
    TexelDesign texel;
    std::vector<double> truth(static_cast<std::size_t>(design.basis_count()));
    for (std::size_t j = 0; j < height; ++j)
        for (std::size_t i = 0; i < width; ++i) {
            const int row = rows.first_row + static_cast<int>(j);
            if (i == 0 || design.is_varying())
                fill_texel_design(design, static_cast<int>(i), row, texel);
            for (std::size_t m = 0; m < truth.size(); ++m)
                truth[m] = lamp.at(static_cast<int>(m), static_cast<int>(i), row);
            support::Random random{static_cast<std::uint64_t>(row) * 8192 + i};
            for (std::size_t k = 0; k < count; ++k) {
                const double light = predicted(texel, static_cast<int>(k), truth);
                for (std::size_t c = 0; c < channel_count; ++c) {
                    const double scale = 1e-4;  // of the reference lamp's largest measurement
                    const double variance = scale * (1e-6 * kChannel[c] * light + 1e-9 * scale);
                    const std::size_t at = ((c * count + k) * height + j) * width + i;
                    input.value[at] = static_cast<float>(
                        kChannel[c] * light + std::sqrt(variance) * normal_number(random));
                    input.variance[at] = static_cast<float>(variance);
                }
            }
        }
    return input;
}

void print(const char* name, double time_s, double cpu_s, const FitReport& report) {
    std::printf(
        "%-28s %8.3f s, %7.1f us of a core a texel and channel, %4.2f factorizations, %4.1f free, "
        "KKT <= %.1e, 99 %% %.0e, chi2 %.3f, not converged %lld\n",
        name, time_s, 1e6 * cpu_s / static_cast<double>(report.texel_count),
        static_cast<double>(report.factorizations) / static_cast<double>(report.texel_count),
        static_cast<double>(report.free_count) / static_cast<double>(report.texel_count),
        report.kkt_worst, report.kkt_quantile(0.99), report.reduced_chi_square(),
        static_cast<long long>(report.unconverged_count));
}

double run(const char* name,
           const Design& design,
           const FitOptions& options,
           const TileInput& input,
           TileResult* result = nullptr) {
    FitReport report;
    const double start = seconds_now(), cpu_start = cpu_seconds_now();
    TileResult solved = solve_tile(design, options, {0, design.texels.y}, input, report);
    const double cpu_s = cpu_seconds_now() - cpu_start;
    print(name, seconds_now() - start, cpu_s, report);
    if (result != nullptr)
        *result = std::move(solved);
    return cpu_s;
}

// The dense solver on every `step`-th texel of the first channel: its time and the largest
// difference, relative to the texel's largest coefficient.
void against_dense(const Design& design,
                   const TileInput& input,
                   const TileResult& result,
                   double fast_us) {
    const auto width = static_cast<std::size_t>(design.texels.x);
    const auto count = static_cast<std::size_t>(design.measurement_count);
    const auto n = static_cast<std::size_t>(design.basis_count());
    const std::size_t texels = width * width, step = texels / 200 | 1U;
    double time_s = 0, worst = 0;
    int done = 0;
    for (std::size_t t = 0; t < texels; t += step, ++done) {
        TexelDesign texel;
        fill_texel_design(design, static_cast<int>(t % width), static_cast<int>(t / width), texel);
        std::vector<double> a = dense(texel), b(count);
        for (std::size_t k = 0; k < count; ++k) {
            const double root =
                1.0 / std::sqrt(static_cast<double>(input.variance[k * texels + t]));
            b[k] = root * input.value[k * texels + t];
            for (std::size_t m = 0; m < n; ++m)
                a[k * n + m] *= root;
        }
        const double start = cpu_seconds_now();
        const std::vector<double> c = dense_nnls(a, b, static_cast<int>(n));
        time_s += cpu_seconds_now() - start;
        const double most = *std::max_element(c.begin(), c.end());
        for (std::size_t m = 0; m < n; ++m)
            worst = std::max(worst,
                             std::abs(c[m] - static_cast<double>(result.coeffs[m * texels + t])) /
                                 std::max(most, 1e-300));
    }
    std::printf(
        "dense Lawson-Hanson          %8.1f us of a core a texel: %.0f times ours; largest "
        "difference %.1e (floats: 6e-8)\n",
        1e6 * time_s / done, 1e6 * time_s / done / fast_us, worst);
}

void run_huge() {
    const Lamp lamp = make_lamp(4096);
    Optics optics = test_filter(lamp.planes, 0.0005);
    const Design design = make_design(lamp.planes, optics);
    FitOptions options;
    options.channels = 3;
    options.tile_bytes = 128e6;
    const int rows = tile_rows(design, options);
    FitReport report;
    const double start = seconds_now(), cpu_start = cpu_seconds_now();
    // Two tiles of 4096 texels' width: all others are like them.
    for (int tile = 0; tile < 2; ++tile) {
        const TileRange range{2048 + tile * rows, rows};
        (void)solve_tile(design, options, range, measured(lamp, design, 3, range), report);
    }
    print("4096 wide, two tiles", seconds_now() - start, cpu_seconds_now() - cpu_start, report);
    std::printf("rows a tile %d, peak memory %.0f MiB\n", rows, peak_mib());
}

void run_all(int texels) {
    const Lamp lamp = make_lamp(texels);
    for (const double error_m : {0.0, 0.0005}) {
        const Design design = make_design(lamp.planes, test_filter(lamp.planes, error_m));
        std::printf("%d x %d texels, filter %s\n", texels, texels,
                    design.is_varying() ? "off U by 0.5 mm" : "on U");
        const TileInput input = measured(lamp, design, 3, {0, texels});
        FitOptions options;
        options.channels = 3;
        TileResult result;
        const double cpu_s = run("lambda 0", design, options, input, &result);
        const double texels_count = 3.0 * texels * texels;
        against_dense(design, input, result, 1e6 * cpu_s / texels_count);
        options.solve.lambda = 1e-4;
        run("lambda 1e-4", design, options, input);
        options.solve.wants_sigma = true;
        run("lambda 1e-4, sigma", design, options, input);
        options.solve.wants_sigma = false;
        options.replicates = 4;
        run("lambda 1e-4, 4 replicates", design, options, input);
    }
    std::printf("peak memory %.0f MiB\n", peak_mib());
}

}  // namespace
}  // namespace nearfield::fit

int main(int count, char** arguments) {
    if (count > 2 && std::string(arguments[2]) == "huge")
        nearfield::fit::run_huge();
    else
        nearfield::fit::run_all(count > 1 ? std::atoi(arguments[1]) : 256);
    return 0;
}
