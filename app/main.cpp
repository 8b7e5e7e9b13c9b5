// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <csignal>
#include <exception>
#include <new>

namespace {

constexpr int kExitError = 1;
constexpr int kExitUsage = 2;

// `nearfield help [COMMAND]` is `nearfield [COMMAND] --help`.
void add_help(CLI::App& app) {
    CLI::App* help = app.add_subcommand("help", "Explains a command: nearfield help COMMAND");
    auto* command = help->add_option("command", "one of the commands above");
    help->callback([&app, command] {
        const CLI::App* explained =
            command->empty() ? &app : app.get_subcommand(command->as<std::string>());
        fmt::print("{}", explained->help());
    });
}

int run(int argc, char** argv) {
    CLI::App app{"Measures real lamps as light fields and lights scenes with them, exactly.",
                 "nearfield"};
    app.set_version_flag("--version", nearfield::program_version());
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    app.footer(
        "Exit codes: 0 done, 1 error, 2 usage, 3 finished but not good enough (see its report).");
    nearfield::app::add_demo(app);
    nearfield::app::add_simulate(app);
    nearfield::app::add_convert(app);
    nearfield::app::add_pack(app);
    nearfield::app::add_info(app);
    nearfield::app::add_probe(app);
    nearfield::app::add_render(app);
    add_help(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::RuntimeError& stop) {
        return stop.get_exit_code();  // a command's own exit code
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kExitUsage;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    // A reader that goes away (`nearfield info X | head`) ends us by an error, not by a signal
    // half-way in a file.
    std::signal(SIGPIPE, SIG_IGN);
    try {
        return run(argc, argv);
    } catch (const nearfield::Error& error) {
        fmt::print(stderr, "nearfield: error: {}\n", error.what());
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "nearfield: error: out of memory\n");
    } catch (const std::exception& error) {
        fmt::print(stderr, "nearfield: error: {}\n", error.what());
    }
    return kExitError;
}
