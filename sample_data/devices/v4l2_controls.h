// SPDX-License-Identifier: Apache-2.0
/// The controls of a V4L2 camera before the bench: exposure (100 us), gain (dB), automatic
/// exposure, and what a person does in a lab (lab_subject, lab_target_view, lab_shot).
#pragma once

#include "sample_data/devices/lab_state.h"
#include "sample_data/devices/test_bed.h"

#include <linux/videodev2.h>

#include <cstdint>
#include <vector>

namespace nearfield::devices {

class V4l2Controls {
  public:
    explicit V4l2Controls(LabState& lab);

    /// VIDIOC_QUERYCTRL, QUERYMENU, G_CTRL, S_CTRL. 0 or an errno.
    int answer(unsigned long request, void* argument);
    /// VIDIOC_G_EXT_CTRLS, S_EXT_CTRLS: several at once, behind a pointer. 0 or an errno.
    int answer_several(unsigned long request, UMockdevIoctlData* data);

    int exposure_us() const;
    int gain_db() const;

  private:
    struct Control {
        std::uint32_t id;
        const char* name;
        std::uint32_t type;
        int least, most, value;
    };

    int query(v4l2_queryctrl& query) const;
    int get(v4l2_control& control) const;
    int set(const v4l2_control& asked);
    int value(std::uint32_t id) const;

    LabState& lab_;
    std::vector<Control> controls_;
};

}  // namespace nearfield::devices
