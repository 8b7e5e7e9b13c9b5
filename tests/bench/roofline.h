// SPDX-License-Identifier: Apache-2.0
/// What this machine can do at most, measured and not computed: the roof beside a kernel's figures.
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>

namespace nearfield::bench {

/// Multiply-adds of floats a second on so many threads, operands in registers: 8 lanes (AVX2), the
/// baseline that this project is compiled for. Measured once a number of threads (0.2 s), the best
/// of several runs.
double fma_roof(int threads);

/// How an array is read.
enum class Reading {
    Aligned,    // 32 bytes at a time from multiples of 32
    Unaligned,  // the same, 4 bytes further on: every other load crosses a cache line
    Rows,       // as the windowed sum: rows of 25 floats, 1 KiB apart, 4 vectors each
};

/// Floats read a second on so many threads, each from `bytes` of its own; lanes that are read but
/// not asked for (Rows: 7 of 32) do not count. Measured on each call (0.1 s), the best of several
/// runs.
double load_roof(Reading reading, std::size_t bytes, int threads);

/// Counters of a benchmark that has done so many multiply-adds: "madds" a second, and
/// "fma_roof_share", their share of the roof (1 = all of it; the library prints it as a rate,
/// "/s").
void report_multiply_adds(benchmark::State& state, double multiply_adds, int threads);

}  // namespace nearfield::bench
