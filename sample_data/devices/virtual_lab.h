// SPDX-License-Identifier: Apache-2.0
/// All simulated devices of a lab before one bench. Programs that load libumockdev-preload and have
/// UMOCKDEV_DIR in their environment find them as they find real ones.
#pragma once

#include "sample_data/devices/grbl.h"
#include "sample_data/devices/lab_state.h"
#include "sample_data/devices/test_bed.h"
#include "sample_data/devices/u3v_function.h"
#include "sample_data/devices/usb_device.h"
#include "sample_data/devices/usbtmc_function.h"
#include "sample_data/devices/v4l2_node.h"

#include <utility>

namespace nearfield::devices {

/// Made in this order, so that what serves others goes last.
struct VirtualLab {
    TestBed bed;
    LabState state;
    V4l2Node v4l2;  // /dev/video0
    U3vFunction u3v;
    UsbDevice u3v_plug;
    LuxmeterModel luxmeter;
    UsbDevice luxmeter_plug;
    SupplyModel supply;
    UsbDevice supply_plug;
    Grbl stage;  // /dev/ttyUSB0

    VirtualLab(gige::Lab lab, const Mounting& mounting, bool fast)
        : state(std::move(lab), mounting, fast),
          v4l2(bed, state, 0),
          u3v(state, "NFU3V01"),
          u3v_plug(bed, u3v, 2, true),
          luxmeter(state),
          luxmeter_plug(bed, luxmeter, 3, false),
          supply(state),
          supply_plug(bed, supply, 4, false),
          stage(bed, state, 0) {}
};

}  // namespace nearfield::devices
