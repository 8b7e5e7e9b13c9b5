// SPDX-License-Identifier: Apache-2.0
#include "app/output.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <tbb/info.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

namespace nearfield::app {
namespace {

bool is_same_file(const std::string& a, const std::string& b) {
    std::error_code ignored;  // what does not exist is compared by name
    const auto full = [&](const std::string& path) {
        return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
    };
    return std::filesystem::equivalent(a, b, ignored) || full(a) == full(b);
}

}  // namespace

CLI::Option* add_output(CLI::App& command, Output& output, const std::string& help) {
    CLI::Option* option = command.add_option("-o,--output", output.path, help);
    command.add_flag("--reproducible", output.reproducible,
                     "leave date, time taken and memory out: the same input gives the same bytes");
    return option->required()->type_name("FILE");
}

void check_outputs(const std::vector<std::string>& outputs,
                   const std::vector<std::string>& inputs) {
    for (std::size_t k = 0; k < outputs.size(); ++k) {
        if (outputs[k].empty())
            continue;
        for (const std::string& input : inputs)
            if (is_same_file(outputs[k], input))
                throw Error{"the output would replace an input", outputs[k], "another name"};
        for (std::size_t other = 0; other < k; ++other)
            if (is_same_file(outputs[k], outputs[other]))
                throw Error{"two outputs have the same name", outputs[k], "another name"};
        AtomicFile{outputs[k]};  // made, and gone again
    }
}

RunRecord record_run(double start_s) {
    return finish_run(start_s, tbb::info::default_concurrency());
}

std::string cost(const RunRecord& run) {
    return fmt::format("{:.2f} s on {} thread{}, peak memory {:.0f} MiB", run.time_s, run.threads,
                       run.threads == 1 ? "" : "s", run.peak_memory_mib);
}

std::string machine() {
    std::string name = "unknown CPU";
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name"))
            name = line.substr(std::min(line.size(), line.find(':') + 2));
    return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

void print(const std::string& result) {
    const std::size_t written = std::fwrite(result.data(), 1, result.size(), stdout);
    const bool is_good = written == result.size() && std::fflush(stdout) == 0;
    if (!is_good && errno != EPIPE)
        throw Error{"cannot write file", "standard output", "", system_error()};
}

void say(const std::string& remark) {
    std::fputs(remark.c_str(), stderr);
}

}  // namespace nearfield::app
