// SPDX-License-Identifier: Apache-2.0
#include "calibrate/board_views.h"

#include "calibrate/pixel_layout.h"
#include "calibrate/targets.h"
#include "formats/files/error.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <mutex>

namespace nearfield::calibrate {
namespace {

std::vector<const capture::FrameRecord*> target_frames(const std::string& folder,
                                                       const capture::Capture& capture) {
    std::vector<const capture::FrameRecord*> frames;
    for (const auto& [number, frame] : capture.frames)
        if (frame.shot.kind == capture::ShotKind::Target)
            frames.push_back(&frame);
    if (frames.empty())
        throw Error{
            "no view of a calibration target", folder,
            "frames of kind target (\"targets\" in the plan, or capture --import with --board)",
            "none"};
    for (const capture::FrameRecord* frame : frames)
        if (frame->size_px != frames.front()->size_px)
            throw Error{"pictures of different sizes", folder + "/" + frame->file,
                        fmt::format("{} x {} px, as {}", frames.front()->size_px.x,
                                    frames.front()->size_px.y, frames.front()->file),
                        fmt::format("{} x {} px", frame->size_px.x, frame->size_px.y)};
    return frames;
}

capture::TargetPlane plane_of(const capture::Plan& plan, int view) {
    const auto index = static_cast<std::size_t>(view);
    return view >= 0 && index < plan.views.size() ? plan.views[index] : capture::TargetPlane::Free;
}

}  // namespace

std::vector<BoardView> board_views(const std::string& folder,
                                   const capture::Capture& capture,
                                   const std::function<void(double fraction)>& progress) {
    if (!capture.header.plan || !capture.header.plan->board)
        throw Error{"the target is not known", folder + "/capture.json",
                    "plan.targets.board: kind, squares, square_m, ... (docs/capture.md)", "none"};
    const capture::Plan& plan = *capture.header.plan;
    const std::vector<const capture::FrameRecord*> frames = target_frames(folder, capture);
    std::vector<BoardView> views(frames.size());
    std::mutex mutex;
    std::size_t done = 0;
    tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t k) {
        const capture::FrameRecord& frame = *frames[k];
        const PixelLayout layout = layout_of(frame);
        views[k] = {frame.shot.view, plane_of(plan, frame.shot.view),
                    frame.source.empty() ? name_of(frame.shot) : frame.source,
                    find_board(read_frame(folder, frame), layout.mosaic, *plan.board)};
        const std::lock_guard lock(mutex);
        ++done;
        if (progress)
            progress(static_cast<double>(done) / static_cast<double>(frames.size()));
    });
    return views;
}

}  // namespace nearfield::calibrate
