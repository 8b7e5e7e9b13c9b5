// SPDX-License-Identifier: Apache-2.0
// The windowed sum: the machine's roofs, the inner loop alone, the weights alone, and frames of
// 512 x 384 unshadowed receivers on a wall of 4 x 3 m, lit by the 11 x 9 x 256^2 reference lamp:
// every receiver sees 25 x 25 texels of every image. Run: sum_bench [--benchmark_filter=...].
#include "formats/model/float_windows.h"
#include "formats/model/luminaire.h"
#include "formats/model/mip_sum.h"
#include "formats/model/prepared.h"
#include "formats/model/row_sums.h"
#include "sample_data/reference_lamp.h"
#include "tests/bench/roofline.h"

#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <numeric>
#include <vector>

namespace nearfield::bench {
namespace {

constexpr int kWidthPx = 512, kHeightPx = 384;
constexpr double kWallWidthM = 4.0, kWallDistanceM = 4.0;

glm::vec3 on_wall(int x, int y) {
    constexpr double kStepM = kWallWidthM / kWidthPx;
    return {static_cast<float>((x + 0.5 - 0.5 * kWidthPx) * kStepM),
            static_cast<float>((0.5 * kHeightPx - y - 0.5) * kStepM),
            static_cast<float>(kWallDistanceM)};
}

Slab reference_slab(int channels, Weighting weighting) {
    Slab slab = sample_data::make_reference_lamp().slabs[0];
    slab.weighting = weighting;
    slab.channels = channels;
    const std::vector<float> one = slab.coeffs;
    for (int c = 1; c < channels; ++c)
        slab.coeffs.insert(slab.coeffs.end(), one.begin(), one.end());
    return slab;
}

void fma(benchmark::State& state) {
    const int threads = static_cast<int>(state.range(0));
    for (auto _ : state)
        state.SetIterationTime(1.0);
    state.counters["madds"] = fma_roof(threads);
}
BENCHMARK(fma)->ArgName("threads")->Arg(1)->Arg(2)->UseManualTime()->Iterations(1);

void load(benchmark::State& state) {
    const auto reading = static_cast<Reading>(state.range(0));
    const int threads = static_cast<int>(state.range(2));
    for (auto _ : state)
        state.SetIterationTime(1.0);
    // The sum does two multiply-adds with every float that it reads.
    const double floats_s =
        load_roof(reading, static_cast<std::size_t>(state.range(1)) << 10, threads);
    state.counters["bytes"] = sizeof(float) * floats_s;
    state.counters["madds"] = 2.0 * floats_s;
    constexpr const char* kNames[] = {"aligned", "unaligned", "rows of 25 floats"};
    state.SetLabel(kNames[state.range(0)]);
}
BENCHMARK(load)
    ->ArgNames({"reading", "KiB", "threads"})
    ->ArgsProduct({{0, 1, 2}, {16, 256, 8192, 131072}, {1, 2}})
    ->UseManualTime()
    ->Iterations(1);

// One window, again and again: weights and texels in the first-level cache.
void row_sum(benchmark::State& state) {
    const auto columns = static_cast<std::size_t>(state.range(0));
    constexpr std::size_t kStride = 256, kRows = 25;
    std::vector<float> image(kStride * (kRows + 1), 1.0F);
    std::vector<float> p(columns + model::kRowPadding), q = p;
    std::fill_n(p.begin(), columns, 0.5F);
    std::fill_n(q.begin(), columns, 0.25F);
    const std::vector<float> y0(kRows, 1.0F), y1(kRows, 2.0F);
    const model::RowWeights weights{kRows, columns, p.data(), q.data(), y0.data(), y1.data()};
    std::size_t at = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(model::row_sum(image.data() + at, kStride, weights));
        at = (at + 5) % 16;  // windows start anywhere
    }
    report_multiply_adds(
        state, 2.0 * static_cast<double>(kRows * columns) * static_cast<double>(state.iterations()),
        1);
}
BENCHMARK(row_sum)->ArgName("columns")->Arg(8)->Arg(16)->Arg(25)->Arg(32)->Arg(64);

// The windows of one receiver along both axes.
void weights(benchmark::State& state) {
    const Slab slab = reference_slab(1, Weighting::Irradiance);
    model::FloatWindows x, y;
    int k = 0;
    for (auto _ : state) {
        const glm::vec3 p = on_wall(k++ % kWidthPx, 100);
        model::fill(x, slab, 0, p.x, p.z);
        model::fill(y, slab, 1, p.y, p.z);
        benchmark::DoNotOptimize(x.m0.data());
    }
}
BENCHMARK(weights)->Unit(benchmark::kMicrosecond);

struct FrameOptions {
    int threads = 1, tile = 4, channels = 1, q = 0;
    Weighting weighting = Weighting::Irradiance;
    bool image_y = false;
};

struct TileScratch {
    std::vector<model::ReceiverF> receivers;
    std::vector<glm::vec3> results;
    std::vector<float> image_y;
    std::uint64_t multiply_adds = 0;
};

void frame(benchmark::State& state, const FrameOptions& options) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));
    const glm::vec3 normal = glm::normalize(glm::vec3(0.2F, 0.3F, -1.0F));
    const model::PreparedMips lamp =
        model::prepare_mips(reference_slab(options.channels, options.weighting));
    const auto images = static_cast<std::size_t>(lamp.levels[0].slab.image_count());
    tbb::enumerable_thread_specific<TileScratch> scratches;
    const auto tile = static_cast<std::size_t>(options.tile);
    for (auto _ : state) {
        tbb::parallel_for(
            tbb::blocked_range2d<int>(0, kHeightPx, tile, 0, kWidthPx, tile),
            [&](const tbb::blocked_range2d<int>& range) {
                TileScratch& scratch = scratches.local();
                scratch.receivers.clear();
                for (int y = range.rows().begin(); y < range.rows().end(); ++y)
                    for (int x = range.cols().begin(); x < range.cols().end(); ++x)
                        scratch.receivers.push_back({on_wall(x, y), normal});
                scratch.results.resize(scratch.receivers.size());
                scratch.image_y.resize(options.image_y ? images * scratch.receivers.size() : 0);
                scratch.multiply_adds += model::irradiance(lamp, options.q, scratch.receivers,
                                                           scratch.results, scratch.image_y);
            },
            tbb::simple_partitioner{});
    }
    const double multiply_adds = std::accumulate(
        scratches.begin(), scratches.end(), 0.0, [](double sum, const TileScratch& scratch) {
            return sum + static_cast<double>(scratch.multiply_adds);
        });
    report_multiply_adds(state, multiply_adds, options.threads);
    state.counters["a_receiver"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * kWidthPx * kHeightPx,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// Times a frame takes, on the wall.
void by_the_clock(benchmark::internal::Benchmark* registered) {
    registered->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK_CAPTURE(frame, threads_1_tile_1, FrameOptions{.tile = 1})->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_1_tile_4, FrameOptions{})->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_1_tile_6, FrameOptions{.tile = 6})->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_1_tile_8, FrameOptions{.tile = 8})->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_2_tile_4, FrameOptions{.threads = 2})->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_2_tile_8, FrameOptions{.threads = 2, .tile = 8})
    ->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_2_image_y, FrameOptions{.threads = 2, .image_y = true})
    ->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_2_rgb, FrameOptions{.threads = 2, .channels = 3})
    ->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame,
                  threads_2_rgb_image_y,
                  FrameOptions{.threads = 2, .channels = 3, .image_y = true})
    ->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame,
                  threads_2_radiance,
                  FrameOptions{.threads = 2, .weighting = Weighting::Radiance})
    ->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_2_q_16, FrameOptions{.threads = 2, .q = 16})->Apply(by_the_clock);
BENCHMARK_CAPTURE(frame, threads_2_q_8, FrameOptions{.threads = 2, .q = 8})->Apply(by_the_clock);

// The double reference, a receiver at a time.
void double_receiver(benchmark::State& state) {
    const Slab slab = reference_slab(1, Weighting::Irradiance);
    int k = 0;
    for (auto _ : state) {
        const model::Receiver receiver{glm::dvec3(on_wall(k++ % kWidthPx, 100)), {0.0, 0.0, -1.0}};
        benchmark::DoNotOptimize(model::irradiance(slab, receiver));
    }
}
BENCHMARK(double_receiver)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace nearfield::bench

BENCHMARK_MAIN();
