// SPDX-License-Identifier: Apache-2.0
#include "acquire/import_photos.h"
#include "app/capture_run.h"
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/options.h"
#include "app/progress.h"
#include "formats/capture/capture.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace nearfield::app {
namespace {

std::string summary(const CaptureOptions& options, const acquire::SessionResult& result) {
    std::string text =
        fmt::format("{}: {} frames, {:.1f} MB in {:.1f} s: {:.1f} frames/s, {:.1f} MB/s",
                    options.folder, result.frames, result.megabytes, result.time_s,
                    result.frames / std::max(result.time_s, 1e-9),
                    result.megabytes / std::max(result.time_s, 1e-9));
    text +=
        fmt::format("; {} taken again, {} times reconnected", result.retaken, result.reconnects);
    if (result.discarded_frames > 0)
        text += fmt::format("; camera {} frames late, which were dropped", result.discarded_frames);
    text += fmt::format(
        "\nexposures: {} true ratios, worst {:.2f} % off; {:.2f} % of the pixels that "
        "matter well exposed twice; lamp drift up to {:.2f} %\n",
        result.ratios, 100 * result.worst_ratio_rel, 100 * result.share_exposed_twice,
        100 * result.worst_drift_rel);
    return text;
}

void import_folder(const CaptureOptions& options) {
    const double start_s = now_s();
    ProgressLine line("import");
    acquire::ImportOptions import;
    if (!options.board.empty())
        import.board = capture::board_from_text(options.board, "--board");
    const acquire::ImportResult result =
        acquire::import_photos(options.photo_folder, options.folder, import,
                               [&line](double fraction) { line.update(fraction); });
    line.finish();
    for (const std::string& remark : result.remarks)
        say(remark + "\n");
    say(fmt::format("{}: {} photographs, {}; {}\n", options.folder, result.photographs,
                    result.is_bracket ? "a bracket of exposures" : "views of a target",
                    cost(record_run(start_s))));
}

void run(const CaptureOptions& options) {
    const double start_s = now_s();
    const Interrupt interrupt(
        "\nnearfield: stopped while a device did not answer; go on with --resume\n");
    try {
        const acquire::SessionResult result = run_capture(options);
        say(summary(options, result) + fmt::format("{}\n", cost(record_run(start_s))));
    } catch (const acquire::Stopped&) {
        const bool has_capture = capture::holds_capture(options.folder);
        say(has_capture
                ? fmt::format("\nstopped; {} frames are on disk; go on with\n  nearfield capture "
                              "-o {} --resume\n",
                              capture::read_capture(options.folder).frames.size(), options.folder)
                : std::string("\nstopped before anything was taken\n"));
        throw CLI::RuntimeError(kExitInterrupted);
    }
}

}  // namespace

void add_capture(CLI::App& app) {
    auto c = std::make_shared<CaptureOptions>();
    CLI::App* sub =
        add_command(app, "capture", "Takes all frames that a measurement needs, and loses none",
                    {"nearfield capture plan.json -o headlight_capture",
                     "nearfield capture -o headlight_capture --resume"});
    auto* plan =
        sub->add_option("plan", c->plan, "what to take (docs/capture.md); not needed with --resume")
            ->type_name("PLAN.json");
    sub->add_option("-o,--output", c->folder, "folder to make, or to go on with")
        ->required()
        ->type_name("FOLDER");
    auto* resume = sub->add_flag("--resume", c->resume,
                                 "go on where a capture stopped, and take damaged frames again");
    add_number(*sub, "--reconnect-s", c->reconnect_s, 0.0, 86400.0, "S",
               "how long a camera that is gone is tried again");
    auto* photographs =
        sub->add_option(
               "--import", c->photo_folder,
               "make the capture of a folder of photographs: a bracket, or views of a target")
            ->type_name("FOLDER");
    sub->add_option("--board", c->board,
                    "the board that the photographs show: charuco:8x6:0.03:0.0225:4x4_50 (squares, "
                    "side of square and marker in m, dictionary) or chessboard:10x7:0.025")
        ->type_name("BOARD")
        ->needs(photographs);
    plan->excludes(photographs);
    resume->excludes(photographs);
    sub->callback([c, plan, resume, photographs] {
        if (!photographs->empty())
            return import_folder(*c);
        if (plan->empty() && resume->empty())
            throw CLI::ValidationError("a plan is needed, or --resume, or --import");
        run(*c);
    });
}

}  // namespace nearfield::app
