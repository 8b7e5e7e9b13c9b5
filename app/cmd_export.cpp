// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"
#include "formats/rays/export_rays.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace nearfield::app {
namespace {

struct ExportCommand {
    std::string input, output;
    std::optional<rays::RayFormat> format;
    std::optional<double> sphere_mm;
    std::vector<double> origin_mm{0, 0, 0};
    rays::ExportOptions options;
};

void run(ExportCommand& command) {
    const double start_s = now_s();
    rays::ExportOptions& options = command.options;
    check_options([&] {
        options.format = command.format ? *command.format : rays::ray_format_of(command.output);
    });
    check_outputs({command.output}, {command.input});
    options.origin_m =
        1e-3 * glm::dvec3(command.origin_mm[0], command.origin_mm[1], command.origin_mm[2]);
    if (command.sphere_mm) {
        options.start = rays::RayStart::Sphere;
        options.sphere_radius_m = 1e-3 * *command.sphere_mm;
    }
    const LightField lightfield = read_lightfield(command.input);
    ProgressLine progress("export");
    options.progress = [&](double fraction) { progress.update(fraction); };
    rays::export_rays(lightfield, command.output, options);
    progress.finish();
    const double flux = model::luminance(model::flux(lightfield));
    const char* unit = lightfield.quantity == Quantity::Photometric ? "lm" : "W";
    say(fmt::format("{}: {} rays of {:.6g} {} each, {:.6g} {} in all; {}\n", command.output,
                    options.rays, flux / static_cast<double>(options.rays), unit, flux, unit,
                    cost(record_run(start_s))));
}

void add_export_options(CLI::App& sub, ExportCommand& c) {
    constexpr double kFar_mm = 1e6;
    sub.add_option("luminaire", c.input, "luminaire or light field, .exr")
        ->required()
        ->type_name("FILE");
    sub.add_option("-o,--output", c.output,
                   "ray file to write: .tm25ray, .dat or .txt (Zemax), .ray (LightTools)")
        ->required()
        ->type_name("FILE");
    std::vector<std::pair<std::string, std::optional<rays::RayFormat>>> formats;
    for (const auto& [name, format] : rays::ray_format_names())
        formats.emplace_back(name, format);
    add_choice(sub, "--format", c.format, formats, "format, where the suffix does not say it");
    add_number(sub, "--rays", c.options.rays, std::uint64_t{1}, std::uint64_t{1'000'000'000'000},
               "N", "rays, of equal flux");
    add_choice(sub, "--start", c.options.start,
               {{"s", rays::RayStart::S}, {"u", rays::RayStart::U}},
               "plane of its slab on which a ray starts");
    add_number(sub, "--sphere-mm", c.sphere_mm, 1e-3, kFar_mm, "MM",
               "start on a sphere of this radius around the luminaire's origin instead");
    add_choice(sub, "--axis", c.options.axis,
               {{"+x", rays::LightAxis::PlusX},
                {"-x", rays::LightAxis::MinusX},
                {"+y", rays::LightAxis::PlusY},
                {"-y", rays::LightAxis::MinusY},
                {"+z", rays::LightAxis::PlusZ},
                {"-z", rays::LightAxis::MinusZ}},
               "the file's axis along which the light goes");
    sub.add_option("--origin-mm", c.origin_mm, "the luminaire's origin in the file's coordinates")
        ->expected(3)
        ->type_name("X Y Z");
    sub.add_flag_callback(
        "--no-color", [&c] { c.options.has_color = false; },
        "no tristimulus values even if the light field has color");
    add_seed(sub, c.options.seed, "of the rays");
}

}  // namespace

void add_export(CLI::App& app) {
    auto c = std::make_shared<ExportCommand>();
    CLI::App* sub =
        add_command(app, "export", "Makes a ray file from a light field or luminaire",
                    {"nearfield export lamp.luminaire.exr -o lamp.tm25ray",
                     "nearfield export lamp.luminaire.exr -o lamp.dat --rays 5000000 --start u"});
    add_export_options(*sub, *c);
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
