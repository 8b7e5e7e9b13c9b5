// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nearfield {

/// Where a file came from. Every file that the program writes carries one.
///
/// The same inputs and options give the same Provenance, byte for byte; what differs from run to
/// run (date, time taken, memory, threads) is a RunRecord, kept apart so that it can be left out.
struct Provenance {
    struct Input {
        std::string name;    // file name without folders
        std::string xxh128;  // as `xxh128sum` prints it
    };
    std::string program;                                       // "nearfield 0.1.0"
    std::string command;                                       // "convert"
    std::vector<std::pair<std::string, std::string>> options;  // as parsed, defaults included
    std::vector<Input> inputs;
    /// What the stage measured of its own result, by name with unit: {"flux_dropped_lm", 0.23}.
    std::vector<std::pair<std::string, double>> figures;
};

/// What differs between two runs of the same command.
struct RunRecord {
    std::string date_utc;  // ISO 8601
    double time_s = 0;
    double peak_memory_mib = 0;
    int threads = 0;
};

/// "nearfield 0.1.0".
std::string program_version();

/// XXH3 (128 bits) of a file's content, as `xxh128sum` prints it. Throws Error if the file cannot
/// be read.
std::string hash_file(const std::string& path);

/// The same of bytes in memory.
std::string hash_bytes(std::string_view bytes);

/// The input's entry: name without folders, hash. Throws Error if the file cannot be read.
Provenance::Input describe_input(const std::string& path);

/// Date, peak memory and threads of this process, and the time since `start_s` on the steady clock.
RunRecord finish_run(double start_s, int threads);

/// Seconds on the steady clock.
double now_s();

}  // namespace nearfield
