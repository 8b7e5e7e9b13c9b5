// SPDX-License-Identifier: Apache-2.0
/// A camera's connection, shared by the camera and by a stage that is the camera's own features.
#pragma once

#include "acquire/aravis_handles.h"

#include <atomic>
#include <memory>
#include <string>
#include <type_traits>

namespace nearfield::acquire {

struct Device {
    Handle<ArvCamera> camera;
    Handle<ArvStream> stream;  // where it is configured
    std::string name;          // for errors
    gulong lost_handler = 0;
    std::atomic<bool> is_lost{false};

    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device();

    ArvDevice* device() const { return arv_camera_get_device(camera.get()); }
    bool has(const char* feature) const {
        return arv_device_is_feature_available(device(), feature, nullptr) != 0;
    }
};

/// Connects and takes control. Throws as open_aravis().
std::shared_ptr<Device> open_device(const std::string& name);

/// call(error) with its error thrown as ours: "cannot `what`".
template <typename Call>
auto checked(const Device& device, const std::string& what, const Call& call) {
    Failure failure("cannot " + what, device.name);
    if constexpr (std::is_void_v<decltype(call(failure.to()))>) {
        call(failure.to());
        failure.check();
    } else {
        auto value = call(failure.to());
        failure.check();
        return value;
    }
}

inline std::string text_or_empty(const char* text) {
    return text == nullptr ? "" : text;
}

}  // namespace nearfield::acquire
