// SPDX-License-Identifier: Apache-2.0
#include "acquire/stage.h"

#include <fmt/format.h>

#include <utility>

namespace nearfield::acquire {
namespace {

// What a person must do for a shot, in words; equal words need nothing to be done.
std::string request_for(const capture::Shot& shot) {
    switch (shot.kind) {
        case capture::ShotKind::Target:
            return fmt::format("place the target for view {}", shot.view + 1);
        case capture::ShotKind::Flat:
            return "light the screen evenly";
        case capture::ShotKind::Dark:
            return "darken the lamp, leave the room as it is";
        case capture::ShotKind::Light:
        case capture::ShotKind::Reference:
            return fmt::format("lamp on, filter to column {}, row {}", shot.position.x,
                               shot.position.y);
    }
    return {};
}

class ManualStage : public Stage {
  public:
    explicit ManualStage(Ask ask) : ask_(std::move(ask)) {}

    void arrange(const capture::Shot& shot, const ShouldStop& should_stop) override {
        const std::string request = request_for(shot);
        if (request == done_)
            return;
        ask_(request, should_stop);
        done_ = request;
    }

    std::optional<double> reading_lx() override { return std::nullopt; }

  private:
    Ask ask_;
    std::string done_;
};

}  // namespace

std::unique_ptr<Stage> manual_stage(Ask ask) {
    return std::make_unique<ManualStage>(std::move(ask));
}

}  // namespace nearfield::acquire
