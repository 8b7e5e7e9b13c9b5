// SPDX-License-Identifier: Apache-2.0
#include "app/export_photometry.h"

#include "app/output.h"
#include "formats/model/luminaire.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/of_lightfield.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

namespace nearfield::app {
namespace {

// What every round trip is to keep.
constexpr double kMostFluxError = 1e-3;

}  // namespace

photometry::Photometry far_field_table(const LightField& lightfield,
                                       const std::string& input,
                                       const PhotometryExport& options) {
    photometry::TableOptions table;
    if (!options.planes || !options.quarter_angles)
        table = photometry::choose_table(lightfield);
    table.planes = options.planes.value_or(table.planes);
    table.quarter_angles = options.quarter_angles.value_or(table.quarter_angles);
    photometry::Photometry lamp = photometry::photometry_of(lightfield, table);
    lamp.labels = {{"LUMINAIRE", std::filesystem::path(input).filename().string()},
                   {"OTHER", program_version() + " export: far field of a near-field luminaire"}};
    return lamp;
}

void export_photometry(const std::string& input,
                       const std::string& output,
                       const PhotometryExport& options) {
    const double start_s = now_s();
    photometry::Photometry lamp;
    double flux_in = 0;
    if (photometry::holds_photometry(input)) {
        lamp = photometry::read_photometry(input);
        flux_in = photometry::flux_lm(lamp);
    } else {
        const LightField lightfield = read_lightfield(input);
        lamp = far_field_table(lightfield, input, options);
        flux_in = model::luminance(model::flux(lightfield));
    }
    const double flux_out = photometry::flux_lm(lamp);
    write_photometry(lamp, options.format, output);
    const double error = flux_out / flux_in - 1;
    say(fmt::format("{}: {} planes x {} angles, {:.6g} of {:.6g} lm ({:+.3f} %); {}\n", output,
                    lamp.planes_deg.size(), lamp.angles_deg.size(), flux_out, flux_in, 100 * error,
                    cost(record_run(start_s))));
    if (std::abs(error) > kMostFluxError)
        throw CLI::RuntimeError(3);
}

}  // namespace nearfield::app
