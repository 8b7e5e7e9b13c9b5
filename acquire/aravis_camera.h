// SPDX-License-Identifier: Apache-2.0
/// GenICam cameras through Aravis: GigE Vision, USB3 Vision.
#pragma once

#include "acquire/session.h"

#include <string>
#include <vector>

namespace nearfield::acquire {

struct FoundCamera {
    std::string id;        // opens it, for good
    std::string protocol;  // "GigEVision", "USB3Vision"
    std::string vendor, model, serial, address;
};

/// The cameras that answer. Takes up to a second on a network.
std::vector<FoundCamera> find_cameras();

/// Opens a camera with control over it: by its id, address or serial; empty: the only one found.
/// Stops what a program that died may have left running. The bench's stage is the camera's own
/// features (LabFilterX ...) where it has them, else none.
///
/// Throws  Error where none is found, several are and none is named, or somebody else controls it.
Bench open_aravis(const std::string& device);

}  // namespace nearfield::acquire
