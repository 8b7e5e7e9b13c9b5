// SPDX-License-Identifier: Apache-2.0
#include "acquire/settings.h"
#include "acquire/whole_frame.h"
#include "app/capture_run.h"
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/options.h"
#include "app/output.h"
#include "formats/files/image.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <memory>

namespace nearfield::app {
namespace {

struct PreviewCommand {
    capture::CameraPlan camera;
    double exposure_us = 10000;
    std::string output;
};

// Square root of the share of the range: noise of light is then equally visible everywhere, and the
// darks are seen.
std::vector<unsigned char> as_rgb(const capture::Frame& frame) {
    std::vector<unsigned char> rgb;
    rgb.reserve(frame.values.size() * 3);
    for (const std::uint16_t value : frame.values) {
        const bool is_saturated = value >= frame.range_dn();
        const auto shade = static_cast<unsigned char>(
            std::lround(255 * std::sqrt(static_cast<double>(value) / frame.range_dn())));
        rgb.push_back(is_saturated ? 255 : shade);
        rgb.push_back(is_saturated ? 0 : shade);
        rgb.push_back(is_saturated ? 0 : shade);
    }
    return rgb;
}

void run(const PreviewCommand& command) {
    const Interrupt interrupt("\nnearfield: stopped while the camera did not answer\n");
    acquire::Bench bench;
    double exposure_us = 0;
    acquire::Exposed exposed;
    try {
        bench = until_free([&] { return open_device(command.camera.device); }, patience_aloud());
        until_free([&] { bench.camera->configure(command.camera); }, patience_aloud());
        exposure_us = acquire::set_exposure_checked(*bench.camera, command.exposure_us);
        expose_whole(*bench.camera, Interrupt::requested);  // may still have the exposure of before
        exposed = expose_whole(*bench.camera, Interrupt::requested);
    } catch (const acquire::Stopped&) {
        throw CLI::RuntimeError(kExitInterrupted);
    }
    const capture::FrameLevels levels = levels_of(exposed.frame);
    const acquire::CameraIdentity identity = bench.camera->identity();
    if (!command.output.empty())
        write_png(as_rgb(exposed.frame), exposed.frame.size_px, command.output);
    print(
        fmt::format("{} {} {}: {} x {} {}, {:g} us, {:g} dB\n{} ... {} DN of {}, mean {:.1f}, "
                    "{:.3f} % saturated\n",
                    identity.vendor, identity.model, identity.serial, exposed.frame.size_px.x,
                    exposed.frame.size_px.y, exposed.pixel_format, exposure_us,
                    bench.camera->gain_db(), levels.least_dn, levels.most_dn,
                    exposed.frame.range_dn(), levels.mean_dn, 100 * levels.share_saturated));
}

}  // namespace

void add_preview(CLI::App& app) {
    auto c = std::make_shared<PreviewCommand>();
    CLI::App* sub =
        add_command(app, "preview", "Takes one frame with a camera and says what is in it",
                    {"nearfield preview 127.0.0.1 --exposure-us 2000 -o preview.png"});
    sub->add_option("camera", c->camera.device,
                    "address, serial or id (nearfield devices), /dev/videoN, or bench:FILE.json; "
                    "default: the only one")
        ->type_name("CAMERA");
    add_number(*sub, "--exposure-us", c->exposure_us, 0.1, 600e6, "US", "exposure");
    add_number(*sub, "--gain-db", c->camera.gain_db, -60.0, 60.0, "DB", "gain");
    sub->add_option("--pixel-format", c->camera.pixel_format, "Mono8, Mono12, BayerRG12 ...")
        ->capture_default_str()
        ->type_name("NAME");
    sub->add_option("-o,--output", c->output,
                    "picture: square root of the range, saturated pixels red")
        ->type_name("FILE.png");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
