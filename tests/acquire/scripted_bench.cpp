// SPDX-License-Identifier: Apache-2.0
#include "tests/acquire/scripted_bench.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace nearfield::acquire {
namespace {

/// What stands before the camera.
struct Lab {
    capture::Shot shot;
};

// Light falls off over the frame and with the filter's distance from the middle; noise is a hash of
// pixel and frame.
capture::Frame look(const capture::Shot& shot, double exposure_us, double light, int frame_number) {
    capture::Frame frame;
    frame.size_px = {32, 32};
    frame.bits = 12;
    const bool is_dark = shot.kind == capture::ShotKind::Dark;
    const bool is_even = shot.kind == capture::ShotKind::Filter;
    const double place = shot.position.x < 0 ? 1 : 1.0 / (1 + shot.position.x + shot.position.y);
    for (unsigned k = 0; k < 32 * 32; ++k) {
        const double signal =
            is_dark   ? 0
            : is_even ? exposure_us
                      : light * place * exposure_us * 3 * std::exp(-static_cast<double>(k) / 200);
        const unsigned noise =
            (k + static_cast<unsigned>(frame_number) * 1024U) * 2654435761U >> 17U & 3U;
        frame.values.push_back(static_cast<std::uint16_t>(std::min(64.0 + signal + noise, 4095.0)));
    }
    return frame;
}

class ScriptedCamera : public Camera {
  public:
    ScriptedCamera(Script& script, std::shared_ptr<Lab> lab)
        : script_(script), lab_(std::move(lab)) {}

    CameraIdentity identity() const override { return {"test", "scripted", "1", "here"}; }
    void configure(const capture::CameraPlan& /*plan*/) override {}
    double gain_db() override { return 0; }
    std::optional<double> temperature_c() override { return 30; }

    double set_exposure(double exposure_us) override {
        const double read_us = std::min(exposure_us, script_.clamps_at_us);
        const bool is_first = coming_us_.empty();
        for (int k = 0; k < (is_first ? 0 : script_.late_frames); ++k)
            coming_us_.push_back(coming_us_.back());
        if (is_first || !script_.ignores_exposure)
            coming_us_.push_back(read_us);
        return read_us;
    }

    Exposed expose(const ShouldStop& should_stop) override {
        ++script_.frames;
        if (should_stop())
            throw Stopped{};
        if (script_.frames == script_.lost_at)
            throw DeviceLost{"gone", "scripted", "", ""};
        if (script_.frames == script_.stale_at)
            return last_;
        if (coming_us_.size() > 1)
            coming_us_.pop_front();
        if (script_.frames >= script_.incomplete_at &&
            script_.frames < script_.incomplete_at + script_.incomplete_frames)
            throw IncompleteFrame{"incomplete", "scripted", "", ""};
        double exposure_us = coming_us_.front();
        if (exposure_us > 1000)
            exposure_us *= script_.true_ratio;
        const double light =
            1 + script_.drift_per_frame * std::max(0, script_.frames - script_.drifts_from);
        last_ = {look(lab_->shot, exposure_us, light, script_.frames), "Mono12", 0, 0};
        return last_;
    }

  private:
    Script& script_;
    std::shared_ptr<Lab> lab_;
    std::deque<double> coming_us_;  // of the last frame and the next ones; the last stays
    Exposed last_;
};

class ScriptedStage : public Stage {
  public:
    ScriptedStage(Script& script, std::shared_ptr<Lab> lab)
        : script_(script), lab_(std::move(lab)) {}

    void arrange(const capture::Shot& shot, const ShouldStop& /*should_stop*/) override {
        if (script_.stalled_at > 0 && script_.frames >= script_.stalled_at)
            throw Error{"the stage is stalled", "scripted", "", ""};
        lab_->shot = shot;
    }

  private:
    Script& script_;
    std::shared_ptr<Lab> lab_;
};

}  // namespace

Bench open_scripted(Script& script) {
    ++script.opened;
    if (script.opened > 1 && script.tries_to_come_back-- > 0)
        throw Error{"cannot open camera", "scripted", "", ""};
    const auto lab = std::make_shared<Lab>();
    return {std::make_unique<ScriptedCamera>(script, lab),
            std::make_unique<ScriptedStage>(script, lab)};
}

}  // namespace nearfield::acquire
