// SPDX-License-Identifier: Apache-2.0
#include "app/capture_run.h"

#include "acquire/aravis_camera.h"
#include "acquire/instrument_stage.h"
#include "acquire/v4l2_camera.h"
#include "app/interrupt.h"
#include "app/lab_bench.h"
#include "app/progress.h"
#include "formats/files/error.h"
#include "formats/files/json_field.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace nearfield::app {
namespace {

using capture::Capture;
using capture::CaptureHeader;
using capture::CaptureWriter;
using capture::Plan;

constexpr double kOverhead_s =
    0.03;  // a frame's transfer, register accesses and writing, on a fast wire

bool should_stop() {
    return Interrupt::requested();
}

// Asks a person on the terminal; Enter goes on.
void ask(const std::string& request, const acquire::ShouldStop& stop) {
    say(fmt::format("\n{}, then press Enter\n", request));
    while (true) {
        if (stop())
            throw acquire::Stopped{};
        constexpr int kBetweenLooks_ms = 50;
        pollfd input{STDIN_FILENO, POLLIN, 0};
        if (poll(&input, 1, kBetweenLooks_ms) <= 0)
            continue;
        char character = 0;
        const ssize_t got = read(STDIN_FILENO, &character, 1);
        if (got == 0)
            throw Error{"nobody answers", "standard input", "Enter", "its end"};
        if (got == 1 && character == '\n')
            return;
    }
}

// The plan with its exposures, which are metered where it says so.
Plan complete_plan(const std::string& path) {
    Plan plan = capture::read_plan(path);
    if (!plan.bracket.is_auto)
        return plan;
    acquire::Bench bench = until_free([&plan] { return open_bench(plan); }, patience_aloud());
    until_free([&] { bench.camera->configure(plan.camera); }, patience_aloud());
    plan.bracket.exposures_us = acquire::meter(bench, plan, should_stop);
    say(fmt::format("metered: {} exposures, {:.4g} ... {:.4g} us\n",
                    plan.bracket.exposures_us.size(), plan.bracket.exposures_us.front(),
                    plan.bracket.exposures_us.back()));
    return plan;
}

CaptureHeader header_of(const CaptureOptions& options) {
    CaptureHeader header;
    header.plan = complete_plan(options.plan);
    header.provenance.program = program_version();
    header.provenance.command = "capture";
    header.provenance.options = {{"reconnect_s", fmt::format("{:g}", options.reconnect_s)}};
    header.provenance.inputs = {describe_input(options.plan)};
    return header;
}

bool is_import(const CaptureHeader& header) {
    const auto& options = header.provenance.options;
    return std::any_of(options.begin(), options.end(),
                       [](const auto& option) { return option.first == "import"; });
}

// A capture goes on by its own plan; another one's frames would not fit in.
void check_same_plan(const CaptureOptions& options, const Capture& capture) {
    if (options.plan.empty())
        return;
    const std::string hash = hash_file(options.plan);
    const auto& inputs = capture.header.provenance.inputs;
    if (inputs.empty() || inputs.front().xxh128 != hash)
        throw Error{"cannot resume", options.plan,
                    "the plan that the capture was started with, or none", "another one"};
}

// Frames that are missing or not what was written are taken again.
void reject_damaged(CaptureWriter& writer, const Capture& capture) {
    ProgressLine line("checking frames");
    const std::vector<int> damaged = capture::damaged_frames(
        writer.folder(), capture, [&line](double fraction) { line.update(fraction); });
    line.finish();
    if (damaged.empty())
        return;
    writer.add(capture::RejectRecord{damaged, "missing or damaged on disk"});
    say(fmt::format(
        "{}: {} frames are missing or damaged and will be taken again, the first is shot {}\n",
        writer.folder(), damaged.size(), damaged.front()));
}

CaptureWriter open_writer(const CaptureOptions& options) {
    if (!options.resume)
        return CaptureWriter::create(options.folder, header_of(options));
    const Capture capture = capture::read_capture(options.folder);
    if (is_import(capture.header))
        throw Error{"nothing to take", options.folder, "a capture from a plan",
                    "imported photographs"};
    check_same_plan(options, capture);
    CaptureWriter writer = CaptureWriter::reopen(options.folder);
    reject_damaged(writer, capture::read_capture(options.folder));
    return writer;
}

}  // namespace

acquire::Bench open_device(const std::string& device) {
    constexpr std::string_view kBench = "bench:";
    if (device.starts_with(kBench))
        return open_lab_bench(device.substr(kBench.size()));
    return device.starts_with("/dev/") ? acquire::open_v4l2(device) : acquire::open_aravis(device);
}

acquire::Patience patience_aloud() {
    return {acquire::kBusyPatience_s, should_stop,
            [](const std::string& remark) { say("device busy: " + remark + "\n"); }};
}

acquire::Bench open_bench(const Plan& plan) {
    acquire::Bench bench = open_device(plan.camera.device);
    if (plan.stage == capture::StageKind::Manual)
        bench.stage = acquire::manual_stage(ask, plan.views);
    if (!bench.stage)
        throw Error{"no stage", "the plan's stage 'camera'",
                    "a camera that moves its bench (LabSubject ...)",
                    bench.camera->identity().model};
    if (!plan.instruments.empty())
        bench.stage = acquire::instrument_stage(plan, std::move(bench.stage), should_stop);
    return bench;
}

acquire::SessionResult run_capture(const CaptureOptions& options) {
    CaptureWriter writer = open_writer(options);
    const Capture capture = capture::read_capture(options.folder);
    const std::vector<capture::Shot> missing = capture::missing_shots(capture);
    say(fmt::format("{}: {} of {} frames to take, about {:.0f} s\n", options.folder, missing.size(),
                    missing.size() + capture.frames.size(),
                    capture::estimate_time_s(*capture.header.plan, missing, kOverhead_s)));
    ProgressLine line("capture");
    acquire::SessionOptions session;
    session.open = [&plan = *capture.header.plan] { return open_bench(plan); };
    session.should_stop = should_stop;
    session.reconnect_s = options.reconnect_s;
    session.progress = [&line](double fraction, const std::string& state) {
        line.update(fraction, state);
    };
    session.say = [&line](const std::string& remark) {
        line.finish();
        say(remark + "\n");
    };
    return acquire::run_session(writer, capture, session);
}

}  // namespace nearfield::app
