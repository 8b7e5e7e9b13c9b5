// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/lab_camera.h"
#include "app/lab_devices.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "sample_data/bench/bench.h"
#include "sample_data/gige/camera.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <chrono>
#include <limits>
#include <memory>
#include <thread>

namespace nearfield::app {
namespace {

struct ServeCommand {
    std::string bench;
    gige::CameraOptions options;
};

std::string summary(const gige::Statistics& seen) {
    const double mb = static_cast<double>(seen.bytes) / 1e6;
    return fmt::format(
        "{} frames, {:.1f} MB, {:.1f} MB/s while sending; {} packets, {} dropped on purpose, {} "
        "sent "
        "again, {} asked for too late; {} frames later than exposure and readout; {} commands, {} "
        "refused, {} malformed\n",
        seen.frames, mb, seen.sending_s > 0 ? mb / seen.sending_s : 0, seen.packets,
        seen.dropped_packets, seen.resent_packets, seen.unavailable_packets, seen.late_frames,
        seen.commands, seen.refused_commands, seen.malformed_commands);
}

sample_data::Prepared prepare(const std::string& path) {
    ProgressLine progress("prepare");
    return sample_data::prepare(sample_data::read_bench(path),
                                [&](double fraction) { progress.update(fraction); });
}

void run(const ServeCommand& command) {
    const gige::CameraOptions& options = command.options;
    gige::check_address(options);  // before the bench's preparation, which takes a while
    if (!options.address.starts_with("127."))
        say(
            fmt::format("warning: {} can be reached from the network, and whoever reaches it "
                        "controls the camera: there is no password\n",
                        options.address));
    const gige::Lab lab = lab_of(prepare(command.bench));
    const Interrupt interrupt("lab: ended in the middle of a frame\n");
    const gige::Camera camera(options, lab);
    say(fmt::format("lab: camera {} ({} x {} pixels) at {}:{}, Ctrl-C ends it\n", options.serial,
                    lab.sensor_px.x, lab.sensor_px.y, options.address, camera.port()));
    while (camera.running() && !Interrupt::requested())
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    print(summary(camera.statistics()));
    camera.check();
}

void add_faults(CLI::App& sub, gige::Faults& faults) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    add_number(sub, "--drop", faults.drop_share, 0.0, 1.0, "SHARE",
               "fault: share of data packets that are not sent the first time");
    add_seed(sub, faults.seed, "of what --drop drops");
    add_number(sub, "--stall-after", faults.stall_after, std::uint64_t{0}, kMost, "N",
               "fault: no more frames after N, 0: none of it");
    add_number(sub, "--die-after", faults.die_after, std::uint64_t{0}, kMost, "N",
               "fault: ends in the middle of the frame after N, 0: none of it");
    add_number(sub, "--clamp-exposure-us", faults.clamp_exposure_us, 0.0, 1e7, "US",
               "fault: longest exposure applied, whatever is set and read back, 0: none of it");
    sub.add_flag("--ignore-exposure", faults.ignore_exposure,
                 "fault: applies the first exposure time for ever");
    sub.add_flag("--no-resend", faults.no_resend, "fault: lost packets stay lost");
}

void add_serve(CLI::App& lab) {
    auto c = std::make_shared<ServeCommand>();
    CLI::App* sub =
        add_command(lab, "serve", "Is a GigE Vision camera in front of a virtual bench",
                    {"nearfield lab serve bench_near.json --fast",
                     "nearfield lab serve bench_near.json --address 127.0.0.2 --drop 0.02"});
    sub->add_option("bench", c->bench, "the bench, .json (docs/virtual_bench.md)")
        ->required()
        ->type_name("BENCH");
    gige::CameraOptions& options = c->options;
    sub->add_option("--address", options.address,
                    "where it listens; other than 127.x.x.x it can be reached from outside")
        ->type_name("IPV4")
        ->default_str(options.address);
    add_number(*sub, "--port", options.port, std::uint16_t{0}, std::uint16_t{65535}, "N",
               "of the control protocol; most clients know 3956 alone, 0: any");
    sub->add_option("--serial", options.serial, "serial number, 15 characters at most")
        ->type_name("TEXT")
        ->default_str(options.serial);
    sub->add_flag("--fast", options.fast, "exposures take no time; the lab's time goes on as if");
    add_number(*sub, "--readout-us", options.readout_us, 0.0, 1e7, "US",
               "from an exposure's end to the first packet");
    add_number(*sub, "--exposure-latency", options.exposure_latency_frames, 0, 1000, "N",
               "frames until exposure and gain take effect");
    add_number(*sub, "--link-mbit-s", options.link_mbit_s, 0.0, 1e6, "MBIT",
               "pace of the stream a second, 0: none");
    add_faults(*sub, options.faults);
    sub->callback([c] { run(*c); });
}

struct DevicesCommand {
    std::string bench;
    bool fast = false;
    std::vector<std::string> command;
};

void add_devices_among(CLI::App& lab) {
    auto c = std::make_shared<DevicesCommand>();
    CLI::App* sub = add_command(
        lab, "devices", "Runs a command among simulated cameras and instruments before a bench",
        {"nearfield lab devices bench_near.json --fast -- nearfield devices",
         "nearfield lab devices bench_near.json -- v4l2-ctl -d /dev/video0 --all"});
    sub->add_option("bench", c->bench, "the bench, .json (docs/virtual_bench.md)")
        ->required()
        ->type_name("BENCH");
    sub->add_flag("--fast", c->fast, "exposures take no time; the lab's time goes on as if");
    sub->add_option("command", c->command,
                    "behind --: the program and its arguments; it sees /dev/video0, a USB3 Vision "
                    "camera, a luxmeter, a supply and the stage /dev/ttyUSB0 (docs/bench.md)")
        ->required()
        ->type_name("COMMAND");
    sub->callback([c] {
        const int code = run_among_devices(prepare(c->bench), c->fast, c->command);
        if (code != 0)
            throw CLI::RuntimeError(code);
    });
}

struct TruthCommand {
    std::string bench, output;
};

void add_truth(CLI::App& lab) {
    auto c = std::make_shared<TruthCommand>();
    CLI::App* sub =
        add_command(lab, "truth",
                    "Writes what a virtual bench really is: to compare a measurement's result with",
                    {"nearfield lab truth bench_near.json -o bench_near.truth.json"});
    sub->add_option("bench", c->bench, "the bench, .json")->required()->type_name("BENCH");
    sub->add_option(
           "-o,--output", c->output,
           "random errors as drawn, fluxes, the optics' estimated error; no stage reads it")
        ->required()
        ->type_name("FILE.json");
    sub->callback([c] {
        check_outputs({c->output}, {c->bench});
        sample_data::write_truth(*prepare(c->bench), c->output);
    });
}

}  // namespace

void add_lab(CLI::App& app) {
    CLI::App* sub = add_command(
        app, "lab", "Simulates the laboratory: a camera on the network, or devices of this machine",
        {"nearfield lab serve bench_near.json",
         "nearfield lab devices bench_near.json -- nearfield devices",
         "nearfield lab truth bench_near.json -o bench_near.truth.json"});
    sub->require_subcommand(1);
    add_serve(*sub);
    add_devices_among(*sub);
    add_truth(*sub);
}

}  // namespace nearfield::app
