// SPDX-License-Identifier: Apache-2.0
/// The measurements as files: CSV, JSON and a page.
#pragma once

#include "app/bench/sweeps.h"

#include <string>

namespace nearfield::bench {

/// What was measured, where and how, for the reader of the files.
struct Setup {
    std::string lamp;       // "the reference lamp: 11 x 9 images of 256 x 256 texels, ..."
    std::string receivers;  // "its 300 receivers"
    std::string command_line;
    std::string machine;  // CPU and cores
};

/// One line a result: sweep,curve,setting,sampler,size,... size is K or Q, 0 where exact. Errors
/// are relative, times a receiver. passes: over how many independent shifts errors are pooled.
std::string as_csv(const Findings& findings);

/// {"kind": "accuracy", ..., "results": [the same names], "summary": [time to 10 % and 1 %]}.
std::string as_json(const Findings& findings, const Setup& setup);

/// One self-contained page, without scripts.
void write_page(const Findings& findings, const Setup& setup, const std::string& path);

/// Where there is none. Throws Error.
void make_folder(const std::string& folder);

}  // namespace nearfield::bench
