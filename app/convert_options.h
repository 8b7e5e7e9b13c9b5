// SPDX-License-Identifier: Apache-2.0
/// The options of `nearfield convert`.
#pragma once

#include "app/output.h"
#include "formats/rays/ray_file.h"
#include "formats/rays/to_lightfield.h"

#include <optional>
#include <string>

namespace nearfield::app {

struct ConvertCommand {
    std::string input;
    Output output;
    rays::ReadOptions read;
    rays::ConvertOptions options;
    std::optional<double> flux;  // total to scale the rays to, lm or W
    bool allow_drop = false;
};

/// Declares the options, bound to `command`.
void add_convert_options(CLI::App& sub, ConvertCommand& command);

}  // namespace nearfield::app
