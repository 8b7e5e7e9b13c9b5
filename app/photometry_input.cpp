// SPDX-License-Identifier: Apache-2.0
#include "app/photometry_input.h"

#include "app/convert_options.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"
#include "formats/photometry/to_lightfield.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace nearfield::app {
namespace {

photometry::LightFieldOptions options_of(const ConvertCommand& command) {
    const PhotometryOptions& own = command.photometry;
    photometry::LightFieldOptions options;
    options.slabs = command.options.slabs;
    if (command.options.grid)
        options.cells = std::max(command.options.grid->x, command.options.grid->y);
    if (command.options.texels)
        options.texels = std::max(command.options.texels->x, command.options.texels->y);
    if (own.opening_mm.size() == 2)
        options.opening_m = 1e-3 * glm::dvec2(own.opening_mm[0], own.opening_mm[1]);
    options.half_angle_deg = own.half_angle_deg.value_or(options.half_angle_deg);
    options.delta_sides = own.depth_sides.value_or(options.delta_sides);
    return options;
}

std::string summary(const photometry::Photometry& lamp, const photometry::FarLightField& far) {
    const double lost_lm = far.photometry_lm - far.lightfield_lm;
    const double lost_percent = 100 * lost_lm / far.photometry_lm;
    std::string text =
        fmt::format("{}: {:.6g} lm; {} slab{} hold {:.6g} lm, {:.3f} % less", lamp.format,
                    far.photometry_lm, far.lightfield.slabs.size(),
                    far.lightfield.slabs.size() == 1 ? "" : "s", far.lightfield_lm, lost_percent);
    text += far.least_lost_deg > far.most_lost_deg
                ? std::string(": nothing lies outside\n")
                : fmt::format(": light {:.0f} ... {:.0f} deg from +z lies outside\n",
                              far.least_lost_deg, far.most_lost_deg);
    const Slab& slab = far.lightfield.slabs.front();
    const glm::dvec2 opening_mm = 1e3 * slab.pitch_m * glm::dvec2(slab.grid);
    return text + fmt::format(
                      "assumed: every point of an opening of {:g} x {:g} mm shines as the "
                      "whole lamp does from afar\n",
                      opening_mm.x, opening_mm.y);
}

Provenance describe(const ConvertCommand& command,
                    const photometry::Photometry& lamp,
                    const photometry::FarLightField& far,
                    const photometry::LightFieldOptions& options) {
    Provenance p;
    p.program = program_version();
    p.command = "convert";
    p.options = {{"format", lamp.format},
                 {"slabs", fmt::format("{}", far.lightfield.slabs.size())},
                 {"half_angle_deg", fmt::format("{}", options.half_angle_deg)},
                 {"depth_sides", fmt::format("{}", options.delta_sides)},
                 {"lamp_set", fmt::format("{}", lamp.lamp_set)},
                 {"flux", command.flux ? fmt::format("{}", *command.flux) : "as the file's"}};
    p.inputs = {describe_input(command.input)};
    p.figures = {{"flux_in_lm", far.photometry_lm},
                 {"flux_out_lm", far.lightfield_lm},
                 {"flux_dropped_lm", far.photometry_lm - far.lightfield_lm}};
    return p;
}

}  // namespace

void convert_photometry(ConvertCommand& command) {
    const double start_s = now_s();
    photometry::Photometry lamp =
        photometry::read_photometry(command.input, {command.photometry.lamp_set.value_or(0)});
    if (command.flux)
        photometry::scale_to(lamp, *command.flux);
    for (const std::string& note : lamp.notes)
        say(fmt::format("{}: {}\n", command.input, note));
    const photometry::LightFieldOptions options = options_of(command);
    photometry::FarLightField far = photometry::to_lightfield(lamp, options);
    say(summary(lamp, far));
    const double lost_lm = far.photometry_lm - far.lightfield_lm;
    if (lost_lm > rays::kMostDropped * far.photometry_lm && !command.allow_drop) {
        say(fmt::format("{}: not written: over 2 % of the flux is lost; --allow-drop writes it\n",
                        command.output.path));
        throw CLI::RuntimeError(3);
    }
    far.lightfield.provenance = describe(command, lamp, far, options);
    const RunRecord run = record_run(start_s);
    write_lightfield(far.lightfield, command.output.stored(run), command.output.path);
    say(fmt::format("{}: {}\n", command.output.path, cost(run)));
}

}  // namespace nearfield::app
