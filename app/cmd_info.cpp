// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/describe.h"
#include "app/describe_capture.h"
#include "app/describe_exchange.h"
#include "app/describe_rig.h"
#include "app/options.h"
#include "app/output.h"
#include "formats/files/read_file.h"
#include "formats/photometry/photometric_file.h"
#include "formats/rays/survey.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

namespace nearfield::app {
namespace {

struct InfoCommand {
    std::string input;
    bool verify = false, json = false;
};

void print_description(const InfoCommand& command, const nlohmann::ordered_json& description) {
    print(command.json ? description.dump(2) + "\n" : as_text(description));
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
    print_description(command, describe(luminaire.lightfield, kind, check));
    if (command.verify && (!check || check->values == 0))
        say(fmt::format("{}: nothing to verify: it holds no tables\n", command.input));
    if (check && check->different > 0) {
        say(fmt::format("{}: {} of {} stored values differ from what the coefficients give\n",
                        command.input, check->different, check->values));
        throw CLI::RuntimeError(3);
    }
}

void explain_capture(const InfoCommand& command) {
    const capture::Capture capture = capture::read_capture(command.input);
    std::optional<std::vector<int>> damaged;
    if (command.verify)
        damaged = capture::damaged_frames(command.input, capture, {});
    print(command.json ? describe(capture, damaged).dump(2) + "\n"
                       : capture_text(capture, damaged));
    if (damaged && !damaged->empty())
        throw CLI::RuntimeError(3);
}

// The rig as its file says it; --verify: its maps are its own.
void explain_rig(const InfoCommand& command) {
    const rig::Rig rig = rig::read_rig(command.input);
    if (command.verify && rig.radiometry)
        rig::read_maps(command.input);
    print(command.json ? read_file(command.input) : rig_text(rig));
}

// Whether a file begins as EXR does.
bool is_exr(const std::string& path) {
    std::array<char, 4> magic{};
    std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
    return std::string_view(magic.data(), magic.size()) == "\x76\x2f\x31\x01";
}

void explain_photometry(const InfoCommand& command) {
    const photometry::Photometry lamp = photometry::read_photometry(command.input);
    print(command.json ? describe(lamp).dump(2) + "\n" : photometry_text(lamp));
}

void explain_rays(const InfoCommand& command) {
    const rays::RaySurvey survey = rays::survey_rays(command.input, true);
    print(command.json ? describe(survey).dump(2) + "\n" : rays_text(survey));
}

void run_info(const InfoCommand& command) {
    if (command.input.ends_with(".json"))
        explain_rig(command);
    else if (capture::holds_capture(command.input))
        explain_capture(command);
    else if (photometry::holds_photometry(command.input))
        explain_photometry(command);
    else if (std::filesystem::is_regular_file(command.input) && !is_exr(command.input))
        explain_rays(command);
    else if (holds_luminaire(command.input))
        explain_luminaire(command, read_kind(command.input));
    else
        print_description(command, describe(read_picture(command.input)));
}

}  // namespace

void add_info(CLI::App& app) {
    auto c = std::make_shared<InfoCommand>();
    CLI::App* sub = add_command(app, "info", "Explains a file that this program reads or writes",
                                {"nearfield info headlight.luminaire.exr --verify",
                                 "nearfield info headlight.luminaire.exr --json"});
    sub->add_option("file", c->input,
                    "light field, luminaire or picture, .exr; ray file or photometric file; a rig, "
                    ".json; or a "
                    "capture's folder")
        ->required()
        ->type_name("FILE");
    sub->add_flag(
        "--verify", c->verify,
        "check every stored table against the coefficients, or every frame against its checksum; "
        "exit 3 if one differs");
    sub->add_flag("--json", c->json, "as JSON (docs/formats.md)");
    sub->callback([c] { run_info(*c); });
}

}  // namespace nearfield::app
