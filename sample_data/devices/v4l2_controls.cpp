// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/v4l2_controls.h"

#include "sample_data/devices/fixed_text.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>

namespace nearfield::devices {
namespace {

constexpr std::uint32_t kLabControls = V4L2_CID_USER_BASE + 0x1F00;
constexpr std::uint32_t kSubject = kLabControls, kTargetView = kLabControls + 1,
                        kShot = kLabControls + 2;
constexpr int kMostShot = 0x7FFFFFFF;
constexpr int kExposureUnit_us = 100;  // of V4L2_CID_EXPOSURE_ABSOLUTE

int query_menu(v4l2_querymenu& menu) {
    if (menu.id != V4L2_CID_EXPOSURE_AUTO ||
        (menu.index != V4L2_EXPOSURE_MANUAL && menu.index != V4L2_EXPOSURE_APERTURE_PRIORITY))
        return EINVAL;
    put_text(menu.name, sizeof menu.name,
             menu.index == V4L2_EXPOSURE_MANUAL ? "Manual Mode" : "Aperture Priority Mode");
    return 0;
}

}  // namespace

V4l2Controls::V4l2Controls(LabState& lab) : lab_(lab) {
    constexpr std::uint32_t kInteger = V4L2_CTRL_TYPE_INTEGER, kMenu = V4L2_CTRL_TYPE_MENU;
    controls_ = {
        {V4L2_CID_GAIN, "Gain", kInteger, 0, 24, 0},
        {kSubject, "Lab Subject", kInteger, 0, 6, 0},
        {kTargetView, "Lab Target View", kInteger, 0, std::max(0, lab.lab().target_views - 1), 0},
        {kShot, "Lab Shot", kInteger, 0, kMostShot, 0},
        {V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", kMenu, 0, 3, 3},
        {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", kInteger, 1, 100000, 100}};
}

int V4l2Controls::query(v4l2_queryctrl& query) const {
    const bool is_next = (query.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
    const std::uint32_t id = query.id & V4L2_CTRL_ID_MASK;
    const Control* found = nullptr;
    for (const Control& control : controls_)
        if ((is_next ? control.id > id : control.id == id) &&
            (found == nullptr || control.id < found->id))
            found = &control;
    if (found == nullptr)
        return EINVAL;
    query = {};
    query.id = found->id;
    query.type = found->type;
    put_text(query.name, sizeof query.name, found->name);
    query.minimum = found->least;
    query.maximum = found->most;
    query.step = 1;
    query.default_value = found->value;
    return 0;
}

int V4l2Controls::get(v4l2_control& control) const {
    for (const Control& known : controls_)
        if (known.id == control.id) {
            control.value = known.value;
            return 0;
        }
    return EINVAL;
}

int V4l2Controls::set(const v4l2_control& asked) {
    for (Control& control : controls_) {
        if (control.id != asked.id)
            continue;
        if (asked.value < control.least || asked.value > control.most)
            return ERANGE;
        control.value = asked.value;
        if (asked.id == kSubject)
            lab_.set_subject(static_cast<gige::Subject>(asked.value));
        if (asked.id == kTargetView)
            lab_.set_target_view(asked.value);
        if (asked.id == kShot)
            lab_.set_shot(static_cast<std::uint32_t>(asked.value));
        return 0;
    }
    return EINVAL;
}

int V4l2Controls::answer(unsigned long request, void* argument) {
    switch (request) {
        case VIDIOC_QUERYCTRL:
            return query(*static_cast<v4l2_queryctrl*>(argument));
        case VIDIOC_QUERYMENU:
            return query_menu(*static_cast<v4l2_querymenu*>(argument));
        case VIDIOC_S_CTRL:
            return set(*static_cast<v4l2_control*>(argument));
        default:
            return get(*static_cast<v4l2_control*>(argument));
    }
}

int V4l2Controls::answer_several(unsigned long request, UMockdevIoctlData* data) {
    auto& list = *reinterpret_cast<v4l2_ext_controls*>(data->data);
    if (list.count == 0)
        return 0;  // asks whether there are any
    const Handle<UMockdevIoctlData> behind(
        umockdev_ioctl_data_resolve(data, offsetof(v4l2_ext_controls, controls),
                                    list.count * sizeof(v4l2_ext_control), nullptr));
    if (!behind)
        return EFAULT;
    auto* controls = reinterpret_cast<v4l2_ext_control*>(behind->data);
    for (std::uint32_t k = 0; k < list.count; ++k) {
        v4l2_control control{controls[k].id, controls[k].value};
        const int failure = request == VIDIOC_G_EXT_CTRLS ? get(control) : set(control);
        if (failure != 0) {
            list.error_idx = k;
            return failure;
        }
        controls[k].value = control.value;
    }
    return 0;
}

int V4l2Controls::value(std::uint32_t id) const {
    return std::find_if(controls_.begin(), controls_.end(),
                        [id](const Control& control) { return control.id == id; })
        ->value;
}

int V4l2Controls::exposure_us() const {
    return kExposureUnit_us * value(V4L2_CID_EXPOSURE_ABSOLUTE);
}

int V4l2Controls::gain_db() const {
    return value(V4L2_CID_GAIN);
}

}  // namespace nearfield::devices
