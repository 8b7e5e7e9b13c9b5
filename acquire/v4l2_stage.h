// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "acquire/stage.h"
#include "acquire/v4l2_device.h"

#include <memory>

namespace nearfield::acquire {

/// What a virtual bench's camera shows by its controls lab_subject, lab_target_view and lab_shot;
/// null where the camera has none. Filter and lamp are other instruments' work.
std::unique_ptr<Stage> v4l2_stage(std::shared_ptr<V4l2Device> device);

}  // namespace nearfield::acquire
