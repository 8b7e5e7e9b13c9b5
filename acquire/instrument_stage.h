// SPDX-License-Identifier: Apache-2.0
/// A bench whose filter, lamp and light meter are instruments.
#pragma once

#include "acquire/stage.h"

#include <memory>

namespace nearfield::acquire {

/// Opens the plan's instruments. What none of them does (targets, screen, flat field; what is left
/// of filter and lamp) is `hands`' work: a person or the camera's own features.
/// Throws  Error, DeviceLost, Stopped as the instruments do; the stage homes.
std::unique_ptr<Stage> instrument_stage(const capture::Plan& plan,
                                        std::unique_ptr<Stage> hands,
                                        const ShouldStop& should_stop);

}  // namespace nearfield::acquire
