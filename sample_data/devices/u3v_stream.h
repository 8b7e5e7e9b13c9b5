// SPDX-License-Identifier: Apache-2.0
/// What stands before and behind a frame on USB3 Vision's stream.
#pragma once

#include "sample_data/gige/device.h"

#include <cstdint>
#include <vector>

namespace nearfield::devices {

std::vector<std::uint8_t> u3v_leader(const gige::Settings& settings,
                                     std::uint64_t block_id,
                                     std::uint64_t time_ns);
std::vector<std::uint8_t> u3v_trailer(const gige::Settings& settings,
                                      std::uint64_t block_id,
                                      std::uint64_t payload_bytes);

}  // namespace nearfield::devices
