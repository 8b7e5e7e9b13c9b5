// SPDX-License-Identifier: Apache-2.0
/// Owners of libusb's objects, and its errors as ours.
#pragma once

#include "acquire/camera.h"

#include <libusb-1.0/libusb.h>

#include <cstdint>
#include <memory>
#include <string>

namespace nearfield::acquire {

struct ExitUsb {
    void operator()(libusb_context* context) const { libusb_exit(context); }
};
struct CloseUsb {
    void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
struct FreeConfiguration {
    void operator()(libusb_config_descriptor* configuration) const {
        libusb_free_config_descriptor(configuration);
    }
};
struct FreeList {
    void operator()(libusb_device** list) const { libusb_free_device_list(list, 1); }
};
using UsbContext = std::unique_ptr<libusb_context, ExitUsb>;
using UsbHandle = std::unique_ptr<libusb_device_handle, CloseUsb>;
using UsbConfiguration = std::unique_ptr<libusb_config_descriptor, FreeConfiguration>;
using UsbList = std::unique_ptr<libusb_device*, FreeList>;

/// Throws where a call returned an error: DeviceLost where the device is gone.
inline void check_usb(int result, const std::string& what, const std::string& where) {
    if (result >= 0)
        return;
    const std::string got = libusb_strerror(result);
    if (result == LIBUSB_ERROR_NO_DEVICE || result == LIBUSB_ERROR_IO ||
        result == LIBUSB_ERROR_NOT_FOUND)
        throw DeviceLost{"cannot " + what, where, "the device to answer", got};
    if (result == LIBUSB_ERROR_ACCESS)
        throw Error{"cannot " + what, where, "permission (udev rules: docs/bench.md)", got};
    throw Error{"cannot " + what, where, "", got};
}

inline UsbContext usb_context() {
    libusb_context* context = nullptr;
    check_usb(libusb_init(&context), "start libusb", "USB");
    return UsbContext(context);
}

}  // namespace nearfield::acquire
