// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/export_photometry.h"
#include "app/export_proxy.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"
#include "formats/rays/export_rays.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>
#include <variant>

namespace nearfield::app {
namespace {

using ExportFormat = std::variant<rays::RayFormat, photometry::FileFormat, ProxyFormat>;

struct ExportCommand {
    std::string input, output;
    std::optional<ExportFormat> format;
    std::optional<double> sphere_mm;
    std::vector<double> origin_mm{0, 0, 0};
    rays::ExportOptions options;
    PhotometryExport photometry;
    ProxyExport proxy;
};

std::vector<std::pair<std::string, std::optional<ExportFormat>>> format_choices() {
    std::vector<std::pair<std::string, std::optional<ExportFormat>>> choices = {
        {"lm63", photometry::FileFormat::Lm63},
        {"eulumdat", photometry::FileFormat::Eulumdat},
        {"tm33", photometry::FileFormat::Tm33},
        {"gltf", ProxyFormat::Gltf},
        {"usd", ProxyFormat::Usd},
        {"mitsuba", ProxyFormat::Mitsuba},
        {"pbrt", ProxyFormat::Pbrt}};
    for (const auto& [name, format] : rays::ray_format_names())
        choices.emplace_back(name, format);
    return choices;
}

ExportFormat format_of(const ExportCommand& command) {
    if (command.format)
        return *command.format;
    if (const auto format = photometry::file_format_of(command.output))
        return *format;
    for (const auto& [suffix, format] : {std::pair{".gltf", ProxyFormat::Gltf},
                                         {".usda", ProxyFormat::Usd},
                                         {".pbrt", ProxyFormat::Pbrt}})
        if (command.output.ends_with(suffix))
            return format;
    return rays::ray_format_of(command.output);
}

void export_ray_file(ExportCommand& command) {
    const double start_s = now_s();
    rays::ExportOptions& options = command.options;
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

void run(ExportCommand& command) {
    std::optional<ExportFormat> format;
    check_options([&] { format = format_of(command); });
    const auto* proxy = std::get_if<ProxyFormat>(&*format);
    const bool has_ies =
        proxy != nullptr && (*proxy == ProxyFormat::Gltf || *proxy == ProxyFormat::Usd);
    if ((proxy == nullptr || has_ies) && !command.proxy.report.empty())
        throw CLI::ValidationError("--report", "is for arrays of projectors (mitsuba, pbrt) alone");
    check_outputs({command.output, has_ies ? ies_beside(command.output) : "", command.proxy.report},
                  {command.input});
    if (proxy != nullptr) {
        command.proxy.format = *proxy;
        export_proxy(command.input, command.output, command.proxy);
    } else if (const auto* file_format = std::get_if<photometry::FileFormat>(&*format)) {
        command.photometry.format = *file_format;
        export_photometry(command.input, command.output, command.photometry);
    } else {
        command.options.format = std::get<rays::RayFormat>(*format);
        export_ray_file(command);
    }
}

void add_export_options(CLI::App& sub, ExportCommand& c) {
    constexpr double kFar_mm = 1e6;
    sub.add_option(
           "luminaire", c.input,
           "luminaire or light field, .exr; or a photometric file, to be written as another")
        ->required()
        ->type_name("FILE");
    sub.add_option(
           "-o,--output", c.output,
           "ray file to write: .tm25ray, .dat or .txt (Zemax), .ray (LightTools); or "
           "photometric file: .ies (LM-63), .ldt (EULUMDAT), .xml (TM-33); or a "
           "scene for other renderers: .gltf, .usda (far field, with an .ies beside), .pbrt "
           "and Mitsuba 3 (projectors)")
        ->required()
        ->type_name("FILE");
    add_choice(sub, "--format", c.format, format_choices(),
               "format, where the suffix does not say it");
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
    add_number(
        sub, "--c-planes", c.photometry.planes, 4, 3600, "N",
        "of photometric files: C planes around, a multiple of 4; by default as many as keep the "
        "flux");
    add_number(sub, "--gamma-steps", c.photometry.quarter_angles, 2, 1800, "N",
               "of photometric files: steps of gamma up to 90 degrees; by default likewise");
    sub.add_option(
           "--report", c.proxy.report,
           "of projectors: page with maps of the distances beyond which they hold 1, 2, 5 %")
        ->type_name("FILE");
}

}  // namespace

void add_export(CLI::App& app) {
    auto c = std::make_shared<ExportCommand>();
    CLI::App* sub = add_command(
        app, "export", "Makes a ray file or photometric file from a light field or luminaire",
        {"nearfield export lamp.luminaire.exr -o lamp.tm25ray",
         "nearfield export lamp.luminaire.exr -o lamp.dat --rays 5000000 --start u",
         "nearfield export lamp.luminaire.exr -o lamp.ies",
         "nearfield export lamp.luminaire.exr -o lamp.gltf",
         "nearfield export lamp.luminaire.exr -o lamp.xml --format mitsuba"});
    add_export_options(*sub, *c);
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
