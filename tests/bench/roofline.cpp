// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/roofline.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <chrono>
#include <limits>
#include <map>
#include <thread>
#include <vector>

namespace nearfield::bench {
namespace {

constexpr int kRuns = 7;
constexpr std::size_t kLanes = 8;
constexpr std::size_t kRowFloats = 25, kRowStride = 256, kRowVectors = 4;

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

// The shortest time in which all threads have done work(thread), from the first's start to the
// last's end.
template <typename Work>
double best_s(int threads, const Work& work) {
    double best = std::numeric_limits<double>::infinity();
    for (int run = 0; run < kRuns; ++run) {
        std::barrier together(threads);
        std::vector<double> starts_s(static_cast<std::size_t>(threads)), ends_s = starts_s;
        std::vector<std::thread> team;
        for (std::size_t t = 0; t < starts_s.size(); ++t)
            team.emplace_back([&, t] {
                together.arrive_and_wait();
                starts_s[t] = now_s();
                work(t);
                ends_s[t] = now_s();
            });
        for (std::thread& member : team)
            member.join();
        best = std::min(best, *std::max_element(ends_s.begin(), ends_s.end()) -
                                  *std::min_element(starts_s.begin(), starts_s.end()));
    }
    return best;
}

// 12 chains hide 4 cycles of latency at up to 3 multiply-adds a cycle.
float multiply_adds(std::size_t rounds) {
    constexpr int kChains = 12;
    const __m256 factor = _mm256_set1_ps(0.999F), term = _mm256_set1_ps(1e-3F);
    __m256 chains[kChains];
    std::fill_n(chains, kChains, term);
    for (std::size_t round = 0; round < rounds; ++round) {
#pragma GCC unroll 12
        for (std::size_t k = 0; k < kChains; ++k)
            chains[k] = _mm256_fmadd_ps(chains[k], factor, term);
    }
    __m256 sum = term;
    for (const __m256 chain : chains)
        sum = _mm256_add_ps(sum, chain);
    return _mm256_cvtss_f32(sum);
}

// Sums whole vectors from first to end.
__m256 add_run(const float* first, std::size_t vectors) {
    constexpr std::size_t kChains = 8;
    __m256 chains[kChains];
    std::fill_n(chains, kChains, _mm256_setzero_ps());
    for (std::size_t v = 0; v + kChains <= vectors; v += kChains) {
#pragma GCC unroll 8
        for (std::size_t k = 0; k < kChains; ++k)
            chains[k] = _mm256_add_ps(chains[k], _mm256_loadu_ps(first + (v + k) * kLanes));
    }
    __m256 sum = _mm256_setzero_ps();
    for (const __m256 chain : chains)
        sum = _mm256_add_ps(sum, chain);
    return sum;
}

// Sums rows of kRowVectors vectors.
__m256 add_rows(const float* first, std::size_t rows) {
    __m256 chains[2 * kRowVectors];
    std::fill_n(chains, 2 * kRowVectors, _mm256_setzero_ps());
    for (std::size_t row = 0; row + 2 <= rows; row += 2) {
#pragma GCC unroll 8
        for (std::size_t k = 0; k < 2 * kRowVectors; ++k)
            chains[k] = _mm256_add_ps(chains[k],
                                      _mm256_loadu_ps(first + (row + k / kRowVectors) * kRowStride +
                                                      k % kRowVectors * kLanes));
    }
    __m256 sum = _mm256_setzero_ps();
    for (const __m256 chain : chains)
        sum = _mm256_add_ps(sum, chain);
    return sum;
}

}  // namespace

double fma_roof(int threads) {
    static std::map<int, double> known;  // benchmarks run one after the other
    const auto found = known.find(threads);
    if (found != known.end())
        return found->second;
    constexpr std::size_t kRounds = 2'000'000, kChains = 12;
    const double time_s =
        best_s(threads, [](std::size_t) { benchmark::DoNotOptimize(multiply_adds(kRounds)); });
    return known[threads] =
               static_cast<double>(kRounds * kChains * kLanes * static_cast<std::size_t>(threads)) /
               time_s;
}

double load_roof(Reading reading, std::size_t bytes, int threads) {
    const std::size_t floats = bytes / sizeof(float);
    const std::size_t repeats = std::max<std::size_t>(1, (std::size_t{1} << 28) / bytes);
    struct alignas(64) Line {
        std::array<float, 16> values;
    };
    std::vector<std::vector<Line>> arrays(static_cast<std::size_t>(threads));
    for (std::vector<Line>& array : arrays)
        array.assign(floats / 16 + 2, Line{});
    const std::size_t rows = floats / kRowStride;
    const double time_s = best_s(threads, [&](std::size_t t) {
        const float* first = arrays[t].front().values.data();
        for (std::size_t k = 0; k < repeats; ++k)
            benchmark::DoNotOptimize(
                reading == Reading::Rows
                    ? add_rows(first + k % 16, rows)
                    : add_run(first + (reading == Reading::Unaligned ? 1 : 0), floats / kLanes));
    });
    const std::size_t useful = reading == Reading::Rows ? rows * kRowFloats : floats;
    return static_cast<double>(useful * repeats * static_cast<std::size_t>(threads)) / time_s;
}

void report_multiply_adds(benchmark::State& state, double multiply_adds, int threads) {
    state.counters["madds"] = benchmark::Counter(multiply_adds, benchmark::Counter::kIsRate);
    state.counters["fma_roof_share"] =
        benchmark::Counter(multiply_adds / fma_roof(threads), benchmark::Counter::kIsRate);
}

}  // namespace nearfield::bench
