// SPDX-License-Identifier: Apache-2.0
// Frames of 512 x 384 unshadowed receivers on a wall of 4 x 3 m, lit by the 11 x 9 x 256^2
// one-channel reference lamp: every receiver sees 25 x 25 texels of every image. Run: sum_bench
// [--benchmark_filter=...].
#include "formats/model/luminaire.h"
#include "formats/model/prepared.h"
#include "sample_data/reference_lamp.h"

#include <benchmark/benchmark.h>
#include <tbb/blocked_range2d.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <atomic>

namespace nearfield {
namespace {

constexpr int kWidthPx = 512, kHeightPx = 384;
constexpr double kWallWidthM = 4.0, kWallDistanceM = 4.0;

glm::vec3 on_wall(int x, int y) {
    const double step_m = kWallWidthM / kWidthPx;
    return {static_cast<float>((x + 0.5 - kWidthPx / 2) * step_m),
            static_cast<float>((kHeightPx / 2 - y - 0.5) * step_m),
            static_cast<float>(kWallDistanceM)};
}

// Arguments: threads, edge of a tile of receivers.
void frame(benchmark::State& state) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(state.range(0)));
    const int tile = static_cast<int>(state.range(1));
    const glm::vec3 normal = glm::normalize(glm::vec3(0.2F, 0.3F, -1.0F));
    const model::PreparedSlab lamp = model::prepare(sample_data::make_reference_lamp().slabs[0]);
    std::atomic<std::uint64_t> multiply_adds = 0;
    for (auto _ : state) {
        tbb::parallel_for(
            tbb::blocked_range2d<int>(0, kHeightPx, static_cast<std::size_t>(tile), 0, kWidthPx,
                                      static_cast<std::size_t>(tile)),
            [&](const tbb::blocked_range2d<int>& range) {
                std::vector<model::ReceiverF> receivers;
                for (int y = range.rows().begin(); y < range.rows().end(); ++y)
                    for (int x = range.cols().begin(); x < range.cols().end(); ++x)
                        receivers.push_back({on_wall(x, y), normal});
                std::vector<glm::vec3> results(receivers.size());
                multiply_adds += model::irradiance(lamp, receivers, results);
                benchmark::DoNotOptimize(results.data());
            },
            tbb::simple_partitioner{});
    }
    state.counters["multiply_adds"] =
        benchmark::Counter(static_cast<double>(multiply_adds.load()), benchmark::Counter::kIsRate);
}
BENCHMARK(frame)
    ->ArgNames({"threads", "tile"})
    ->Args({1, 1})
    ->Args({1, 4})
    ->Args({1, 8})
    ->Args({2, 8})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// The double reference, a receiver at a time.
void double_receiver(benchmark::State& state) {
    const LightField lamp = sample_data::make_reference_lamp();
    int k = 0;
    for (auto _ : state) {
        const model::Receiver receiver{glm::dvec3(on_wall(k % kWidthPx, 100)), {0.0, 0.0, -1.0}};
        benchmark::DoNotOptimize(model::irradiance(lamp, receiver));
        ++k;
    }
}
BENCHMARK(double_receiver)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace nearfield

BENCHMARK_MAIN();
