// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/farfield_page.h"
#include "app/options.h"
#include "app/output.h"
#include "formats/files/atomic_file.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace nearfield::app {
namespace {

struct FarfieldCommand {
    std::string input, page, csv, png;
    farfield::NearFarOptions options;
};

void run(const FarfieldCommand& command) {
    const double start_s = now_s();
    check_outputs({command.page, command.csv, command.png}, {command.input});
    const LightField lightfield = read_lightfield(command.input);
    const farfield::NearFarMap map = farfield::near_far_map(lightfield, command.options);
    const std::string stand_in = "a point";
    print(farfield_text(map, stand_in));
    if (!command.csv.empty())
        write_file(farfield_csv(map, lightfield.quantity), command.csv);
    if (!command.page.empty())
        write_page(
            farfield_page(map, lightfield.quantity,
                          std::filesystem::path(command.input).filename().string(), stand_in),
            command.page);
    if (!command.png.empty()) {
        constexpr std::size_t kFivePercent = 1;
        const auto image = draw(distance_map(map, kFivePercent, stand_in), "");
        if (!image)
            throw Error{"cannot draw the map", command.png, "gnuplot", "none"};
        write_file(image->bytes, command.png);
    }
    say(fmt::format("{} x {} directions; {}\n", map.size, map.size, cost(record_run(start_s))));
}

}  // namespace

void add_farfield(CLI::App& app) {
    auto c = std::make_shared<FarfieldCommand>();
    CLI::App* sub = add_command(
        app, "farfield", "Intensity from afar, and from which distance on the lamp is a point",
        {"nearfield farfield led.luminaire.exr",
         "nearfield farfield led.luminaire.exr --report farfield.html --csv farfield.csv"});
    sub->add_option("luminaire", c->input, "luminaire or light field, .exr")
        ->required()
        ->type_name("FILE");
    sub->add_option("--report", c->page, "page with maps of the distances for 1, 5 and 10 %, .html")
        ->type_name("FILE");
    sub->add_option("--png", c->png, "the map for 5 % alone")->type_name("FILE");
    sub->add_option("--csv", c->csv, "a row a direction: intensity with sigma, and the distances")
        ->type_name("FILE");
    add_number(*sub, "--size", c->options.size, 3, 501, "N", "directions along x and along y, odd");
    add_number(*sub, "--half-angle-deg", c->options.half_angle_deg, 0.1, 85.0, "DEG",
               "directions to both sides of +z; by default what holds 99 % of the light");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
