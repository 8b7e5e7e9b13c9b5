// SPDX-License-Identifier: Apache-2.0
/// What a command gives: its file, its result on stdout, its remarks on stderr.
#pragma once

#include "formats/files/provenance.h"

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace nearfield::app {

/// A command's file, as -o and --reproducible say.
struct Output {
    std::string path;
    bool reproducible = false;

    /// What the file keeps of the run.
    std::optional<RunRecord> stored(const RunRecord& run) const {
        return reproducible ? std::nullopt : std::optional(run);
    }
};

/// Declares -o,--output (required) and --reproducible.
CLI::Option* add_output(CLI::App& command, Output& output, const std::string& help);

/// Refuses outputs before the work starts: throws Error where one cannot be written, would replace
/// an input, or is named twice. Empty names are left out.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// The record of a run that used all cores it may.
RunRecord record_run(double start_s);

/// "0.12 s on 2 threads, peak memory 30 MiB".
std::string cost(const RunRecord& run);

/// The CPU's name and its threads, for reports: "AMD EPYC, 2 threads".
std::string machine();

/// Writes a result to stdout, at once. Throws Error where that fails (disk full); a reader that has
/// gone (`| head`) has had all it wanted.
void print(const std::string& result);

/// Writes a remark to stderr. That nobody can read it is no reason to stop.
void say(const std::string& remark);

}  // namespace nearfield::app
