// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "acquire/aravis_device.h"
#include "acquire/stage.h"

#include <memory>

namespace nearfield::acquire {

/// The stage of a camera that moves its own bench, as the virtual one does, by the features
/// LabSubject, LabFilterX, LabFilterY, LabTargetView, LabLampOn, LabPhotometer; null where the
/// camera has no such features.
std::unique_ptr<Stage> camera_stage(std::shared_ptr<Device> device);

}  // namespace nearfield::acquire
