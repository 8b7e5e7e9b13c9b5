// SPDX-License-Identifier: Apache-2.0
/// The words of a plan's choices, for reading and writing alike.
#pragma once

#include "formats/capture/plan.h"
#include "formats/capture/words.h"

namespace nearfield::capture {

inline constexpr Words<StageKind, 2> kStages{
    {{"manual", StageKind::Manual}, {"camera", StageKind::Camera}}};

inline constexpr Words<TargetPlane, 3> kTargetPlanes{{{"screen", TargetPlane::Screen},
                                                      {"filter", TargetPlane::Filter},
                                                      {"free", TargetPlane::Free}}};

}  // namespace nearfield::capture
