// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/describe.h"
#include "formats/files/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace nearfield::app {
namespace {

struct InfoCommand {
    std::string input;
    bool verify = false, json = false;
};

void print(const InfoCommand& command, const nlohmann::ordered_json& description) {
    fmt::print("{}", command.json ? description.dump(2) + "\n" : as_text(description));
}

void explain_luminaire(const InfoCommand& command, const FileKind& kind) {
    std::optional<model::TableCheck> check;
    Luminaire luminaire;
    if (command.verify && kind.kind == "luminaire") {
        luminaire = read_luminaire(command.input);
        check = model::verify_tables(luminaire);
    } else {
        luminaire.lightfield = read_lightfield(command.input);
    }
    print(command, describe(luminaire.lightfield, kind, check));
    if (check && check->different > 0)
        throw CLI::RuntimeError(3);
}

void run(const InfoCommand& command) {
    if (holds_luminaire(command.input))
        explain_luminaire(command, read_kind(command.input));
    else
        print(command, describe(read_picture(command.input)));
}

}  // namespace

void add_info(CLI::App& app) {
    auto c = std::make_shared<InfoCommand>();
    CLI::App* sub = app.add_subcommand("info", "Explains a file that this program writes");
    sub->add_option("file", c->input, "light field, luminaire or picture (.exr)")->required();
    sub->add_flag("--verify", c->verify,
                  "check every stored table against the coefficients; exit 3 if one differs");
    sub->add_flag("--json", c->json, "for machines");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
