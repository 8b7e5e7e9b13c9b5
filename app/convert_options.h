// SPDX-License-Identifier: Apache-2.0
/// The options of `nearfield convert`.
#pragma once

#include "app/output.h"
#include "app/photometry_input.h"
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
    PhotometryOptions photometry;
    std::optional<double> flux;  // total to scale the light to, lm or W
    bool allow_drop = false;
};

/// What is read: options of the other kind are refused.
enum class ConvertInput { Rays, Photometry };

/// Throws a usage error naming an option that was given and is not for this kind of file.
void refuse_options_of_others(const CLI::App& sub, ConvertInput input);

/// Declares the options, bound to `command`.
void add_convert_options(CLI::App& sub, ConvertCommand& command);

}  // namespace nearfield::app
