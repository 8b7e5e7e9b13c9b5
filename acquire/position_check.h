// SPDX-License-Identifier: Apache-2.0
/// Follows the frames of a session and judges each position's bracket and the lamp.
#pragma once

#include "acquire/checks.h"
#include "formats/capture/capture.h"
#include "formats/files/error.h"

#include <map>
#include <optional>
#include <vector>

namespace nearfield::acquire {

/// What is wrong, and the shots that it makes doubtful.
struct Finding {
    Error error;
    std::vector<int> doubtful_shots;
};

/// What was seen so far in a session.
struct CheckFigures {
    ExposureTally exposures;  // of all complete brackets
    double worst_ratio_rel = 0;
    int ratios = 0;
    double worst_drift_rel = 0;
};

/// Keeps the frames of one position, means of darks, and the lamp's level at the reference.
class PositionCheck {
  public:
    /// Levels of darks and the first look at the reference are taken from what the capture already
    /// holds. It must have a plan.
    explicit PositionCheck(const capture::Capture& capture);

    /// A frame in the order of the plan. Judges the position before where this is the next one.
    void add(const capture::Shot& shot, const capture::Frame& frame);
    /// No frame follows.
    void finish();
    /// What add() or finish() found, once.
    std::optional<Finding> judge();

    const CheckFigures& figures() const { return figures_; }

  private:
    struct Kept {
        capture::Shot shot;
        capture::Frame frame;
    };

    void add_level(const capture::Shot& shot, double mean_dn);
    void add_reference(const capture::Shot& shot, double mean_dn);
    void finish_position();
    double black_dn(double exposure_us) const;

    capture::Plan plan_;
    std::map<double, std::pair<double, int>> darks_;  // by exposure: sum of means in DN, count
    std::optional<double> first_reference_dn_;
    std::vector<int> since_reference_;  // light shots since the last good look at the reference
    std::vector<Kept> position_;
    std::optional<Finding> finding_;
    CheckFigures figures_;
};

}  // namespace nearfield::acquire
