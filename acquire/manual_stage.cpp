// SPDX-License-Identifier: Apache-2.0
#include "acquire/stage.h"

#include <fmt/format.h>

#include <utility>

namespace nearfield::acquire {
namespace {

std::string target_request(int view, capture::TargetPlane plane) {
    switch (plane) {
        case capture::TargetPlane::Screen:
            return fmt::format("lay the target flat on the screen for view {}", view + 1);
        case capture::TargetPlane::Filter:
            return fmt::format(
                "take the screen away, lay the target flat on the filter's plane for view {}",
                view + 1);
        case capture::TargetPlane::Free:
            break;
    }
    return fmt::format("hold the target before the camera for view {}", view + 1);
}

// What a person must do for a shot, in words; equal words need nothing to be done.
std::string request_for(const capture::Shot& shot, const std::vector<capture::TargetPlane>& views) {
    switch (shot.kind) {
        case capture::ShotKind::Target:
            return target_request(shot.view, views.at(static_cast<std::size_t>(shot.view)));
        case capture::ShotKind::Flat:
            return "put an evenly bright surface before the lens";
        case capture::ShotKind::Filter:
            if (shot.position.x < 0)  // an instrument moves it
                return "take the screen away, put an evenly bright surface behind the filter";
            return fmt::format(
                "take the screen away, put an evenly bright surface behind the filter, filter to "
                "column {}, row {}",
                shot.position.x, shot.position.y);
        case capture::ShotKind::Dark:
            return "screen in its place, darken the lamp, leave the room as it is";
        case capture::ShotKind::Blocked:
            return "lamp on, an opaque plate instead of the filter";
        case capture::ShotKind::Light:
        case capture::ShotKind::Reference:
            if (shot.position.x < 0)
                return "screen in its place, lamp in its place";
            return fmt::format("lamp on, filter to column {}, row {}", shot.position.x,
                               shot.position.y);
    }
    return {};
}

class ManualStage : public Stage {
  public:
    ManualStage(Ask ask, std::vector<capture::TargetPlane> views)
        : ask_(std::move(ask)), views_(std::move(views)) {}

    void arrange(const capture::Shot& shot, const ShouldStop& should_stop) override {
        const std::string request = request_for(shot, views_);
        if (request == done_)
            return;
        ask_(request, should_stop);
        done_ = request;
    }

  private:
    Ask ask_;
    std::vector<capture::TargetPlane> views_;
    std::string done_;
};

}  // namespace

std::unique_ptr<Stage> manual_stage(Ask ask, std::vector<capture::TargetPlane> views) {
    return std::make_unique<ManualStage>(std::move(ask), std::move(views));
}

}  // namespace nearfield::acquire
