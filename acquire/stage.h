// SPDX-License-Identifier: Apache-2.0
/// What stands on the bench while a frame is taken: filter position, lamp, target.
#pragma once

#include "acquire/camera.h"
#include "formats/capture/plan.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::acquire {

/// What instruments say while a frame is taken, as far as there are any.
struct Readings {
    std::optional<double> illuminance_lx;  // of the photometer
    std::optional<double> lamp_voltage_v, lamp_current_a;
    std::optional<glm::dvec2> stage_mm;  // read back
};

/// Moves filter, lamp and targets, and reads the instruments.
class Stage {
  public:
    Stage() = default;
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;
    virtual ~Stage() = default;

    /// Brings the bench to what a shot needs; returns when it is there. Nothing to do is quick.
    /// Throws Error where it cannot (stalled, out of range), DeviceLost, Stopped.
    virtual void arrange(const capture::Shot& shot, const ShouldStop& should_stop) = 0;
    virtual Readings readings() { return {}; }
    /// What people should find in the capture about the instruments: "luxmeter: MAKER,MODEL ...".
    virtual std::vector<std::string> instruments() { return {}; }
};

/// Asks a person. `ask` shows a request and returns when it is done; throws Stopped.
using Ask = std::function<void(const std::string& request, const ShouldStop& should_stop)>;

/// A person moves: asked whenever something other than before must stand on the bench. `views` says
/// where the target is to be (Plan::views).
std::unique_ptr<Stage> manual_stage(Ask ask, std::vector<capture::TargetPlane> views);

}  // namespace nearfield::acquire
