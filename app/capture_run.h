// SPDX-License-Identifier: Apache-2.0
/// `nearfield capture`: a new capture, or one gone on with.
#pragma once

#include "acquire/session.h"
#include "app/output.h"

#include <string>

namespace nearfield::app {

struct CaptureOptions {
    std::string plan;  // file; may be empty with `resume`: the capture has its own
    std::string folder;
    std::string photo_folder;  // to import instead
    std::string board;         // that the photographs show, as board_from_text reads it; or empty
    bool resume = false;
    double reconnect_s = 60;
};

/// Takes what the plan asks for, with progress and remarks on stderr. Throws as run_session().
acquire::SessionResult run_capture(const CaptureOptions& options);

/// A camera by its id, address or serial, a V4L2 one by its node ("/dev/video0"), or a virtual
/// bench by "bench:FILE.json", with the stage that it has itself.
acquire::Bench open_device(const std::string& device);

/// For acquire::until_free(): says on stderr that it waits for a busy device, and ends by Ctrl-C.
acquire::Patience patience_aloud();

/// The plan's camera, stage and instruments; a manual stage asks on the terminal.
acquire::Bench open_bench(const capture::Plan& plan);

}  // namespace nearfield::app
