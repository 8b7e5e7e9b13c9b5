// SPDX-License-Identifier: Apache-2.0
/// Finds USBTMC instruments among all USB devices, and opens the one that is meant.
#pragma once

#include "acquire/usb_handles.h"

#include <string>

namespace nearfield::acquire {

/// Where an instrument's messages go and come from.
struct UsbtmcEndpoints {
    std::uint8_t interface = 0, in = 0, out = 0;
};

struct OpenInstrument {
    UsbHandle handle;  // its interface is ours
    UsbtmcEndpoints endpoints;
};

/// By serial number or vendor:product. Throws as Usbtmc's constructor.
OpenInstrument open_instrument(libusb_context* context, const std::string& device);

}  // namespace nearfield::acquire
