// SPDX-License-Identifier: Apache-2.0
#include "acquire/aravis_device.h"

#include "acquire/aravis_camera.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace nearfield::acquire {
namespace {

void mark_lost(ArvDevice* /*device*/, gpointer data) {
    static_cast<Device*>(data)->is_lost = true;
}

// What there is, for an error's reader.
std::string listed(const std::vector<FoundCamera>& found) {
    std::string list;
    for (const FoundCamera& camera : found)
        list += (list.empty() ? "" : ", ") + camera.id;
    return list.empty() ? "none" : list;
}

// The id of the camera that a name means. A name that nothing was found for is tried as an address:
// cameras beyond the local network are not found by asking around.
std::string id_of(const std::string& name) {
    const std::vector<FoundCamera> found = find_cameras();
    if (name.empty()) {
        if (found.size() != 1)
            throw Error{"cannot open camera", "the only one there is", "one camera", listed(found)};
        return found.front().id;
    }
    const auto is_meant = [&name](const FoundCamera& camera) {
        return name == camera.id || name == camera.address || name == camera.serial;
    };
    const auto camera = std::find_if(found.begin(), found.end(), is_meant);
    return camera == found.end() ? name : camera->id;
}

// How long a camera keeps control for a master that is silent: twice what most come with, since a
// busy machine may be late with the heartbeat that is due every second.
constexpr gint64 kHeartbeat_ms = 6000;

// A program that was killed keeps control until its heartbeat is missed.
void require_control(const Device& device) {
    constexpr double kHeartbeats_s = 2e-3 * kHeartbeat_ms, kBetweenTries_s = 0.2;
    if (!ARV_IS_GV_DEVICE(device.device()))
        return;
    ArvGvDevice* gv_device = ARV_GV_DEVICE(device.device());
    for (const double end_s = now_s() + kHeartbeats_s;
         arv_gv_device_is_controller(gv_device) == 0;) {
        if (now_s() > end_s)
            throw Error{"cannot open camera", device.name, "control over it",
                        "another program controls it"};
        std::this_thread::sleep_for(std::chrono::duration<double>(kBetweenTries_s));
        arv_gv_device_take_control(gv_device, nullptr);
    }
}

// Best effort: a camera that does not let it be set has its own patience.
void lengthen_heartbeat(const Device& device) {
    constexpr const char* kFeature = "GevHeartbeatTimeout";
    if (!device.has(kFeature))
        return;
    if (arv_device_get_integer_feature_value(device.device(), kFeature, nullptr) < kHeartbeat_ms)
        arv_device_set_integer_feature_value(device.device(), kFeature, kHeartbeat_ms, nullptr);
}

}  // namespace

Device::~Device() {
    if (!camera)
        return;
    if (lost_handler != 0)
        g_signal_handler_disconnect(device(), lost_handler);
    // A camera that is gone would let each call wait for its time-out.
    if (stream && !is_lost)
        arv_camera_stop_acquisition(camera.get(), nullptr);
}

std::shared_ptr<Device> open_device(const std::string& name) {
    auto device = std::make_shared<Device>();
    device->name = name.empty() ? "the only camera" : name;
    const std::string id = id_of(name);
    device->camera.reset(checked(
        *device, "open camera", [&](GError** error) { return arv_camera_new(id.c_str(), error); }));
    require_control(*device);
    lengthen_heartbeat(*device);
    // Values out of range are refused instead of silently taken or dropped.
    arv_device_set_range_check_policy(device->device(), ARV_RANGE_CHECK_POLICY_ENABLE);
    device->lost_handler =
        g_signal_connect(device->device(), "control-lost", G_CALLBACK(mark_lost), device.get());
    // A program that died may have left it running, which locks its settings.
    checked(*device, "stop the camera", [&](GError** error) {
        return arv_camera_stop_acquisition(device->camera.get(), error);
    });
    return device;
}

}  // namespace nearfield::acquire
