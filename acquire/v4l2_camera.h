// SPDX-License-Identifier: Apache-2.0
/// Cameras behind Linux' own drivers (V4L2): USB video class, MIPI.
#pragma once

#include "acquire/aravis_camera.h"
#include "acquire/session.h"

#include <string>
#include <vector>

namespace nearfield::acquire {

/// The nodes that stream; those that may not be opened are left out.
std::vector<FoundCamera> find_v4l2_cameras();

/// Opens "/dev/video0". Such cameras run freely: a frame counts where its exposure began after it
/// was asked for, by the driver's time stamps. Exposure is set in steps of 100 us, gain and all
/// else by CameraPlan::controls. The stage is the camera's own controls (lab_subject ...) where it
/// has them, else none.
///
/// Throws  Error where it is no camera, DeviceLost where it is not there, DeviceBusy (mostly not
/// before it is configured) where another program has it.
Bench open_v4l2(const std::string& path);

}  // namespace nearfield::acquire
