// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr int kExitError = 1;
constexpr int kExitUsage = 2;

std::string main_help(const CLI::App& app) {
    return app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
}

// `nearfield help [COMMAND]` is `nearfield [COMMAND] --help`.
void add_help(CLI::App& app) {
    CLI::App* help =
        nearfield::app::add_command(app, "help", "Explains a command", {"nearfield help render"});
    auto* command = help->add_option("command", "one of nearfield's commands");
    help->callback([&app, command] {
        if (command->empty())
            return nearfield::app::print(main_help(app));
        const std::vector<CLI::App*> found = app.get_subcommands([command](const CLI::App* known) {
            return known->get_name() == command->as<std::string>();
        });
        if (found.empty())
            throw CLI::ValidationError(
                nearfield::app::unknown_command(app, command->as<std::string>()));
        nearfield::app::print(found.front()->help(app.get_name()));
    });
}

void add_commands(CLI::App& app) {
    app.set_version_flag("--version", nearfield::program_version());
    app.require_subcommand(1);
    auto formatter = std::make_shared<nearfield::app::HelpFormatter>();
    formatter->column_width(34);
    app.formatter(formatter);
    app.footer(
        "First steps:\n  nearfield demo -o out\n  nearfield help render\n\n"
        "Exit codes: 0 done, 1 error, 2 usage, 3 finished but not good enough (see its report).");
    nearfield::app::add_demo(app);
    nearfield::app::add_simulate(app);
    nearfield::app::add_convert(app);
    nearfield::app::add_export(app);
    nearfield::app::add_pack(app);
    nearfield::app::add_info(app);
    nearfield::app::add_compare(app);
    nearfield::app::add_farfield(app);
    nearfield::app::add_probe(app);
    nearfield::app::add_render(app);
    nearfield::app::add_view(app);
    nearfield::app::add_bench(app);
    nearfield::app::add_devices(app);
    nearfield::app::add_preview(app);
    nearfield::app::add_capture(app);
    nearfield::app::add_calibrate(app);
    nearfield::app::add_fit(app);
    nearfield::app::add_lab(app);
    add_help(app);
}

// Control characters of a damaged file's texts do not reach the terminal.
std::string printable(std::string text) {
    for (char& character : text)
        if (static_cast<unsigned char>(character) < ' ' || character == '\x7F')
            character = ' ';
    return text;
}

void say_error(const std::string& message) {
    nearfield::app::say(fmt::format("nearfield: error: {}\n", printable(message)));
}

// Explains what was asked for (help, version) or what was wrong.
int exit_early(const CLI::App& app, const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
        std::ostringstream text;
        app.exit(error, text, text);
        nearfield::app::print(text.str());
        return 0;
    }
    say_error(nearfield::app::usage_message(app, error));
    const auto called = app.get_subcommands();
    nearfield::app::say(called.empty()
                            ? "Try: nearfield help\n"
                            : fmt::format("Try: nearfield help {}\n", called.front()->get_name()));
    return kExitUsage;
}

int run(int argc, char** argv) {
    CLI::App app{"Measures real lamps as light fields and lights scenes with them, exactly.",
                 "nearfield"};
    add_commands(app);
    if (argc <= 1) {
        nearfield::app::say(main_help(app));
        return kExitUsage;
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::RuntimeError& stop) {
        return stop.get_exit_code();  // a command's own exit code
    } catch (const CLI::ParseError& error) {
        return exit_early(app, error);
    }
    return 0;
}

// A file that is opened while one of the three standard streams is closed would take its number,
// and be written by whatever is said there.
void open_standard_streams() {
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
        if (fcntl(stream, F_GETFD) == -1)
            open("/dev/null", O_RDWR);  // takes the lowest free number, which is this one
}

}  // namespace

int main(int argc, char** argv) {
    open_standard_streams();
    // A reader that goes away (`nearfield info X | head`) does not end us half-way in the work.
    std::signal(SIGPIPE, SIG_IGN);
    try {
        return run(argc, argv);
    } catch (const nearfield::Error& error) {
        say_error(error.what());
    } catch (const std::bad_alloc&) {
        say_error("out of memory");
    } catch (const std::exception& error) {
        say_error(error.what());
    }
    return kExitError;
}
