// SPDX-License-Identifier: Apache-2.0
/// Instruments of a lab that a plan names: who moves the filter, feeds the lamp, reads the light.
#pragma once

#include "formats/files/json_field.h"

#include <glm/glm.hpp>

#include <map>
#include <optional>
#include <string>

namespace nearfield::capture {

/// A stage of two axes behind a GRBL controller on a serial line. Positions are its machine
/// coordinates.
struct GcodeStagePlan {
    std::string device;               // "/dev/ttyUSB0"
    glm::dvec2 first_position_mm{0};  // of column 0, row 0 of the filter
    glm::ivec2 direction{1, 1};       // 1: the coordinate rises with column (row); -1: it falls
    double feed_mm_per_min = 600;     // speed of a move
    double tolerance_mm = 0.02;       // between asked for and read back
};

/// An illuminance meter that answers in SCPI over USBTMC.
struct LuxmeterPlan {
    std::string device;               // serial number or vendor:product, hexadecimal
    std::string query = "MEAS:ILL?";  // asks for a reading, a number
    double lx_per_unit = 1;           // of that number
};

/// A programmable supply (SCPI over USBTMC) that feeds the lamp.
struct SupplyPlan {
    std::string device;
    double voltage_v = 0;
    double current_limit_a = 0;
    /// Warm: what is watched (illuminance where there is a luxmeter, else the lamp's current)
    /// changed by less than the limit within the window.
    double warm_limit_rel = 0.002;
    double warm_window_s = 60;
    double warm_most_s = 3600;  // an error beyond
};

struct InstrumentsPlan {
    std::optional<GcodeStagePlan> stage;
    std::optional<LuxmeterPlan> luxmeter;
    std::optional<SupplyPlan> supply;

    bool empty() const { return !stage && !luxmeter && !supply; }
};

/// Throws Error with the key's place where something is missing, unknown or out of range.
InstrumentsPlan instruments_from(const JsonField& field);
Json json_of(const InstrumentsPlan& instruments);

}  // namespace nearfield::capture
